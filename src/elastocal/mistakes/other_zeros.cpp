// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/other_zeros.hpp"

#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/suspected_signs.hpp"
#include "elastocal/robot/coordinates.hpp"

namespace elastocal {
namespace {

constexpr double kQuarter = std::numbers::pi / 2.0;
// Share of a quarter of a turn within which an offset is another zero.
constexpr double kNearQuarters = 0.2;
constexpr double kAsWellAsTurned = 1.1;  // ratio to the error that impossible offsets leave
// Rad or m: range from which the sign of a joint can be determined.
constexpr double kLeastRange = 0.05;
constexpr std::size_t kMostTurned = 6;

LogAlternative WithOtherZero(const Recording& recording, const RobotTree& tree, int coordinate,
                             int quarters) {
  const Joint& joint = JointOfCoordinate(tree, coordinate);
  Recording other = recording;
  other.q.col(coordinate).array() -= quarters * kQuarter;
  const std::string by = quarters == 2   ? "off by half a turn"
                         : quarters == 1 ? "a quarter of a turn too large"
                                         : "a quarter of a turn too small";
  return {fmt::format("{}: its positions are {} in all rows (another zero, of the encoder or of a "
                      "convention?)",
                      joint.name, by),
          "", std::move(other)};
}

LogAlternative WithOtherSign(const Recording& recording, const RobotTree& tree, int coordinate) {
  const LogSuspicion sign = SignOf(coordinate, recording);
  return {DescribeSuspicion(sign, tree, recording), NameOf(sign, tree),
          WithoutMistake(recording, sign, tree)};
}

/// Coordinates of the joint, of the one before it and of those after it.
std::set<int> Neighbours(const RobotTree& tree, int coordinate) {
  const int joint = tree.coordinate_joint[Size(coordinate)];
  std::set<int> near{coordinate};
  const int before = tree.joints[Size(joint)].parent_body - 1;
  if (before >= 0) near.insert(tree.joints[Size(before)].coordinate);
  for (const Joint& other : tree.joints) {
    if (other.parent_body == joint + 1) near.insert(other.coordinate);
  }
  return near;
}

/// Mistakes that could cause this offset of a joint.
std::vector<LogAlternative> Explanations(const Recording& recording, const RobotTree& tree,
                                         const TurnedZero& turned) {
  std::vector<LogAlternative> all;
  const double quarters = std::round(std::abs(turned.offset) / kQuarter);
  if (std::abs(std::abs(turned.offset) / kQuarter - quarters) < kNearQuarters && quarters <= 2.0) {
    for (const int count : quarters == 2.0 ? std::vector<int>{2} : std::vector<int>{1, -1}) {
      all.push_back(WithOtherZero(recording, tree, turned.coordinate, count));
    }
  }
  for (const int c : Neighbours(tree, turned.coordinate)) {
    const auto column = recording.q.col(c);
    if (!(column.maxCoeff() - column.minCoeff() > kLeastRange)) continue;
    all.push_back(WithOtherSign(recording, tree, c));
  }
  return all;
}

}  // namespace

std::vector<LogAlternative> OtherZeros(const Recording& recording, const RobotTree& tree,
                                       const std::vector<int>& joints) {
  std::vector<LogAlternative> all;
  for (const int k : joints) {
    const Joint& joint = tree.joints[Size(k)];
    if (joint.mimic || joint.type != JointType::kRevolute || IsMovedByRods(tree, k)) continue;
    for (const int quarters : {2, 1, -1}) {
      all.push_back(WithOtherZero(recording, tree, joint.coordinate, quarters));
    }
  }
  return all;
}

std::vector<LogAlternative> FindTurnedZeros(const Project& project, const ErrorModel& model,
                                            const Recording& recording, OffsetsFit& fit) {
  std::vector<LogAlternative> steps;
  if (!project.tree.linkages.empty() || fit.turned.size() > kMostTurned) return steps;
  Recording current = recording;
  const double error = fit.error;
  while (!fit.turned.empty()) {
    LogAlternative best;
    OffsetsFit best_fit;
    for (LogAlternative& one : Explanations(current, project.tree, fit.turned.front())) {
      const OffsetsFit without = FitOffsets(project, model, one.recording);
      if (without.turned.size() >= fit.turned.size()) continue;
      if (!(without.error < kAsWellAsTurned * error)) continue;
      if (!best.what.empty() && without.off_project >= best_fit.off_project) continue;
      best = std::move(one);
      best_fit = without;
    }
    if (best.what.empty()) return {};
    current = best.recording;
    fit = std::move(best_fit);
    steps.push_back(std::move(best));
  }
  return fit.robot ? steps : std::vector<LogAlternative>{};
}

}  // namespace elastocal
