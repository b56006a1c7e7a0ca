// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/simulate_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/io/joint_log.hpp"
#include "elastocal/io/marker_places_file.hpp"
#include "elastocal/io/motion_file.hpp"
#include "elastocal/io/motor_columns.hpp"
#include "elastocal/io/posture_file.hpp"
#include "elastocal/io/waist_truth.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/parallel.hpp"
#include "elastocal/planning/truth_file.hpp"
#include "elastocal/readers/qtm_tsv.hpp"
#include "elastocal/robot/physical_inertia.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

std::vector<std::size_t> ChooseTrials(const VirtualExperiment& experiment,
                                      const std::string& which) {
  std::vector<std::size_t> chosen;
  std::vector<std::string> names = {"all", "calibration", "validation"};
  for (std::size_t i = 0; i < experiment.trials.size(); ++i) {
    const PlannedTrial& trial = experiment.trials[i];
    names.push_back(trial.name);
    const bool calibration = trial.kind == TrialKind::kCalibration;
    if (which == "all" || which == trial.name ||
        which == (calibration ? "calibration" : "validation")) {
      chosen.push_back(i);
    }
  }
  if (chosen.empty()) {
    throw InputError("there is no trial '" + which + "'" + DidYouMean(which, names));
  }
  return chosen;
}

/// The model that a calibration of these trials uses, with its errors.
MatchedExperiment MatchTrials(const VirtualExperiment& experiment, const Project& project,
                              const std::vector<std::size_t>& chosen) {
  std::vector<Trial> trials;
  for (std::size_t i : chosen) {
    const PlannedTrial& planned = experiment.trials[i];
    if (planned.kind != TrialKind::kCalibration) continue;
    Trial trial{planned.name, planned.kind, {}, planned.support};
    for (int chain : planned.chains) trial.chains.push_back(project.chains[chain].name);
    trials.push_back(trial);
  }
  if (trials.empty()) {
    throw InputError(
        "a matched truth is that of the model for calibration trials, and none is played");
  }
  const ErrorModel model = MakeProjectModel(project, trials);
  return MatchExperiment(experiment, model,
                         FindBaseParameters(model, project.identifiability).kept);
}

/// Refuses very long trials: memory grows with the duration, and real trials have breaks.
void CheckDurations(const Simulation& simulation) {
  constexpr double kLongest = 3600.0;
  for (const std::size_t i : simulation.chosen) {
    const PlannedTrial& trial = simulation.experiment.trials[i];
    const double duration = trial.motion.duration_s();
    if (duration <= kLongest) continue;
    throw InputError("trial '" + trial.name + "' lasts " + FormatNumber(std::round(duration)) +
                     " s; at most 3600 s are simulated at a time (fewer postures, or less time "
                     "for each)");
  }
}

/// Bars that stand upright beside the robot, in the frame of the room. Their lengths have the
/// errors that the project states.
std::vector<std::array<Eigen::Vector3d, 2>> DrawBars(const std::vector<ReferenceLength>& references,
                                                     std::uint64_t seed) {
  constexpr double kBeside = 1.2, kApart = 0.2, kAboveFloor = 0.1;
  Random random(seed ^ 0xba5);
  std::vector<std::array<Eigen::Vector3d, 2>> bars;
  for (const ReferenceLength& reference : references) {
    const double x = kApart * static_cast<double>(bars.size());
    const double length = reference.length + random.Normal(reference.sd);
    bars.push_back({Eigen::Vector3d(x, kBeside, kAboveFloor),
                    Eigen::Vector3d(x, kBeside, kAboveFloor + length)});
  }
  return bars;
}

/// Adds the markers of the bars to those that the cameras see.
void SeeBars(const std::vector<ReferenceLength>& references,
             const std::vector<std::array<Eigen::Vector3d, 2>>& bars, double noise_sd,
             std::uint64_t seed, MarkerTrajectories& markers) {
  Random random(seed);
  const Eigen::Index frames = markers.positions.rows();
  for (std::size_t k = 0; k < bars.size(); ++k) {
    for (std::size_t end = 0; end < 2; ++end) {
      const Eigen::Index column = markers.positions.cols();
      markers.names.push_back(references[k].markers[end]);
      markers.positions.conservativeResize(frames, column + 3);
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        markers.positions.col(column + axis) =
            random.NormalVector(frames, noise_sd).array() + bars[k][end][axis];
      }
    }
  }
}

