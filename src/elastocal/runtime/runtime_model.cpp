// SPDX-License-Identifier: Apache-2.0
#include "elastocal/runtime/runtime_model.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "elastocal/runtime/core_equations.h"

namespace elastocal {
namespace {

/// The coordinates that move the end of a limb.
std::set<int> CoordinatesOf(const RuntimeModel& model, const ec_tip& tip) {
  std::set<int> coordinates;
  for (int body = tip.frame.body; body > 0;) {
    const ec_joint& joint = model.calibrated[static_cast<std::size_t>(body - 1)];
    coordinates.insert(joint.coordinate);
    body = joint.parent;
  }
  return coordinates;
}

/// For each tip, the first of the tips with which it shares a coordinate, directly or by others:
/// the commands of limbs on one joint of the root, or on joints that share a motor, are found
/// together.
std::vector<std::size_t> FirstOfBranch(const RuntimeModel& model) {
  std::vector<std::size_t> first(model.tips.size());
  std::vector<std::set<int>> coordinates(model.tips.size());
  for (std::size_t t = 0; t < model.tips.size(); ++t) {
    first[t] = t;
    coordinates[t] = CoordinatesOf(model, model.tips[t]);
    for (std::size_t other = 0; other < t; ++other) {
      const bool shared = std::ranges::any_of(
          coordinates[t], [&](int c) { return coordinates[other].contains(c); });
      if (!shared) continue;
      const std::size_t both = std::min(first[t], first[other]);
      const std::size_t joined = std::max(first[t], first[other]);
      std::replace(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(t) + 1, joined, both);
    }
  }
  return first;
}

/// By which length the turns of the end of each limb count. Limbs of one branch that ask for more
/// than their coordinates can give each miss some of it. Where feet are flat, and where a neck
/// looks, must not suffer for that; of an arm, the place counts more.
void WeighTurns(int branches, RuntimeModel& model) {
  std::vector<std::size_t> asked(static_cast<std::size_t>(branches), 0);
  std::vector<std::set<int>> moving(asked.size());  // coordinates
  for (const ec_tip& tip : model.tips) {
    if (tip.yields != 0) continue;
    asked[static_cast<std::size_t>(tip.branch)] += 6;
    moving[static_cast<std::size_t>(tip.branch)].merge(CoordinatesOf(model, tip));
  }
  for (std::size_t t = 0; t < model.tips.size(); ++t) {
    ec_tip& tip = model.tips[t];
    const auto branch = static_cast<std::size_t>(tip.branch);
    const bool few = moving[branch].size() < asked[branch];
    tip.arm = few && tip.foot < 0 && IsArm(model, t) ? EC_ARM_OF_FEW : EC_ARM;
  }
}

}  // namespace

bool IsArm(const RuntimeModel& model, std::size_t tip) {
  constexpr std::size_t kFewest = 4;
  if (model.tips[tip].yields != 0) return false;
  std::set<int> own = CoordinatesOf(model, model.tips[tip]);
  for (std::size_t t = 0; t < model.tips.size(); ++t) {
    if (t == tip) continue;
    for (int coordinate : CoordinatesOf(model, model.tips[t])) own.erase(coordinate);
  }
  return own.size() >= kFewest;
}

double DegreeAsMillimetres(double arm_m) { return 1e3 * arm_m * std::numbers::pi / 180.0; }

RuntimeBranches FindBranches(RuntimeModel& model) {
  RuntimeBranches branches;
  branches.branch_of_coordinate.assign(model.lower.size(), -1);
  branches.column_of_coordinate.assign(model.lower.size(), 0);
  std::map<std::size_t, int> branch_of_first;
  std::erase_if(model.tips, [](const ec_tip& tip) { return tip.frame.body == 0; });
  const std::vector<std::size_t> first = FirstOfBranch(model);
  for (std::size_t t = 0; t < model.tips.size(); ++t) {
    ec_tip& tip = model.tips[t];
    tip.branch =
        branch_of_first.emplace(first[t], static_cast<int>(branch_of_first.size())).first->second;
    branches.branch_size.resize(branch_of_first.size(), 0);
    tip.freedom = static_cast<int>(CoordinatesOf(model, tip).size());
    for (int body = tip.frame.body; body > 0;) {
      const ec_joint& joint = model.calibrated[static_cast<std::size_t>(body - 1)];
      const auto coordinate = static_cast<std::size_t>(joint.coordinate);
      int& branch = branches.branch_of_coordinate[coordinate];
      if (branch < 0) {
        branch = tip.branch;
        int& size = branches.branch_size[static_cast<std::size_t>(branch)];
        branches.column_of_coordinate[coordinate] = size++;
      }
      body = joint.parent;
    }
  }
  for (ec_tip& tip : model.tips) {
    const auto longer = [&](const ec_tip& other) {
      return other.branch == tip.branch && other.freedom >= 6;
    };
    tip.yields = tip.freedom < 6 && std::any_of(model.tips.begin(), model.tips.end(), longer);
  }
  WeighTurns(static_cast<int>(branches.branch_size.size()), model);
  return branches;
}

}  // namespace elastocal
