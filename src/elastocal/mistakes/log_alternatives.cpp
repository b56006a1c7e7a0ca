// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/log_alternatives.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/screening/log_check.hpp"
#include "elastocal/screening/placed_misfit.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMostPairs = 10000;
constexpr int kPosturesOfPairs = 16;

LogSuspicion InAll(LogSuspicion mistake, const Recording& recording) {
  mistake.postures.resize(Size(recording.posture_count()));
  std::iota(mistake.postures.begin(), mistake.postures.end(), 0);
  return mistake;
}

}  // namespace

std::vector<LogAlternative> OtherColumns(const Recording& recording, const RobotTree& tree,
                                         const std::vector<int>& joints) {
  std::vector<LogAlternative> others;
  const int count = recording.posture_count();
  for (const int k : joints) {
    const Joint& joint = tree.joints[Size(k)];
    if (joint.mimic || IsMovedByRods(tree, k)) continue;
    const auto column = recording.q.col(joint.coordinate);
    if (!(column.maxCoeff() > column.minCoeff())) continue;
    for (const int by : {-1, 1}) {  // offset to the row to which its positions belong
      std::vector<int> rows;
      for (int i = std::max(0, by); i < count + std::min(0, by); ++i) rows.push_back(i);
      Recording other = SelectPostures(recording, rows);
      other.q.col(joint.coordinate) = column.segment(std::max(0, -by), other.q.rows());
      others.push_back(
          {joint.name + ": its positions are those of the row " + (by > 0 ? "after" : "before"), "",
           std::move(other)});
    }
  }
  for (std::size_t a = 0; a + 1 < joints.size(); ++a) {
    for (const auto& [of, with] : {std::pair(a, a + 1), std::pair(a + 1, a)}) {
      const Joint& joint = tree.joints[Size(joints[of])];
      const Joint& other = tree.joints[Size(joints[with])];
      if (joint.mimic || other.mimic || joint.type != other.type) continue;
      if (IsMovedByRods(tree, joints[of]) || IsMovedByRods(tree, joints[with])) continue;
      for (const double sign : {1.0, -1.0}) {
        Recording alone = recording;
        alone.q.col(joint.coordinate) -= sign * recording.q.col(other.coordinate);
        others.push_back({joint.name + ": its positions hold those of " + other.name +
                              (sign > 0.0 ? " as well, added" : " as well, subtracted") +
                              " (positions of a motor, not of the joint?)",
                          "", std::move(alone)});
      }
    }
  }
  others.push_back({kLeftHanded, "", Mirrored(recording)});
  return others;
}

Recording Mirrored(Recording recording) {
  int axis = 0;
  recording.gravity.cwiseAbs().minCoeff(&axis);
  for (int m = 0; m < recording.marker_count(); ++m) recording.markers.col(3 * m + axis) *= -1.0;
  return recording;
}

bool LooksMirrored(const ErrorModel& nominal, const Recording& recording, double far) {
  constexpr double kMuchNearer = 0.5;
  Recording placed = recording;
  placed.free_root = HasPoseByPosture(recording);
  try {
    const double given = PlacedMisfit(nominal, placed);
    return given > far && PlacedMisfit(nominal, Mirrored(placed)) < kMuchNearer * given;
  } catch (const InputError&) {  // rods that do not close
    return false;
  }
}

std::vector<LogAlternative> BestPair(const Recording& recording, const RobotTree& tree,
                                     const std::function<double(const Recording&)>& misfit) {
  std::vector<LogSuspicion> possible = PossibleLogMistakes(recording, tree);
  std::erase_if(possible, [](const LogSuspicion& one) { return one.linkage >= 0; });
  if (possible.size() * possible.size() > kMostPairs) {
    std::erase_if(possible, [](const auto& one) { return one.kind != LogContradiction::kSign; });
  }
  if (possible.size() * possible.size() > kMostPairs) return {};
  const Recording few = EvenlyThinned(recording, kPosturesOfPairs);
  double least = std::numeric_limits<double>::infinity();
  const LogSuspicion* pair[2] = {nullptr, nullptr};
  for (const LogSuspicion& first : possible) {
    const Recording without = WithoutMistake(few, InAll(first, few), tree);
    for (const LogSuspicion& second : possible) {
      if (&second == &first) continue;
      const double left = misfit(WithoutMistake(without, InAll(second, few), tree));
      if (!(left < least)) continue;
      least = left;
      pair[0] = &first;
      pair[1] = &second;
    }
  }
  if (pair[0] == nullptr) return {};
  std::vector<LogAlternative> found;
  Recording current = recording;
  for (const LogSuspicion* one : pair) {
    current = WithoutMistake(current, *one, tree);
    found.push_back({DescribeSuspicion(*one, tree, recording), NameOf(*one, tree), current});
  }
  return found;
}

}  // namespace elastocal
