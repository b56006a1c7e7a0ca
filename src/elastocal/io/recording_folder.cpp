// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/recording_folder.hpp"

#include <algorithm>
#include <cstdio>
#include <future>
#include <numbers>
#include <set>

#include "elastocal/io/label_help.hpp"
#include "elastocal/io/motor_columns.hpp"
#include "elastocal/io/recorded_files.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/interruption.hpp"
#include "elastocal/measurement/exchanged_logs.hpp"
#include "elastocal/measurement/marker_units.hpp"
#include "elastocal/measurement/merge_trials.hpp"
#include "elastocal/measurement/session_shapes.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

/// Every joint between the root and a marker or support must have a position.
void CheckJoints(const JointLog& log, const std::vector<int>& markers, const TrialFiles& trial,
                 const Project& project) {
  const RobotTree& tree = project.tree;
  const auto check = [&](int link, const std::string& what) {
    for (int joint : JointsToBody(tree, tree.links[link].body)) {
      const int driver = tree.coordinate_joint[tree.joints[joint].coordinate];
      const std::string& name = tree.joints[driver].name;
      if (std::find(log.names.begin(), log.names.end(), name) != log.names.end() ||
          project.recording.not_recorded.contains(name)) {
        continue;
      }
      const bool revolute = tree.joints[driver].type == JointType::kRevolute;
      throw InputError(
          log.source + ": there is no column of joint " + Quote(name) + ", which moves " + what +
          " of trial " + Quote(trial.name) + OrItsMotors(tree, driver) +
          "; a joint that stood still is given in recording." +
          (revolute ? "not_recorded_deg" : "not_recorded_mm") + " of " + project.file.string());
    }
  };
  for (int marker : markers) {
    check(project.markers[marker].link, "marker " + project.markers[marker].name);
  }
  for (int link : trial.support) check(link, "the support " + tree.links[link].name);
}

Trial TrialOf(const TrialFiles& files, const Project& project) {
  Trial trial{.name = files.name,
              .kind = files.kind,
              .chains = {},
              .support = files.support,
              .free_root = files.free_root,
              .moments = files.moments,
              .session = files.session};
  for (int chain : files.chains) trial.chains.push_back(project.chains[chain].name);
  return trial;
}

TrialSamples Sample(const TrialFiles& files, const MarkedRobot& robot, const Project& project,
                    MarkerFile file, const JointLog& log, const PairDistances& usual = {}) {
  const std::vector<int> markers = TrialMarkers(project, files);
  CheckJoints(log, markers, files, project);
  const MarkerTrajectories& seen = file.trajectories;
  if (const auto other = FindOtherUnit(seen.positions, seen.names, project.markers)) {
    throw InputError(seen.source + ": " + Describe(*other));
  }
  MeasurementOptions options = project.measurement;
  options.labels.usual = usual;
  // In a bag with both, the clocks are the same, except for differences between computers.
  if (file.start_s && files.markers == files.joints) options.expected_lag_s = -*file.start_s;
  if (files.expected_lag_s) options.expected_lag_s = files.expected_lag_s;
  const std::vector<ReferenceLength>& references = project.recording.reference_lengths;
  const auto scale = MeasureScale(references, file.trajectories);
  TrialSamples samples = SampleTrial(robot, TrialOf(files, project), markers,
                                     std::move(file.trajectories), log, options);
  samples.summary.scale = scale;
  samples.summary.reference_missing = !references.empty() && !scale;
  std::erase_if(samples.summary.markers_unknown,
                [&](const std::string& label) { return IsReferenceMarker(references, label); });
  samples.summary.refused += DescribeLabels(samples.summary, project);
  return samples;
}

/// Finds which axis points up: by the user, or by all files. The user may say it for some of the
/// folders; their cameras have one frame.
class UpAxis {
 public:
  explicit UpAxis(const Experiment& experiment)
      : gravity_(experiment.gravity), given_(experiment.up_given) {}

  /// `own`: whether the experiment.yaml of this file says it.
  void Take(const MarkerFile& file, bool own) {
    const std::string& source = file.trajectories.source;
    const std::string up = file.up.empty() && file.up_is_z && !own ? "z" : file.up;
    if (up.empty() && given_) return;
    if (up.empty()) {
      throw InputError(source +
                       ": the file does not say which axis of the cameras' frame points up; give "
                       "it in experiment.yaml, 'up: z' (or x, y, -x, -y, -z)");
    }
    const Eigen::Vector3d gravity = GravityBelow(up);
    if ((given_ || !first_.empty()) && gravity != gravity_) {
      throw InputError(source + ": by this file the axis " + up + " points up; " +
                       (given_ ? "experiment.yaml" : first_) + " has another one");
    }
    gravity_ = gravity;
    if (first_.empty()) first_ = source;
  }

  const Eigen::Vector3d& gravity() const { return gravity_; }

 private:
  Eigen::Vector3d gravity_;
  bool given_;
  std::string first_;  ///< the file that said it first
};

