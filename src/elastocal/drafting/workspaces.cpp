// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/workspaces.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/motion/leg_chain.hpp"
#include "elastocal/robot/moving_chain.hpp"

namespace elastocal {
namespace {

constexpr double kHandCone = 60.0 * kRadiansPerDegree;

/// Positions of a chain's tip in random postures, with all else at rest, in the root link's frame,
/// m.
std::vector<Eigen::Vector3d> TipPlaces(const RobotTree& tree, const ChainSetup& setup,
                                       const Eigen::VectorXd& rest) {
  constexpr int kPostures = 1000;
  const auto range = RangesOf(tree, 0.02);
  Random random(1);
  std::vector<Eigen::Vector3d> places;
  for (int n = 0; n < kPostures; ++n) {
    Eigen::VectorXd q = rest;
    for (const int c : setup.coordinates) q[c] = random.Uniform(range.first[c], range.second[c]);
    places.emplace_back(LinkTransforms(tree, q)[Size(setup.tip_link)].translation());
  }
  return places;
}

/// Rounds a box outwards to whole centimetres, and enlarges it to at least 4 cm.
Box RoundedBox(Box box) {
  constexpr double kStep = 0.01, kLeast = 0.02;
  const Eigen::Vector3d middle = 0.5 * (box.lower + box.upper);
  box.lower = box.lower.cwiseMin(middle.array().operator-(kLeast).matrix());
  box.upper = box.upper.cwiseMax(middle.array().operator+(kLeast).matrix());
  box.lower = kStep * (box.lower / kStep).array().floor().matrix();
  box.upper = kStep * (box.upper / kStep).array().ceil().matrix();
  return box;
}

/// Share of the positions that are in a box.
double ShareInside(const Box& box, const std::vector<Eigen::Vector3d>& places) {
  const auto inside = std::count_if(places.begin(), places.end(), [&](const Eigen::Vector3d& p) {
    return (p.array() >= box.lower.array()).all() && (p.array() <= box.upper.array()).all();
  });
  return static_cast<double>(inside) / static_cast<double>(places.size());
}

/// The box without the outermost twentieth of the positions on either side of each axis.
Box Middle(std::vector<Eigen::Vector3d> places) {
  constexpr double kOut = 0.05;
  Box box{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    std::sort(places.begin(), places.end(),
              [&](const auto& a, const auto& b) { return a[axis] < b[axis]; });
    const auto n = static_cast<double>(places.size() - 1);
    box.lower[axis] = places[static_cast<std::size_t>(kOut * n)][axis];
    box.upper[axis] = places[static_cast<std::size_t>((1.0 - kOut) * n)][axis];
  }
  return box;
}

}  // namespace

void SetLegWorkspace(const RobotTree& tree, const Limb& limb, const RestPosture& rest,
                     ChainSetup& setup) {
  // Shares of the height of the root link above straight legs (Fig. 2a of the paper).
  constexpr double kAhead = 0.32, kInwards = 0.125, kOutwards = 0.25;
  constexpr double kLowest = 0.997, kHighest = 0.60, kAboveFloor = 0.018;
  constexpr double kHighestBall = 0.40;  // share of the height at rest, where knees are bent far
  constexpr double kEnough = 0.01;
  const auto zero = LinkTransforms(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  const Eigen::Vector3d foot = zero[Size(setup.tip_link)].translation();
  const double height = -foot.z();
  const double side = foot.y() < 0.0 ? -1.0 : 1.0;
  const double inner = side * foot.y() - kInwards * height;
  const double outer = side * foot.y() + kOutwards * height;
  Box box{{foot.x() - kAhead * height, std::min(side * inner, side * outer), -kLowest * height},
          {foot.x() + kAhead * height, std::max(side * inner, side * outer), -kHighest * height}};
  const bool on_ball = setup.coordinates.size() < LeastLegJoints(false);
  if (on_ball) box.upper.z() = -kHighestBall * rest.root_height;
  const std::vector<Eigen::Vector3d> places = TipPlaces(tree, setup, rest.q);
  if (ShareInside(box, places) < kEnough) {
    const double highest = box.upper.z();
    box = Middle(places);
    box.upper.z() = std::max(box.lower.z() + 0.05 * height, std::min(box.upper.z(), highest));
  }
  setup.box = RoundedBox(box);
  if (limb.joints.size() >= 6) setup.largest_turn = kHandCone;
  setup.floor_z = -rest.root_height + kAboveFloor * height;
}

void SetArmWorkspace(const RobotTree& tree, const Limb& limb, const RestPosture& rest, bool on_legs,
                     ChainSetup& setup) {
  constexpr double kEnough = 0.02;
  const std::vector<Eigen::Vector3d> places = TipPlaces(tree, setup, rest.q);
  Box box = Middle(places);
  if (on_legs && limb.joints.size() > 2) {
    // Shares of the arm's length from the shoulder on (Fig. 2a of the paper).
    const auto zero = LinkTransforms(tree, rest.q);
    double length = 0.0;
    Eigen::Vector3d last = Eigen::Vector3d::Zero();
    Eigen::Vector3d shoulder = Eigen::Vector3d::Zero();
    for (const int k : limb.joints) {
      if (tree.joints[Size(k)].parent_body == limb.from_body) {
        shoulder = last = zero[Size(tree.joints[Size(k)].child_link)].translation();
        length = 0.0;
      }
      const Eigen::Vector3d here = zero[Size(tree.joints[Size(k)].child_link)].translation();
      length += (here - last).norm();
      last = here;
    }
    length += (zero[Size(setup.tip_link)].translation() - last).norm();
    const double side = shoulder.y() < 0.0 ? -1.0 : 1.0;
    const Eigen::Vector3d inner(0.20, -0.33 * side, -0.52), outer(0.85, 0.51 * side, 0.39);
    const Box ahead{shoulder + length * inner.cwiseMin(outer),
                    shoulder + length * inner.cwiseMax(outer)};
    if (ShareInside(ahead, places) > kEnough) box = ahead;
  }
  setup.box = RoundedBox(box);
}

}  // namespace elastocal
