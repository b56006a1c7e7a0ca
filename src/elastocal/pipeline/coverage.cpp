// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/coverage.hpp"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "elastocal/calibration/observations.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

bool Exercises(const Trial& trial, const std::string& chain) {
  return std::find(trial.chains.begin(), trial.chains.end(), chain) != trial.chains.end();
}

/// Trials with postures that are used.
std::vector<Trial> UsedTrials(const Recording& recording) {
  std::vector<Trial> used;
  for (const int trial : std::set<int>(recording.trial.begin(), recording.trial.end())) {
    used.push_back(recording.trials[trial]);
  }
  return used;
}

/// Links on which the robot stands alone in a trial.
std::map<int, std::string> StandsAloneOn(const Recording& recording) {
  std::map<int, std::string> links;  // with the name of such a trial
  for (const Trial& trial : UsedTrials(recording)) {
    if (trial.support.size() == 1) links.emplace(trial.support.front(), trial.name);
  }
  return links;
}

std::vector<int> JointsOf(const Project& project, const Chain& chain) {
  return JointsToBody(project.tree, project.tree.links[chain.tip_link].body);
}

/// Whether the trials exercise each joint of the chain, if only as a joint of other chains.
bool ExercisesEachJoint(const Project& project, const Recording& recording, const Chain& chain) {
  std::set<int> exercised;
  for (const Trial& trial : UsedTrials(recording)) {
    for (const Chain& other : project.chains) {
      if (!Exercises(trial, other.name)) continue;
      for (const int joint : JointsOf(project, other)) exercised.insert(joint);
    }
  }
  const std::vector<int> joints = JointsOf(project, chain);
  return std::all_of(joints.begin(), joints.end(),
                     [&](int joint) { return exercised.contains(joint); });
}

/// Markers of a recording that are seen in postures of trials of the chain (`anywhere`: of any
/// trial); in a table, in any posture.
bool Shows(const Recording& recording, const std::string& chain,
           const std::vector<std::string>& markers, bool anywhere) {
  const ObservationMask seen = SeenMask(recording);
  for (int m = 0; m < recording.marker_count(); ++m) {
    if (std::find(markers.begin(), markers.end(), recording.marker_names[m]) == markers.end()) {
      continue;
    }
    for (int i = 0; i < recording.posture_count(); ++i) {
      if (!seen(i, m)) continue;
      if (anywhere || recording.trials.empty()) return true;
      const std::vector<std::string>& chains = recording.trials[recording.trial[i]].chains;
      if (std::find(chains.begin(), chains.end(), chain) != chains.end()) return true;
    }
  }
  return false;
}

/// Joints that move one of these markers.
std::set<int> JointsShownBy(const Project& project, const std::vector<std::string>& markers) {
  std::set<int> shown;
  for (const Marker& marker : project.markers) {
    if (std::find(markers.begin(), markers.end(), marker.name) == markers.end()) continue;
    for (const int joint : JointsToBody(project.tree, project.tree.links[marker.link].body)) {
      shown.insert(joint);
    }
  }
  return shown;
}

/// Joints of a chain that its markers show but no seen marker shows.
std::vector<std::string> UnseenJoints(const Project& project, const Recording& recording,
                                      const Chain& chain, const std::vector<std::string>& markers) {
  const std::set<int> shown = JointsShownBy(project, markers);
  const std::set<int> seen = JointsShownBy(project, SeenMarkers(recording));
  std::vector<std::string> unseen;
  for (const int joint : JointsOf(project, chain)) {
    if (shown.contains(joint) && !seen.contains(joint)) {
      unseen.push_back(project.tree.joints[joint].name);
    }
  }
  return unseen;
}

/// Joints that move markers which are seen in a trial that exercises the joint's chain.
std::set<int> JointsJudged(const Project& project, const Recording& recording) {
  std::set<int> judged;
  for (const int trial : std::set<int>(recording.trial.begin(), recording.trial.end())) {
    std::vector<int> postures;
    for (int i = 0; i < recording.posture_count(); ++i) {
      if (recording.trial[i] == trial) postures.push_back(i);
    }
    const std::set<int> shown =
        JointsShownBy(project, SeenMarkers(SelectPostures(recording, postures)));
    for (const Chain& chain : project.chains) {
      if (!Exercises(recording.trials[trial], chain.name)) continue;
      for (const int joint : JointsOf(project, chain)) {
        if (shown.contains(joint)) judged.insert(joint);
      }
    }
  }
  return judged;
}