/// The joints whose torques a log has although the project lists no torque sensors. A driver
/// without torques writes the same number always. Simulated logs are left out: their project says
/// what it wants of them.
void AddUnlistedTorques(const JointLog& log, const TrialFiles& trial, const Project& project,
                        std::set<std::string>& unlisted) {
  const auto& torsion = project.elasticity.torsion;
  const bool rigid = torsion && torsion->empty();
  std::error_code error;
  if (!project.torque_sensors.empty() || rigid ||
      fs::exists(trial.markers.parent_path() / "truth.yaml", error)) {
    return;
  }
  for (Eigen::Index c = 0; c < log.torques.cols(); ++c) {
    const auto torques = log.torques.col(c);
    if (!torques.allFinite() || torques.maxCoeff() == torques.minCoeff()) continue;
    unlisted.insert(log.names[static_cast<std::size_t>(c)]);
  }
}

std::string DescribeUnlisted(const std::set<std::string>& joints, const Project& project) {
  return "torques of " + FirstOf({joints.begin(), joints.end()}) +
         " are logged, and not used: " + project.file.string() +
         " lists no torque_sensors, so that statics gives the loads. List the joints there whose "
         "torques are measured";
}

/// What the logs of all trials have.
struct LoggedJoints {
  std::vector<std::set<std::string>> of_trial;
  std::set<std::string> unlisted_torques;  ///< AddUnlistedTorques
};

/// Samples all trials; while one is sampled, the markers of the next are read on another thread.
/// `logged` gets the joints that the log of each has.
std::vector<TrialSamples> SampleAll(const std::vector<TrialFiles>& trials, const MarkedRobot& robot,
                                    const Project& project, UpAxis& up,
                                    const std::vector<bool>& up_given, LoggedJoints& logged) {
  std::vector<TrialSamples> samples;
  const InterruptionOfCaller interruption;
  const auto start_reading = [&](std::size_t i) {
    return std::async(std::launch::async, [&, &trial = trials[i]] {
      const Interruptible interruptible = interruption.Share();
      return ReadMarkerFile(trial.markers, trial.reading, project);
    });
  };
  std::future<MarkerFile> markers = start_reading(0);
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const JointLog log = ReadJointFile(trials[i].joints, trials[i].reading, project);
    logged.of_trial.emplace_back(log.names.begin(), log.names.end());
    AddUnlistedTorques(log, trials[i], project, logged.unlisted_torques);
    while (markers.wait_for(kBetweenLooks) != std::future_status::ready) InterruptionPoint();
    MarkerFile file = markers.get();
    up.Take(file, up_given[static_cast<std::size_t>(trials[i].session)]);
    if (i + 1 < trials.size()) markers = start_reading(i + 1);
    samples.push_back(Sample(trials[i], robot, project, std::move(file), log));
  }
  return samples;
}

/// Samples trials again whose clusters have another shape than in most trials, now with the usual
/// shape.
void SampleOddOnesAgain(const std::vector<TrialFiles>& trials, const MarkedRobot& robot,
                        const Project& project, std::vector<TrialSamples>& samples) {
  std::vector<TrialSummary> summaries;
  for (const TrialSamples& of : samples) summaries.push_back(of.summary);
  const PairDistances usual = UsualDistances(summaries, NominalDistances(robot));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!DiffersFromUsual(summaries[i], usual)) continue;
    samples[i] = Sample(trials[i], robot, project,
                        ReadMarkerFile(trials[i].markers, trials[i].reading, project),
                        ReadJointFile(trials[i].joints, trials[i].reading, project), usual);
  }
}

std::string NameOf(const fs::path& folder) {
  const fs::path normal = (folder / "").lexically_normal();
  return normal.parent_path().filename().string();
}

/// The trials of all folders, under names of their own.
/// `up_given` says which of the folders state the axis that points up.
Experiment ReadExperiments(const std::vector<fs::path>& folders, const Project& project,
                           std::vector<bool>& up_given) {
  Experiment all;
  fs::path first_given;
  for (std::size_t i = 0; i < folders.size(); ++i) {
    Experiment one = ReadExperiment(folders[i], project);
    up_given.push_back(one.up_given);
    if (one.up_given) {
      if (all.up_given && one.gravity != all.gravity) {
        throw InputError(folders[i].string() + ": the cameras have another axis up than in " +
                         first_given.string());
      }
      if (!all.up_given) first_given = folders[i];
      all.gravity = one.gravity;
      all.up_given = true;
    }
    for (TrialFiles& trial : one.trials) {
      if (folders.size() > 1) trial.name = NameOf(folders[i]) + "/" + trial.name;
      trial.session = static_cast<int>(i);
      all.trials.push_back(std::move(trial));
    }
  }
  std::set<std::string> names;
  for (const TrialFiles& trial : all.trials) {
    if (names.insert(trial.name).second) continue;
    throw InputError("two trials of the name " + Quote(trial.name) +
                     "; is a recording folder given twice?");
  }
  return all;
}

/// The trials whose logs have no positions of a joint.
std::vector<std::string> TrialsWithout(const std::string& joint,
                                       const std::vector<TrialFiles>& trials,
                                       const std::vector<std::set<std::string>>& logged) {
  std::vector<std::string> without;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (!logged[i].contains(joint)) without.push_back(trials[i].name);
  }
  return without;
}