/// Names of the markers of some clusters; of all markers where no cluster is named.
std::set<std::string> MarkersOfClusters(const Project& project,
                                        const std::vector<std::string>& clusters) {
  std::set<std::string> markers;
  if (clusters.empty()) {
    for (const Marker& marker : project.markers) markers.insert(marker.name);
  }
  for (const MarkerCluster& cluster : project.clusters) {
    const auto found = std::find(clusters.begin(), clusters.end(), cluster.name);
    if (found == clusters.end()) continue;
    for (const int marker : cluster.markers) markers.insert(project.markers[Size(marker)].name);
  }
  return markers;
}

/// Positions of some markers on the links of the true robot, measured with noise. What is drawn for
/// a marker does not depend on which others are measured.
std::vector<MarkerMeasurement> MeasurePlaces(const std::vector<Marker>& markers,
                                             const std::set<std::string>& measured, double sd,
                                             std::uint64_t seed) {
  Random random(seed ^ 0x91ace);
  std::vector<MarkerMeasurement> places;
  for (const Marker& marker : markers) {
    const Eigen::Vector3d place = marker.p_link_marker + random.NormalVector(3, sd);
    if (measured.contains(marker.name)) places.push_back({marker.name, place, sd});
  }
  return places;
}

SimulatedTrial Play(const Simulation& simulation, std::size_t trial) {
  return simulation.matched ? RunMatchedTrial(*simulation.matched, trial)
                            : RunTrial(simulation.experiment, trial);
}

WaistGive LargestDeflection(const Simulation& simulation, std::size_t trial,
                            const TrueMotion& motion) {
  return simulation.matched ? LargestMatchedDeflection(*simulation.matched, trial, motion)
                            : LargestWaistDeflection(simulation.experiment, trial, motion);
}

/// Entries of Simulation::chosen, the longest trials first, so that threads finish at about the
/// same time.
std::vector<std::size_t> LongestFirst(const Simulation& simulation) {
  std::vector<std::size_t> order(simulation.chosen.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto duration = [&](std::size_t i) {
    return simulation.experiment.trials[simulation.chosen[i]].motion.duration_s();
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return duration(a) > duration(b); });
  return order;
}

/// Paths of the files before they are published.
TrialFiles Staged(const TrialFiles& files, OutputSet& outputs) {
  TrialFiles staged = files;
  for (fs::path* file : {&staged.markers, &staged.joints, &staged.truth}) {
    *file = outputs.StagingPath(*file);
  }
  return staged;
}

}  // namespace

std::vector<std::string> SimulationWarnings(const Project& project, const Simulation& simulation) {
  std::vector<std::string> warnings = InertiaWarnings(project.tree);
  const std::vector<PlannedTrial>& trials = simulation.experiment.trials;
  const bool held = std::all_of(trials.begin(), trials.end(),
                                [](const PlannedTrial& trial) { return trial.support.empty(); });
  if (held && !simulation.experiment.legs.empty()) {
    warnings.emplace_back(
        "no postures were found in which the robot stands on one and on both of its feet, as these "
        "trials have it: its root link is held still in all of them, and its legs carry nothing. "
        "`plan` a motion of designed postures and play it (`simulate --motion`) to record it "
        "standing");
  }
  return warnings;
}

Simulation PrepareSimulation(const Project& project, const SimulationOptions& options) {
  CheckHasMarkers(project);
  const DescribedRobot robot = DescribeRobot(project);
  VirtualExperimentOptions settings = options.experiment;
  settings.free_root = project.recording.free_root;
  settings.physics.soles = project.soles;
  if (options.matched && settings.free_root) {
    throw InputError(project.file.string() +
                     ": the root is free (recording: root), and a matched truth is that of a root "
                     "link that is held or stands");
  }
  if (options.matched && options.marker_places_sd > 0.0) {
    throw InputError(
        "places of markers are measured on a simulated robot (--marker-places-mm); a matched truth "
        "has none");
  }
  Simulation simulation;
  if (options.motion) {
    settings.motion.seed = settings.seed;
    GivenMotionOptions given = options.given;
    given.soles = project.soles;
    simulation.experiment = PrepareExperiment(
        robot, settings,
        PlanGivenMotion(robot.tree, robot.chains, *options.motion, settings.motion, given));
  } else {
    simulation.experiment = PrepareExperiment(robot, settings);
  }
  simulation.chosen = ChooseTrials(simulation.experiment, options.trials);
  CheckDurations(simulation);
  if (options.matched) {
    simulation.matched = MatchTrials(simulation.experiment, project, simulation.chosen);
    simulation.experiment = simulation.matched->plan;
  }
  simulation.bars = DrawBars(project.recording.reference_lengths, settings.seed);
  if (options.marker_places_sd > 0.0) {
    simulation.marker_places = MeasurePlaces(simulation.experiment.robot.markers,
                                             MarkersOfClusters(project, options.marker_places_of),
                                             options.marker_places_sd, settings.seed);
  }
  return simulation;
}

