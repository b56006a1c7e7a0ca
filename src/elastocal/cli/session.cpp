#include "elastocal/cli/session.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "elastocal/io/output_files.hpp"
#include "elastocal/io/recording_folder.hpp"
#include "elastocal/io/summary.hpp"
#include "elastocal/io/waist_truth.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal::cli {
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

/// Only the markers that were seen for calibration: a model has no position for others.
Recording WithMarkers(const Recording& recording, const std::vector<int>& markers) {
  Recording selected = recording;
  selected.marker_names.clear();
  selected.markers.resize(recording.posture_count(), 3 * static_cast<Eigen::Index>(markers.size()));
  for (std::size_t k = 0; k < markers.size(); ++k) {
    selected.marker_names.push_back(recording.marker_names[markers[k]]);
    selected.markers.middleCols<3>(3 * static_cast<Eigen::Index>(k)) =
        recording.markers.middleCols<3>(3 * markers[k]);
  }
  return selected;
}

/// True waists at the times of the postures, of trials that have a file of them.
std::vector<std::optional<Transform>> TrueWaists(const std::vector<std::filesystem::path>& folders,
                                                 const Project& project,
                                                 const Recording& recording) {
  std::vector<std::optional<Transform>> waists(recording.posture_count());
  for (const std::filesystem::path& folder : folders) {
    for (const TrialFiles& files : ReadExperiment(folder, project).trials) {
      if (files.truth.empty()) continue;
      const WaistTruth truth = ReadWaistTruth(files.truth);
      for (int i = 0; i < recording.posture_count(); ++i) {
        const std::string& name = recording.trials[recording.trial[i]].name;
        const bool same = folders.size() == 1 ? name == files.name : name.ends_with(files.name);
        if (!same || truth.time_s.size() == 0) continue;
        Eigen::Index nearest = 0;
        (truth.time_s.array() - recording.time_s[i]).abs().minCoeff(&nearest);
        waists[i] = truth.T_camera_waist[static_cast<std::size_t>(nearest)];
      }
    }
  }
  return waists;
}

void OpenFolders(const std::vector<std::filesystem::path>& folders, Session& session) {
  RecordingFolder read = ReadRecordingFolders(folders, session.project);
  if (read.calibration.posture_count() == 0) std::swap(read.calibration, read.validation);
  session.trials = std::move(read.trials);
  session.warnings = std::move(read.findings);
  std::vector<int> seen;
  const ObservationMask mask = SeenMask(read.calibration);
  for (int m = 0; m < mask.cols(); ++m) {
    if (mask.col(m).any()) seen.push_back(m);
  }
  session.recording = WithMarkers(read.calibration, seen);
  session.recording_truth = TrueWaists(folders, session.project, session.recording);
  if (read.validation.posture_count() == 0) return;
  session.validation = WithMarkers(read.validation, seen);
  session.validation_truth = TrueWaists(folders, session.project, session.validation);
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

/// Takes knocked clusters as two, and says so.
void SplitKnocked(Session& session) {
  session.knocks =
      FindKnocks(session.model, session.recording, session.base,
                 SeenClusters(session.project, session.recording), session.project.calibration);
  const std::vector<Knock>& knocks = session.knocks;
  if (knocks.empty()) return;
  for (const Knock& knock : knocks) {
    session.warnings.push_back(fmt::format(
        "cluster {}: the data before and after disagree by {:.1f} mm (up to {}; from {} on): was "
        "it knocked? Its markers are taken as two sets",
        knock.cluster, 1e3 * knock.distance, DescribePosture(session.recording, knock.last_before),
        DescribePosture(session.recording, knock.posture)));
  }
  SplitMarkers(knocks, session.model, session.recording);
  if (session.validation.posture_count() > 0) AddUnseenMarkers(session.model, session.validation);
  session.base = FindBaseParameters(session.model, session.project.identifiability);
}

}  // namespace

Session OpenSession(const std::filesystem::path& project,
                    const std::vector<std::filesystem::path>& recordings,
                    std::optional<std::uint64_t> seed) {
  Session session;
  session.project = ReadProject(project);
  if (seed) session.project.identifiability.seed = *seed;
  if (std::any_of(recordings.begin(), recordings.end(), IsRecordingFolder)) {
    OpenFolders(recordings, session);
  } else if (recordings.size() == 1) {
    PostureTable table = ReadPostureTable(recordings[0], session.project);
    session.recording = std::move(table.recording);
    session.warnings = std::move(table.warnings);
  } else {
    throw InputError(recordings[1].string() +
                     ": no experiment.yaml in it; only recording folders can be taken together");
  }
  session.model = SelectMarkers(MakeProjectModel(session.project, session.recording.trials),
                                session.recording.marker_names);
  const IdentifiabilityOptions& options = session.project.identifiability;
  session.base = FindBaseParameters(session.model, options);
  if (!session.recording.trials.empty()) SplitKnocked(session);
  WarnOfLostRank(session.model, options, session.base, session.warnings);
  return session;
}

void CheckOutputs(const std::vector<std::filesystem::path>& outputs,
                  const std::vector<std::filesystem::path>& inputs) {
  for (const std::filesystem::path& output : outputs) {
    for (const std::filesystem::path& input : inputs) {
      if (!output.empty() && SameFile(output, input)) {
        throw InputError(output.string() + ": this is an input; choose another output");
      }
    }
  }
}

Progress TerminalProgress(const std::string& what, bool quiet) {
  if (quiet || isatty(STDERR_FILENO) == 0) return {};
  return [what](int done, int total) {
    fmt::print(stderr, "\r{} {}/{}", what, done, total);
    if (done == total) fmt::print(stderr, "\r{:{}}\r", "", what.size() + 20);
    std::fflush(stderr);
  };
}

void Print(bool quiet, const std::string& text) {
  if (!quiet) fmt::print("{}", text);
}

void PrintWarnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) spdlog::warn("{}", warning);
}

double InUserUnits(const Parameter& parameter, double value) {
  switch (parameter.unit) {
    case ParameterUnit::kRadian:
      return value * 180.0 / M_PI;
    case ParameterUnit::kMetre:
      return value * 1e3;
    case ParameterUnit::kRadianPerNewtonMetre:
    case ParameterUnit::kMetrePerNewton:
      return value * 1e6;
    default:
      return value;
  }
}

const char* UserUnit(const Parameter& parameter) {
  switch (parameter.unit) {
    case ParameterUnit::kRadian:
      return "deg";
    case ParameterUnit::kMetre:
      return "mm";
    case ParameterUnit::kRadianPerNewtonMetre:
      return "urad/(N.m)";
    case ParameterUnit::kMetrePerNewton:
      return "um/N";
    default:
      return UnitName(parameter.unit);
  }
}

std::string JoinNames(const std::vector<Parameter>& parameters, const std::vector<int>& which) {
  std::vector<std::pair<std::string, std::string>> groups;
  for (int i : which) {
    const std::string& name = parameters[i].name;
    const std::size_t dot = name.rfind('.');
    const std::string owner = name.substr(0, dot);
    if (groups.empty() || groups.back().first != owner) groups.push_back({owner, ""});
    std::string& constants = groups.back().second;
    constants += (constants.empty() ? "" : ",") + name.substr(dot + 1);
  }
  std::string text;
  for (const auto& [owner, constants] : groups) {
    text += (text.empty() ? "" : ", ") + owner + "." +
            (constants.find(',') == std::string::npos ? constants : "{" + constants + "}");
  }
  return text;
}

}  // namespace elastocal::cli