/// A sentence about a joint whose positions are absent in the logs of `trials`, but not of others.
std::string DescribeMissing(const std::string& joint, double position,
                            const std::vector<std::string>& trials, const Project& project) {
  std::string names;
  for (const std::string& name : trials) names += (names.empty() ? "" : ", ") + name;
  const bool slides =
      project.tree.joints[FindJoint(project.tree, joint)].type == JointType::kPrismatic;
  char place[64];
  std::snprintf(place, sizeof place, "%.6g %s",
                slides ? 1e3 * position : 180.0 / std::numbers::pi * position,
                slides ? "mm" : "deg");
  return joint + ": only some logs have its positions; in those of " + names +
         " it is taken to stand still at " + place +
         ", as the project says (recording.not_recorded)";
}

}  // namespace

bool IsRecordingFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path / "experiment.yaml", error);
}

RecordingFolder ReadRecordingFolders(const std::vector<fs::path>& folders, const Project& project) {
  if (folders.empty()) throw InputError("no recording folder; one or more were expected");
  std::vector<bool> up_given;
  const Experiment experiment = ReadExperiments(folders, project, up_given);
  const MarkedRobot robot = MakeMarkedRobot(project);
  std::vector<TrialSamples> calibration, validation;
  RecordingFolder result;
  UpAxis up(experiment);
  LoggedJoints logged;
  std::vector<TrialSamples> sampled =
      SampleAll(experiment.trials, robot, project, up, up_given, logged);
  SampleOddOnesAgain(experiment.trials, robot, project, sampled);
  RefuseExchangedLogs(
      [&](std::size_t markers_of, std::size_t log_of) {
        const TrialFiles& trial = experiment.trials[markers_of];
        const TrialFiles& other = experiment.trials[log_of];
        return Sample(trial, robot, project, ReadMarkerFile(trial.markers, trial.reading, project),
                      ReadJointFile(other.joints, other.reading, project));
      },
      sampled);
  for (TrialSamples& samples : sampled) {
    result.trials.push_back(samples.summary);
    for (std::string& finding : Findings(samples.summary)) {
      result.findings.push_back(std::move(finding));
    }
    auto& group = samples.summary.trial.kind == TrialKind::kCalibration ? calibration : validation;
    group.push_back(std::move(samples));
  }
  std::string source;
  for (const fs::path& folder : folders) source += (source.empty() ? "" : ", ") + folder.string();
  result.calibration = MergeTrials(robot, calibration, source);
  result.validation = MergeTrials(robot, validation, source);
  result.calibration.gravity = result.validation.gravity = up.gravity();
  for (const auto& [name, position] : project.recording.not_recorded) {
    const std::vector<std::string> without =
        TrialsWithout(name, experiment.trials, logged.of_trial);
    if (without.size() == experiment.trials.size()) {
      result.calibration.joints_not_recorded.push_back(name);
      result.validation.joints_not_recorded.push_back(name);
    } else if (!without.empty()) {
      result.findings.push_back(DescribeMissing(name, position, without, project));
    }
  }
  if (!logged.unlisted_torques.empty()) {
    result.findings.push_back(DescribeUnlisted(logged.unlisted_torques, project));
  }
  if (result.calibration.posture_count() + result.validation.posture_count() == 0) {
    throw InputError(source + ": no trial can be used; " + result.findings.front());
  }
  return result;
}

std::vector<int> TrialMarkers(const Project& project, const TrialFiles& trial) {
  std::set<std::string> names;
  for (int chain : trial.chains) {
    for (std::string& name : ChainMarkers(project, project.chains[chain])) {
      names.insert(std::move(name));
    }
  }
  std::set<int> bodies = {0};
  for (int link : trial.support) bodies.insert(project.tree.links[link].body);
  std::vector<int> markers;
  for (std::size_t m = 0; m < project.markers.size(); ++m) {
    const Marker& marker = project.markers[m];
    if (names.contains(marker.name) || bodies.contains(project.tree.links[marker.link].body)) {
      markers.push_back(static_cast<int>(m));
    }
  }
  return markers;
}

MarkedRobot MakeMarkedRobot(const Project& project) {
  constexpr std::size_t kFewestOfCluster = 3;
  MarkedRobot robot;
  robot.tree = project.tree;
  robot.markers = project.markers;
  for (const MarkerCluster& cluster : RigidClusters(project)) {
    // A pair does not tell which of its labels is wrong.
    if (cluster.markers.size() < kFewestOfCluster) continue;
    robot.clusters.push_back({cluster.name, cluster.markers});
  }
  robot.torque_sensors = project.torque_sensors;
  robot.q_not_logged.setZero(project.tree.coordinate_count());
  for (const auto& [name, position] : project.recording.not_recorded) {
    robot.q_not_logged[project.tree.joints[FindJoint(project.tree, name)].coordinate] = position;
  }
  return robot;
}

}  // namespace elastocal
