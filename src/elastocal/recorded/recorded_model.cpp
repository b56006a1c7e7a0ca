// SPDX-License-Identifier: Apache-2.0
#include "elastocal/recorded/recorded_model.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "elastocal/calibration/placing_markers.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/robot/parameter_names.hpp"
#include "elastocal/screening/moved_markers.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kManySensors = 4;

/// Names joints whose limits leave them no motion, so that nothing can be identified there.
std::string StuckJoints(const ErrorModel& model) {
  std::string names;
  for (int k : model.active_joints) {
    const Joint& joint = model.tree.joints[k];
    if (joint.limits.lower < joint.limits.upper) continue;
    names += (names.empty() ? "" : ", ") + joint.name;
  }
  return names;
}

void WarnOfLostRank(const ErrorModel& model, const IdentifiabilityOptions& options,
                    const BaseParameters& base, std::vector<std::string>& warnings) {
  if (base.geometric_count >= base.theoretical_count) return;
  const std::string stuck = StuckJoints(model);
  const std::vector<int> lost = LostBySpecialMarkers(model, options);
  const std::string count = fmt::format("{} of {} parameters are identifiable",
                                        base.geometric_count, base.theoretical_count);
  if (!lost.empty()) {
    warnings.push_back(fmt::format(
        "only {}: the nominal marker positions are special (on a joint axis?). Lost: {}. Give "
        "markers positions off the axes, however rough.",
        count, JoinNames(model.parameters, lost)));
  } else if (!stuck.empty()) {
    warnings.push_back(
        fmt::format("only {}: these joints cannot move within their limits: {}", count, stuck));
  } else if (base.held.empty()) {
    warnings.push_back(fmt::format("only {}; see inspect for what is not", count));
  }
}

/// Hides the torques of sensors that contradict statics.
std::vector<ContradictoryTorque> CheckTorques(const ErrorModel& model,
                                              const CalibrationOptions& options,
                                              Measurements& measured) {
  std::vector<ContradictoryTorque> found =
      FindContradictoryTorques(model, measured.calibration, options.slip);
  for (const ContradictoryTorque& one : found) {
    measured.warnings.push_back(Describe(one, model.tree) +
                                "; not used, statics takes their place");
  }
  if (found.size() >= kManySensors) {
    measured.warnings.push_back(
        fmt::format("{} torque sensors contradict statics: are `up` in experiment.yaml, the unit "
                    "(N.m) and the sign (torques balance the load) right?",
                    found.size()));
  }
  HideTorques(found, measured.calibration);
  HideTorques(found, measured.validation);
  return found;
}

/// Warns of few markers on the root link. On two feet, and in trials that no leg ties to the floor,
/// only these locate the waist; where the root is free, those of another body also do.
void WarnOfFewWaistMarkers(const ErrorModel& model, bool free_root,
                           std::vector<std::string>& warnings) {
  if (TellPose(MarkersOnBody(model, 0))) return;
  for (int body = 1; free_root && body < model.tree.body_count(); ++body) {
    if (TellPose(MarkersOnBody(model, body))) return;
  }
  const auto count = MarkersOnBody(model, 0).cols();
  warnings.push_back(
      free_root ? "no link has three markers that do not lie on a line: held-out postures cannot "
                  "be placed, so that nothing judges the estimate"
                : fmt::format("{} marker{} on the root link{}; three or more that do not lie on a "
                              "line were expected: else the pose of the waist leans on the "
                              "markers of the chains",
                              count, count == 1 ? "" : "s", count < 3 ? "" : " lie on a line"));
}

/// Checks that several bodies have markers. With a free root, only motions of one body's markers
/// relative to another's show errors.
void CheckFreeRoot(const ErrorModel& model, const Recording& recording) {
  for (const Marker& marker : model.markers) {
    const int first = model.tree.links[model.markers[0].link].body;
    if (model.tree.links[marker.link].body != first) return;
  }
  throw InputError(fmt::format(
      "{}: the root is free, and all markers are on one body (that of link '{}'): nothing tells "
      "motions of the joints from those of the root; markers on two bodies or more, joints between "
      "them, were expected",
      recording.source, model.tree.links[model.markers[0].link].name));
}

std::string DescribeKnock(const Knock& knock, const Recording& recording) {
  if (recording.trials.empty()) {
    return fmt::format(
        "marker {}: its distances to the other markers of cluster {} change by up to {:.1f} mm "
        "from {} on: was it glued on again? It is taken as two markers",
        recording.marker_names[Size(knock.markers.front())], knock.cluster, 1e3 * knock.distance,
        DescribePosture(recording, knock.posture));
  }
  return fmt::format(
      "cluster {}: the data before and after disagree by {:.1f} mm (up to {}; from {} on): was "
      "it knocked? Its markers are taken as two sets",
      knock.cluster, 1e3 * knock.distance, DescribePosture(recording, knock.last_before),
      DescribePosture(recording, knock.posture));
}

}  // namespace

std::vector<LabelCluster> SeenClusters(const Project& project, const Recording& recording) {
  const std::vector<std::string>& names = recording.marker_names;
  std::vector<LabelCluster> clusters;
  for (const MarkerCluster& cluster : RigidClusters(project)) {
    LabelCluster seen{cluster.name, {}};
    for (int m : cluster.markers) {
      const auto found = std::find(names.begin(), names.end(), project.markers[m].name);
      if (found != names.end()) seen.markers.push_back(static_cast<int>(found - names.begin()));
    }
    if (!seen.markers.empty()) clusters.push_back(std::move(seen));
  }
  return clusters;
}

RecordedModel MakeRecordedModel(const Project& project, std::optional<std::uint64_t> seed,
                                Measurements& measured, KnockSearch search) {
  IdentifiabilityOptions options = project.identifiability;
  if (seed) options.seed = *seed;
  Recording& recording = measured.calibration;
  const bool free_root = HasFreeRoot(recording);
  if (free_root) options.root = RootPose::kFree;
  RecordedModel result;
  result.model = SelectMarkers(MakeProjectModel(project, recording.trials), recording.marker_names);
  if (free_root) CheckFreeRoot(result.model, recording);
  result.contradictory = CheckTorques(result.model, project.calibration, measured);
  result.base = FindBaseParameters(result.model, options);
  if (search == KnockSearch::kAll) {
    const std::vector<LabelCluster> clusters = SeenClusters(project, recording);
    result.knocks = recording.trials.empty() ? FindMovedMarkers(recording, clusters)
                                             : FindKnocks(result.model, recording, result.base,
                                                          clusters, project.calibration);
  }
  if (!result.knocks.empty()) {
    for (const Knock& knock : result.knocks) {
      measured.warnings.push_back(DescribeKnock(knock, recording));
    }
    SplitMarkers(result.knocks, result.model, recording);
    if (measured.validation.posture_count() > 0) {
      AddUnseenMarkers(result.model, measured.validation);
    }
    result.base = FindBaseParameters(result.model, options);
  }
  if (HasPoseByPosture(recording)) {
    WarnOfFewWaistMarkers(result.model, free_root, measured.warnings);
  }
  WarnOfLostRank(result.model, options, result.base, measured.warnings);
  return result;
}

}  // namespace elastocal
