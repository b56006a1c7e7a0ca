// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/stated_corrections.hpp"

namespace elastocal {
namespace {

/// Names of the markers that a joint moves relative to the root link.
std::set<std::string> MarkersBeyond(const Project& project, int coordinate) {
  const RobotTree& tree = project.tree;
  std::set<std::string> beyond;
  for (const Marker& marker : project.markers) {
    for (const int k : JointsToBody(tree, tree.links[Size(marker.link)].body)) {
      const std::vector<Drive> drives = DrivesOf(tree.joints[Size(k)]);
      if (std::ranges::find(drives, coordinate, &Drive::coordinate) != drives.end()) {
        beyond.insert(marker.name);
      }
    }
  }
  return beyond;
}

bool SeesAny(const Recording& recording, int posture, const std::set<std::string>& markers) {
  for (int m = 0; m < recording.marker_count(); ++m) {
    const bool wanted = markers.contains(recording.marker_names[Size(m)]);
    if (wanted && Seen(recording, posture, m)) return true;
  }
  return false;
}

/// Names of the trials that move a joint while a marker that it moves is seen.
std::vector<std::string> TrialsThatShow(const Recording& recording, int coordinate,
                                        const std::set<std::string>& markers) {
  std::vector<int> seen;
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (SeesAny(recording, i, markers)) seen.push_back(i);
  }
  std::vector<std::string> names;
  for (const int trial : AllTrialsThatMove(SelectPostures(recording, seen), coordinate)) {
    names.push_back(recording.trials[Size(trial)].name);
  }
  return names;
}

/// Empty where a trial shows the joint in the state of the estimate.
std::string DescribeUnconfirmed(const StatedCorrection& correction,
                                const std::vector<StatedCorrection>& all, const Project& project,
                                const Measurements& measured) {
  const std::set<std::string> beyond = MarkersBeyond(project, correction.coordinate);
  const std::vector<std::string> of_estimate =
      TrialsThatShow(measured.calibration, correction.coordinate, beyond);
  const std::vector<std::string> held_out =
      TrialsThatShow(measured.validation, correction.coordinate, beyond);
  const auto undone_in = [&](const std::string& trial) {
    return std::any_of(all.begin(), all.end(), [&](const StatedCorrection& one) {
      return one.kind == correction.kind && one.linkage < 0 &&
             one.coordinate == correction.coordinate && (one.trial.empty() || one.trial == trial);
    });
  };
  const bool unconfirmed = !of_estimate.empty() && !held_out.empty() &&
                           std::none_of(of_estimate.begin(), of_estimate.end(), undone_in) &&
                           std::all_of(held_out.begin(), held_out.end(), undone_in);
  if (!unconfirmed) return "";
  return fmt::format(
      "{}: its positions are corrected in all trials for validation that show it ({}), and not in "
      "those of the estimate ({}): nothing shows which of the two the robot's log is like now; "
      "record one more trial for validation that moves it in sight of the cameras",
      correction.joint, fmt::join(held_out, ", "), fmt::join(of_estimate, ", "));
}

/// Names of the trials with postures.
std::vector<std::string> UsedNames(const Recording& recording) {
  std::vector<std::string> names;
  for (const int trial : std::set<int>(recording.trial.begin(), recording.trial.end())) {
    names.push_back(recording.trials[Size(trial)].name);
  }
  return names;
}

/// Empty where a trial for validation has the cameras' scale of the estimate, or known lengths tell
/// the scale.
std::string DescribeUnconfirmedScale(const std::vector<StatedCorrection>& all,
                                     const Measurements& measured) {
  const std::vector<std::string> of_estimate = UsedNames(measured.calibration);
  const std::vector<std::string> held_out = UsedNames(measured.validation);
  const auto corrected_in = [&](const std::string& trial) {
    return std::any_of(all.begin(), all.end(), [&](const StatedCorrection& one) {
      return one.kind == FaultKind::kCameraScale && (one.trial.empty() || one.trial == trial);
    });
  };
  const auto is_measured = [&](const std::string& trial) {
    return std::any_of(
        measured.trials.begin(), measured.trials.end(),
        [&](const TrialSummary& one) { return one.trial.name == trial && one.scale.has_value(); });
  };
  const bool unconfirmed = !held_out.empty() && std::ranges::all_of(held_out, corrected_in) &&
                           std::ranges::none_of(of_estimate, corrected_in) &&
                           !std::ranges::all_of(held_out, is_measured);
  if (!unconfirmed) return "";
  return fmt::format(
      "the scale of the cameras is corrected in all trials for validation ({}), and not in those "
      "of the estimate ({}): nothing shows which of the two is right; measure a known length "
      "(recording.reference_lengths), or record one more trial for validation",
      fmt::join(held_out, ", "), fmt::join(of_estimate, ", "));
}

}  // namespace

std::vector<std::string> UnconfirmedCorrections(const std::vector<std::string>& names,
                                                const Project& project,
                                                const Measurements& measured) {
  std::vector<StatedCorrection> all;
  for (const std::string& name : names) {
    if (const auto one = ParseStatedCorrection(name, project.tree)) all.push_back(*one);
  }
  std::vector<std::string> objections;
  const std::string scale = DescribeUnconfirmedScale(all, measured);
  if (!scale.empty()) objections.push_back(scale);
  std::set<std::pair<FaultKind, int>> judged;
  for (const StatedCorrection& one : all) {
    if (one.kind == FaultKind::kCameraScale || one.linkage >= 0) continue;
    if (!judged.insert({one.kind, one.coordinate}).second) continue;
    const std::string objection = DescribeUnconfirmed(one, all, project, measured);
    if (!objection.empty()) objections.push_back(objection);
  }
  return objections;
}

}  // namespace elastocal
