// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/validation_tours.hpp"

#include <algorithm>
#include <optional>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/motion/move_builder.hpp"

namespace elastocal {
namespace {

bool InWorkspace(const ChainSetup& chain, const Transform& T_rest, const Transform& T_tip) {
  const Eigen::Vector3d p = T_tip.translation();
  const bool inside = !chain.box || ((p.array() >= chain.box->lower.array()).all() &&
                                     (p.array() <= chain.box->upper.array()).all());
  return inside &&
         RotationAngle(T_rest.linear().transpose() * T_tip.linear()) <= chain.largest_turn;
}

/// Draws a posture of a chain that can be held; nothing if all tries fail.
std::optional<Eigen::VectorXd> Draw(const StandingRobot& robot, const MotionSetup& setup,
                                    const ChainSetup& chain, const std::vector<int>& standing,
                                    int tries, Random& random) {
  const PlanOptions options;
  const MoveBuilder build(robot, options);
  const PlacedPosture rest{robot.rest, robot.T_world_root};
  const Transform T_rest = LinkTransforms(robot.tree, robot.rest)[Size(chain.tip_link)];
  for (int i = 0; i < tries; ++i) {
    Eigen::VectorXd q = robot.rest;
    for (const int c : chain.coordinates) q[c] = random.Uniform(setup.lower[c], setup.upper[c]);
    if (!InWorkspace(chain, T_rest, LinkTransforms(robot.tree, q)[Size(chain.tip_link)])) continue;
    Refusal why;
    if (build.AtRest(q, standing, rest, why)) return q;
  }
  return std::nullopt;
}

bool Stands(const StandingRobot& robot, const std::vector<int>& standing, int coordinate) {
  return std::any_of(standing.begin(), standing.end(), [&](int foot) {
    const std::vector<int>& leg = robot.legs[Size(foot)].coordinates();
    return std::find(leg.begin(), leg.end(), coordinate) != leg.end();
  });
}

}  // namespace

std::vector<PostureTour> ValidationTours(const StandingRobot& robot, const MotionSetup& setup,
                                         const std::vector<ChainSetup>& chains, ValidationKind kind,
                                         const ValidationOptions& options, Random& random) {
  std::vector<PostureTour> sets;
  for (const ChainSetup& chain : chains) {
    PostureTour set;
    set.name = chain.name;
    set.standing = FeetOf(robot, chain.support);
    const auto draw = [&] {
      return Draw(robot, setup, chain, set.standing, options.tries, random);
    };
    if (kind == ValidationKind::kSine) {
      for (const int c : chain.coordinates) {
        if (!Stands(robot, set.standing, c)) set.sines.push_back(c);
      }
    } else if (kind == ValidationKind::kRandom) {
      for (int i = 0; i < options.random_postures; ++i) {
        if (const auto q = draw()) set.postures.push_back(*q);
      }
    } else if (const auto q = draw()) {
      set.postures.assign(Size(options.repetitions), *q);
      set.in_order = true;
    }
    sets.push_back(std::move(set));
  }
  return sets;
}

std::vector<int> FeetOf(const StandingRobot& robot, const std::vector<int>& links) {
  std::vector<int> feet;
  if (robot.Held() && links.empty()) return feet;
  for (std::size_t i = 0; i < robot.soles.size(); ++i) {
    if (std::find(links.begin(), links.end(), robot.soles[i].link) != links.end()) {
      feet.push_back(static_cast<int>(i));
    }
  }
  const bool known = feet.size() == links.size() && !feet.empty();
  if (known && feet.size() + 1 >= robot.soles.size()) return feet;
  std::string names;
  for (const int link : links) {
    names += (names.empty() ? "" : ", ") + robot.tree.links[Size(link)].name;
  }
  throw InputError("the robot cannot stand on '" + names + "'; expected all of its " +
                   std::to_string(robot.soles.size()) + " soles, or all but one");
}

}  // namespace elastocal