SimulationRun PlaySimulation(const Project& project, const Simulation& simulation,
                             const SimulationFiles& files, int threads, OutputSet& outputs,
                             const Progress& progress) {
  std::vector<TrialFiles> staged;
  for (const TrialFiles& trial : files.trials) staged.push_back(Staged(trial, outputs));
  SimulationRun run;
  run.trials.resize(simulation.chosen.size());
  run.legs = simulation.experiment.legs;
  const auto play = [&](std::size_t i) {
    const std::size_t index = simulation.chosen[i];
    const PlannedTrial& planned = simulation.experiment.trials[index];
    SimulatedTrial trial = Play(simulation, index);
    trial.raw.joints = JointsToMotors(project.tree, std::move(trial.raw.joints));
    const VirtualExperimentOptions& settings = simulation.experiment.options;
    SeeBars(project.recording.reference_lengths, simulation.bars, settings.sensors.marker_noise_sd,
            settings.seed + 1000 * (index + 1), trial.raw.markers);
    WriteSimulatedTrial(staged[i], trial);
    run.trials[i] = {planned.name,     planned.kind,
                     planned.postures, trial.motion.frame_count(),
                     trial.raw.truth,  LargestDeflection(simulation, index, trial.motion)};
  };
  const std::vector<std::size_t> order = LongestFirst(simulation);
  ForAll(
      order.size(), threads, [&](std::size_t i) { play(order[i]); }, progress);

  std::vector<SensorTruth> sensors;
  for (const TrialOutcome& trial : run.trials) sensors.push_back(trial.sensors);
  outputs.Set(files.truth, simulation.matched
                               ? FormatMatchedTruth(*simulation.matched, simulation.chosen, sensors)
                               : FormatTruth(simulation.experiment, simulation.chosen, sensors));
  if (!files.marker_places.empty()) {
    outputs.Set(files.marker_places, FormatMarkerPlaces(simulation.marker_places));
  }
  Experiment experiment;
  experiment.trials = files.trials;
  outputs.Set(files.experiment, FormatExperiment(files.folder, experiment, project));
  return run;
}

SimulationRun SimulateExperiment(const Project& project, const SimulationOptions& options,
                                 const std::filesystem::path& folder, const Progress& progress) {
  const Simulation simulation = PrepareSimulation(project, options);
  const SimulationFiles files = FilesOfSimulation(simulation, folder);
  OutputSet outputs;
  outputs.Protect({project.file, project.urdf});
  for (const fs::path& file : files.all()) outputs.Declare(file);
  outputs.Prepare();
  SimulationRun run =
      PlaySimulation(project, simulation, files, options.threads, outputs, progress);
  outputs.Publish();
  return run;
}

void WriteSimulatedTrial(const TrialFiles& files, const SimulatedTrial& trial) {
  WriteQtmTsv(files.markers, trial.raw.markers);
  WriteJointLog(files.joints, trial.raw.joints);
  WaistTruth waist;
  waist.T_camera_waist = trial.motion.T_camera_waist;
  waist.time_s = Eigen::VectorXd::LinSpaced(
      trial.motion.frame_count(), 0.0, (trial.motion.frame_count() - 1) / trial.motion.rate_hz);
  WriteWaistTruth(files.truth, waist);
}

DescribedRobot DescribeRobot(const Project& project) {
  DescribedRobot robot;
  robot.tree = project.tree;
  robot.markers = project.markers;
  robot.torque_sensors = project.torque_sensors;
  for (const Chain& chain : project.chains) {
    robot.chains.push_back({chain.name, chain.from_link, chain.tip_link});
  }
  for (const MarkerCluster& cluster : project.clusters) {
    robot.clusters.push_back({cluster.name, cluster.markers});
  }
  return robot;
}

SimulationOptions SimulationOfMotion(const std::filesystem::path& file, const Project& project,
                                     std::optional<TrialKind> kind, std::uint64_t seed) {
  SimulationOptions options;
  options.experiment.seed = seed;
  options.motion = ReadMotion(file, project);
  options.given.name = TrialNameOf(file);
  options.given.kind = kind;
  return options;
}

JointMotion ReadPosturesToPlay(const std::filesystem::path& file, const Project& project) {
  const std::string extension = file.extension().string();
  if (extension != ".yaml" && extension != ".yml") return ReadPostureList(file, project);
  return ListPostures(ReadPostureFile(file, project), file.string());
}

}  // namespace elastocal
