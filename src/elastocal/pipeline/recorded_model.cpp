// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/recorded_model.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "elastocal/calibration/torque_check.hpp"
#include "elastocal/math/decompositions.hpp"
#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/robot/parameter_names.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kManySensors = 4;
constexpr double kLeastWidth = 0.01;  // m: of the markers about the line that fits them best

/// Joints whose limits leave them no motion: nothing can be identified there.
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

/// Torque sensors that contradict statics are not used.
void CheckTorques(const ErrorModel& model, const CalibrationOptions& options,
                  Measurements& measured) {
  const std::vector<ContradictoryTorque> found =
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
}

/// On two feet, and in trials that no leg ties to the floor, the markers on the root link are all
/// that locates the waist.
void WarnOfFewWaistMarkers(const ErrorModel& model, std::vector<std::string>& warnings) {
  std::vector<Eigen::Vector3d> positions;
  for (const Marker& marker : model.markers) {
    const Link& link = model.tree.links[marker.link];
    if (link.body == 0) positions.push_back(link.T_body_link * marker.p_link_marker);
  }
  const auto count = static_cast<Eigen::Index>(positions.size());
  const Eigen::Map<const Eigen::Matrix3Xd> all(positions.empty() ? nullptr : positions[0].data(), 3,
                                               count);
  std::string found = fmt::format("{} markers on the root link", count);
  if (count >= 3) {
    const Eigen::VectorXd spread = SingularValues(all.colwise() - all.rowwise().mean());
    if (spread[1] > kLeastWidth) return;
    found += " lie on a line";
  }
  warnings.push_back(found +
                     "; three or more that do not lie on a line were expected: else the pose of "
                     "the waist leans on the markers of the chains");
}

std::string DescribeKnock(const Knock& knock, const Recording& recording) {
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
  for (const MarkerCluster& cluster : project.clusters) {
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
  RecordedModel result;
  result.model = SelectMarkers(MakeProjectModel(project, recording.trials), recording.marker_names);
  CheckTorques(result.model, project.calibration, measured);
  result.base = FindBaseParameters(result.model, options);
  if (!recording.trials.empty() && search == KnockSearch::kAll) {
    result.knocks = FindKnocks(result.model, recording, result.base,
                               SeenClusters(project, recording), project.calibration);
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
  if (!recording.trials.empty()) WarnOfFewWaistMarkers(result.model, measured.warnings);
  WarnOfLostRank(result.model, options, result.base, measured.warnings);
  return result;
}

}  // namespace elastocal