/// Joints of a chain that the estimate shows and held-out data do not judge.
std::vector<std::string> UnjudgedJoints(const Project& project, const Recording& estimated,
                                        const std::set<int>& judged, const Chain& chain) {
  const std::set<int> shown = JointsShownBy(project, SeenMarkers(estimated));
  std::vector<std::string> unjudged;
  for (const int joint : JointsOf(project, chain)) {
    if (shown.contains(joint) && !judged.contains(joint)) {
      unjudged.push_back(project.tree.joints[joint].name);
    }
  }
  return unjudged;
}

/// The trial that moves the joints of a chain most although it is not said to exercise it.
std::string MovingTrial(const Project& project, const Chain& chain, const Recording& recording) {
  std::vector<int> coordinates;
  for (int joint : JointsOf(project, chain)) {
    coordinates.push_back(project.tree.joints[joint].coordinate);
  }
  std::string moving;
  double most = 0.0;
  for (std::size_t t = 0; t < recording.trials.size(); ++t) {
    if (Exercises(recording.trials[t], chain.name)) continue;
    std::vector<int> postures;
    for (int i = 0; i < recording.posture_count(); ++i) {
      if (recording.trial[i] == static_cast<int>(t)) postures.push_back(i);
    }
    if (postures.empty()) continue;
    const Eigen::MatrixXd q = recording.q(postures, coordinates);
    const double range = (q.colwise().maxCoeff() - q.colwise().minCoeff()).sum();
    if (range <= most) continue;
    most = range;
    moving = recording.trials[t].name;
  }
  return moving;
}

/// The recording in which markers that were not predicted are not seen.
Recording WithoutUnpredicted(Recording recording, const ObservationMask& predicted) {
  for (int i = 0; i < recording.posture_count(); ++i) {
    for (int m = 0; m < recording.marker_count(); ++m) {
      if (!predicted(i, m)) recording.markers.block<1, 3>(i, 3 * m).setConstant(kNaN);
    }
  }
  return recording;
}

/// Whether there are trials for validation, usable or not.
bool HasHeldOut(const std::vector<ChainCoverage>& coverage) {
  return std::ranges::any_of(
      coverage, [](const ChainCoverage& of) { return of.judged || !of.validation_trial.empty(); });
}

bool IsUnusable(const TrialSummary& trial) {
  return trial.trial.kind == TrialKind::kCalibration && !trial.refused.empty();
}

/// The trials for calibration that cannot be used, with the reasons; empty: none.
std::string RefusedTrials(const Measurements& measured) {
  std::string refused;
  for (const TrialSummary& trial : measured.trials) {
    if (!IsUnusable(trial)) continue;
    refused += (refused.empty() ? "trial " : "; trial ") + trial.trial.name + ": " + trial.refused;
  }
  return refused;
}

/// Links of UnknownStance, with the name of a trial that stands there.
std::map<int, std::string> UnknownLegs(const Project& project, const Measurements& measured) {
  std::map<int, std::string> unknown;
  if (!project.elasticity.base) return unknown;
  const std::map<int, std::string> known = StandsAloneOn(measured.calibration);
  for (const auto& [link, trial] : StandsAloneOn(measured.validation)) {
    unknown.emplace(link, trial);
  }
  for (const TrialSummary& trial : measured.trials) {
    const std::vector<int>& support = trial.trial.support;
    if (IsUnusable(trial) && support.size() == 1) {
      unknown.emplace(support.front(), trial.trial.name);
    }
  }
  std::erase_if(unknown, [&](const auto& stance) {  // a held root link has no springs
    return known.contains(stance.first) || project.tree.links[stance.first].body == 0;
  });
  return unknown;
}

}  // namespace

