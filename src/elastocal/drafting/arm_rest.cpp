// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/arm_rest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastocal/drafting/rest_posture.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"

namespace elastocal {

bool HoldAhead(const RobotTree& tree, const std::vector<CollisionSphere>& spheres,
               const std::vector<SpherePair>& pairs, const ChainSetup& chain, double margin,
               const std::map<int, Eigen::Vector2d>& ranges, Eigen::VectorXd& q) {
  constexpr int kPostures = 4000;
  constexpr double kInside = 0.2;  // share of the box that is kept free on each side
  if (!chain.box) return false;
  const Eigen::Vector3d inset = kInside * (chain.box->upper - chain.box->lower);
  auto range = RangesOf(tree, 0.05);
  for (const auto& [c, narrower] : ranges) {
    range.first[c] = std::max(range.first[c], narrower[0]);
    range.second[c] = std::min(range.second[c], narrower[1]);
  }
  Random random(1);
  double least = std::numeric_limits<double>::infinity();
  Eigen::VectorXd best = q;
  for (int n = 0; n < kPostures; ++n) {
    Eigen::VectorXd drawn = q;
    double distance = 0.0;
    for (const int c : chain.coordinates) {
      const double width = range.second[c] - range.first[c];
      drawn[c] = random.Uniform(range.first[c], range.second[c]);
      if (tree.joints[Size(tree.coordinate_joint[Size(c)])].type == JointType::kRevolute) {
        drawn[c] = kRadiansPerDegree * std::round(drawn[c] / kRadiansPerDegree);
      }
      distance += std::pow((drawn[c] - q[c]) / std::max(width, 1e-6), 2);
    }
    if (distance >= least) continue;
    const std::vector<Transform> poses = LinkTransforms(tree, drawn);
    const Eigen::Vector3d tip = poses[Size(chain.tip_link)].translation();
    if ((tip.array() < (chain.box->lower + inset).array()).any()) continue;
    if ((tip.array() > (chain.box->upper - inset).array()).any()) continue;
    if (!pairs.empty() && SphereDistances(spheres, pairs, poses).minCoeff() < margin) continue;
    least = distance;
    best = drawn;
  }
  q = best;
  return std::isfinite(least);
}

}  // namespace elastocal
