#include "elastocal/pipeline/recorded_model.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/robot/parameter_names.hpp"
namespace elastocal {
namespace {

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

/// The project's clusters as far as their markers were seen.
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

std::string DescribeKnock(const Knock& knock, const Recording& recording) {
  return fmt::format(
      "cluster {}: the data before and after disagree by {:.1f} mm (up to {}; from {} on): was "
      "it knocked? Its markers are taken as two sets",
      knock.cluster, 1e3 * knock.distance, DescribePosture(recording, knock.last_before),
      DescribePosture(recording, knock.posture));
}

}  // namespace

RecordedModel MakeRecordedModel(const Project& project, std::optional<std::uint64_t> seed,
                                Measurements& measured) {
  IdentifiabilityOptions options = project.identifiability;
  if (seed) options.seed = *seed;
  Recording& recording = measured.calibration;
  RecordedModel result;
  result.model = SelectMarkers(MakeProjectModel(project, recording.trials), recording.marker_names);
  result.base = FindBaseParameters(result.model, options);
  if (!recording.trials.empty()) {
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
  WarnOfLostRank(result.model, options, result.base, measured.warnings);
  return result;
}

}  // namespace elastocal