std::vector<ChainCoverage> FindCoverage(const Project& project, const Measurements& measured,
                                        const ObservationMask* predicted) {
  const Recording judged =
      predicted ? WithoutUnpredicted(measured.validation, *predicted) : measured.validation;
  const std::set<int> joints_judged = JointsJudged(project, judged);
  std::vector<ChainCoverage> coverage;
  for (const Chain& chain : project.chains) {
    std::vector<std::string> markers;
    for (const std::string& name : ChainMarkers(project, chain)) {
      const auto marker =
          std::find_if(project.markers.begin(), project.markers.end(),
                       [&](const Marker& candidate) { return candidate.name == name; });
      if (project.tree.links[marker->link].body > 0) markers.push_back(name);
    }
    if (markers.empty()) continue;
    ChainCoverage of{chain.name,
                     Shows(measured.calibration, chain.name, markers,
                           ExercisesEachJoint(project, measured.calibration, chain)),
                     Shows(judged, chain.name, markers, ExercisesEachJoint(project, judged, chain)),
                     {},
                     {},
                     MovingTrial(project, chain, measured.calibration),
                     {},
                     {}};
    if (of.calibrated) of.unseen = UnseenJoints(project, measured.calibration, chain, markers);
    if (of.calibrated && of.judged) {
      of.unjudged = UnjudgedJoints(project, measured.calibration, joints_judged, chain);
    }
    for (const TrialSummary& trial : measured.trials) {
      if (!Exercises(trial.trial, chain.name)) continue;
      if (trial.trial.kind != TrialKind::kCalibration) of.validation_trial = trial.trial.name;
      if (trial.refused.empty() || trial.trial.kind != TrialKind::kCalibration) continue;
      of.refused.push_back("trial " + trial.trial.name + ": " + trial.refused);
    }
    coverage.push_back(std::move(of));
  }
  return coverage;
}

std::vector<std::string> UnknownStance(const Project& project, const Measurements& measured) {
  const std::string refused = RefusedTrials(measured);
  std::vector<std::string> unknown;
  for (const auto& [link, trial] : UnknownLegs(project, measured)) {
    unknown.push_back("how the robot bends on " + project.tree.links[link].name +
                      " alone is not known, on which it stands in trial " + trial +
                      ": no trial for calibration that can be used shows it" +
                      (refused.empty() ? "" : " (" + refused + ")"));
  }
  return unknown;
}

Recording WithKnownStance(const Project& project, const Measurements& measured) {
  const std::map<int, std::string> unknown = UnknownLegs(project, measured);
  std::vector<int> postures;
  for (int i = 0; i < measured.validation.posture_count(); ++i) {
    const std::vector<int>& support =
        measured.validation.trials[measured.validation.trial[i]].support;
    if (support.size() != 1 || !unknown.contains(support.front())) postures.push_back(i);
  }
  return SelectPostures(measured.validation, postures);
}

void JudgeCoverage(const std::vector<ChainCoverage>& coverage, Verdict& verdict) {
  const bool held_out = HasHeldOut(coverage);
  std::vector<std::string> objections;
  for (const ChainCoverage& of : coverage) {
    if (!of.calibrated && !of.refused.empty()) {
      std::string reasons;
      for (const std::string& reason : of.refused)
        reasons += (reasons.empty() ? "" : "; ") + reason;
      objections.push_back("chain " + of.chain + " is not calibrated (" + reasons +
                           "): record it again or, to deploy the others, take its trials out of "
                           "experiment.yaml");
    }
    if (!of.calibrated && of.refused.empty() && !of.validation_trial.empty()) {
      objections.push_back(
          "chain " + of.chain + " is not calibrated: trial " + of.validation_trial +
          " for validation exercises it, and no trial for calibration" +
          (of.moving_trial.empty() ? "" : "; trial " + of.moving_trial + " moves its joints most") +
          ": is `chains` of the trials in experiment.yaml right?");
    }
    if (!of.unseen.empty()) {
      verdict.remarks.push_back(
          fmt::format("chain {}: {} not calibrated, because no marker beyond was seen", of.chain,
                      fmt::join(of.unseen, ", ")));
    }
    if (!of.unjudged.empty()) {
      verdict.remarks.push_back(
          fmt::format("chain {}: {} not judged on held-out data, because no marker beyond was seen "
                      "in the trials for validation that exercise it",
                      of.chain, fmt::join(of.unjudged, ", ")));
    }
    if (of.calibrated && !of.judged && held_out) {
      verdict.remarks.push_back("chain " + of.chain +
                                " was calibrated, but no trial for validation shows it: it is not "
                                "judged on held-out data");
    }
  }
  // First, because missing measurements matter more than the fit of the others.
  verdict.objections.insert(verdict.objections.begin(), objections.begin(), objections.end());
}

std::vector<std::string> NotJudged(const std::vector<ChainCoverage>& coverage) {
  std::vector<std::string> not_judged;
  if (!HasHeldOut(coverage)) return not_judged;
  for (const ChainCoverage& of : coverage) {
    if (of.calibrated && !of.judged) not_judged.push_back("chain " + of.chain);
    for (const std::string& joint : of.unjudged) {
      if (std::ranges::find(not_judged, joint) == not_judged.end()) not_judged.push_back(joint);
    }
  }
  return not_judged;
}

}  // namespace elastocal
