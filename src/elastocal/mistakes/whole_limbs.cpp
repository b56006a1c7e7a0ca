// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/whole_limbs.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kFewestOfLimb = 2;

struct Limb {
  std::string name;
  std::vector<int> joints;  ///< from the body outwards

  bool operator==(const Limb& other) const { return joints == other.joints; }
};

/// Joints with their own motion, up to the tip of the chain.
std::vector<int> JointsToTip(const RobotTree& tree, const Chain& chain) {
  std::vector<int> joints;
  for (const int k : JointsToBody(tree, tree.links[Size(chain.tip_link)].body)) {
    if (!tree.joints[Size(k)].mimic && !IsMovedByRods(tree, k)) joints.push_back(k);
  }
  return joints;
}

/// The limbs, each tip once, however many chains reach it.
std::vector<Limb> LimbsOf(const Project& project) {
  std::vector<Limb> limbs;
  for (const Chain& chain : project.chains) {
    Limb limb{chain.name, JointsToTip(project.tree, chain)};
    for (const Chain& other : project.chains) {
      const std::vector<int> others = JointsToTip(project.tree, other);
      const bool same = others == JointsToTip(project.tree, chain);
      std::erase_if(limb.joints, [&](int k) {
        return !same && std::find(others.begin(), others.end(), k) != others.end();
      });
    }
    if (limb.joints.size() < kFewestOfLimb) continue;
    if (std::find(limbs.begin(), limbs.end(), limb) == limbs.end()) limbs.push_back(limb);
  }
  return limbs;
}

LogAlternative Reversed(const Recording& recording, const RobotTree& tree, const Limb& limb) {
  std::vector<std::string> names;
  Recording other = recording;
  for (const int k : limb.joints) {
    const Joint& joint = tree.joints[Size(k)];
    other.q.col(joint.coordinate) *= -1.0;
    names.push_back("sign:" + joint.name);
  }
  return {fmt::format("{}: the signs of the positions of all its joints are reversed", limb.name),
          fmt::format("{}", fmt::join(names, " ")), std::move(other)};
}

LogAlternative Exchanged(const Recording& recording, const RobotTree& tree, const Limb& a,
                         const Limb& b) {
  std::vector<std::string> names;
  Recording other = recording;
  for (std::size_t k = 0; k < a.joints.size(); ++k) {
    const Joint& of_a = tree.joints[Size(a.joints[k])];
    const Joint& of_b = tree.joints[Size(b.joints[k])];
    other.q.col(of_a.coordinate).swap(other.q.col(of_b.coordinate));
    names.push_back("exchange:" + of_a.name + "," + of_b.name);
  }
  return {fmt::format("{} and {}: the positions of all their joints are exchanged", a.name, b.name),
          fmt::format("{}", fmt::join(names, " ")), std::move(other)};
}

}  // namespace

std::vector<LogAlternative> WholeLimbs(const Recording& recording, const Project& project) {
  const std::vector<Limb> limbs = LimbsOf(project);
  const auto type_of = [&](int joint) { return project.tree.joints[Size(joint)].type; };
  std::vector<LogAlternative> all;
  for (std::size_t a = 0; a < limbs.size(); ++a) {
    all.push_back(Reversed(recording, project.tree, limbs[a]));
    for (std::size_t b = a + 1; b < limbs.size(); ++b) {
      const bool alike = std::ranges::equal(limbs[a].joints, limbs[b].joints, {}, type_of, type_of);
      if (!alike) continue;
      all.push_back(Exchanged(recording, project.tree, limbs[a], limbs[b]));
    }
  }
  return all;
}

}  // namespace elastocal
