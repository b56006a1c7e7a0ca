// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/marker_places.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/io/experiment.hpp"
#include "elastocal/math/progress.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/simulation/given_motion.hpp"
#include "elastocal/simulation/matched_experiment.hpp"

namespace elastocal {

/// What a simulated laboratory records of a robot with known errors.
struct SimulationOptions {
  VirtualExperimentOptions experiment = {};
  /// Which trials are played: `all`, `calibration`, `validation`, or the name of one.
  std::string trials = "all";
  /// The truth is the estimator's own error model, at rest at every instant, instead of physics.
  bool matched = false;
  /// Plays this motion, or these postures, instead of the trials that the experiment plans.
  std::optional<JointMotion> motion = {};
  GivenMotionOptions given = {};  ///< how `motion` becomes trials; see TrialNameOf
  /// Standard deviation with which the places of the markers on their links are measured, m; 0:
  /// they are not.
  double marker_places_sd = 0.0;
  int threads = 2;  ///< trials played at a time; the result does not depend on it
};

/// An experiment that is ready to be played.
struct Simulation {
  VirtualExperiment experiment;
  std::optional<MatchedExperiment> matched = {};  ///< in place of physics
  std::vector<std::size_t> chosen;                ///< of experiment.trials: those to be played
  /// The bars of the project's reference lengths as they are made, beside the robot: both ends, m.
  std::vector<std::array<Eigen::Vector3d, 2>> bars = {};
  std::vector<MarkerMeasurement> marker_places = {};  ///< as measured on the links
};

/// Draws the robot and plans the trials. Throws InputError for a trial, chain or fault that is not
/// there, for a motion that cannot be played, and for `matched` without a calibration trial.
Simulation PrepareSimulation(const Project& project, const SimulationOptions& options);

/// What a person should know of a simulation before trusting it, a sentence each: inertias that no
/// body has, legs on which the robot does not stand.
std::vector<std::string> SimulationWarnings(const Project& project, const Simulation& simulation);

/// The files of a recording folder that a simulation fills.
struct SimulationFiles {
  std::filesystem::path folder, experiment, truth;
  std::filesystem::path marker_places;         ///< empty where they are not measured
  std::vector<TrialFiles> trials;              ///< one an entry of Simulation::chosen
  std::vector<std::filesystem::path> earlier;  ///< of an earlier simulation, to be removed

  std::vector<std::filesystem::path> all() const;
};

/// What the simulation writes into `folder`. An earlier simulation there is replaced as a whole.
/// Throws InputError where the folder holds recordings that are not simulated (an experiment.yaml
/// without truth.yaml), or other files of the names that are written, unless `force`.
SimulationFiles FilesOfSimulation(const Simulation& simulation, const std::filesystem::path& folder,
                                  bool force = false);

/// The files of one trial: TRIAL.tsv, TRIAL.csv and TRIAL_waist.csv.
TrialFiles FilesOfTrial(const PlannedTrial& plan, const std::filesystem::path& folder);

/// Writes markers, joint log and true waist of a trial.
void WriteSimulatedTrial(const TrialFiles& files, const SimulatedTrial& trial);

/// What is kept of a trial once its files are written.
struct TrialOutcome {
  std::string name;
  TrialKind kind = TrialKind::kCalibration;
  int postures = 0, frames = 0;
  SensorTruth sensors;
  WaistGive waist;  ///< how far the waist gives way at most
};

/// What a simulation played.
struct SimulationRun {
  std::vector<TrialOutcome> trials;
  std::vector<LegCompliance> legs;  ///< stiffness as the waist feels it
};

/// Plays the trials and puts their files into the set, in which all of `files` are declared and
/// which is prepared. Publish remains to the caller. Progress counts trials. The same seed gives
/// the same files. Throws InputError where a robot that stands free falls.
SimulationRun PlaySimulation(const Project& project, const Simulation& simulation,
                             const SimulationFiles& files, int threads, OutputSet& outputs,
                             const Progress& progress = {});

/// All of these in turn, published: a recording folder with experiment.yaml and truth.yaml.
SimulationRun SimulateExperiment(const Project& project, const SimulationOptions& options,
                                 const std::filesystem::path& folder,
                                 const Progress& progress = {});

/// The run for programs (JSON).
std::string FormatSimulationSummary(const SimulationRun& run);

/// What the virtual experiment needs of a project.
DescribedRobot DescribeRobot(const Project& project);

/// The name of the trial that plays a file, which becomes a part of file names: the name of the
/// file without extension and `_motion`; characters other than letters, digits, '_', '.' and '-'
/// become '_'.
std::string TrialNameOf(const std::filesystem::path& file);

/// Options that play the trajectory of a file (CSV; docs/formats.md, Motion).
SimulationOptions SimulationOfMotion(const std::filesystem::path& file, const Project& project,
                                     std::optional<TrialKind> kind, std::uint64_t seed);

/// Postures to be played one after the other: of a posture file (YAML) or a table (CSV).
JointMotion ReadPosturesToPlay(const std::filesystem::path& file, const Project& project);

}  // namespace elastocal
