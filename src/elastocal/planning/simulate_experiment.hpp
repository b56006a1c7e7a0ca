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

/// Settings of a simulated laboratory that records a robot with known errors.
struct SimulationOptions {
  VirtualExperimentOptions experiment = {};
  /// Trials to be played: `all`, `calibration`, `validation`, or the name of one.
  std::string trials = "all";
  /// The truth is the estimator's own error model in static equilibrium, instead of physics.
  bool matched = false;
  /// A motion, or postures, played instead of the trials that the experiment plans.
  std::optional<JointMotion> motion = {};
  GivenMotionOptions given = {};  ///< how `motion` becomes trials; see TrialNameOf
  /// Standard deviation with which marker positions on their links are measured, m; 0: they are not
  /// measured.
  double marker_places_sd = 0.0;
  std::vector<std::string> marker_places_of = {};  ///< clusters measured; empty: all markers
  int threads = 2;  ///< trials that are played at the same time; the result does not depend on it
};

/// An experiment that is ready to be played.
struct Simulation {
  VirtualExperiment experiment;
  std::optional<MatchedExperiment> matched = {};  ///< replaces physics
  std::vector<std::size_t> chosen;  ///< indices in experiment.trials of those to be played
  /// The bars of the project's reference lengths as made, beside the robot: both ends, m.
  std::vector<std::array<Eigen::Vector3d, 2>> bars = {};
  std::vector<MarkerMeasurement> marker_places = {};  ///< as measured on the links
};

/// Draws the robot and plans the trials. Throws InputError for an unknown trial, chain or fault,
/// for a motion that cannot be played, and for `matched` without a calibration trial.
Simulation PrepareSimulation(const Project& project, const SimulationOptions& options);

/// Warnings about a simulation, a sentence each: inertias that no body has, legs on which the robot
/// does not stand.
std::vector<std::string> SimulationWarnings(const Project& project, const Simulation& simulation);

/// Files of a recording folder that a simulation writes.
struct SimulationFiles {
  std::filesystem::path folder, experiment, truth;
  std::filesystem::path marker_places;         ///< empty where they are not measured
  std::vector<TrialFiles> trials;              ///< one for each entry of Simulation::chosen
  std::vector<std::filesystem::path> earlier;  ///< files of an earlier simulation, to be removed

  std::vector<std::filesystem::path> all() const;
};

/// Files that the simulation writes into `folder`. An earlier simulation there is replaced as a
/// whole. Unless `force` is set, throws InputError where the folder holds recordings that are not
/// simulated (an experiment.yaml without truth.yaml), or other files with the same names.
SimulationFiles FilesOfSimulation(const Simulation& simulation, const std::filesystem::path& folder,
                                  bool force = false);

/// The files of one trial: TRIAL.tsv, TRIAL.csv and TRIAL_waist.csv.
TrialFiles FilesOfTrial(const PlannedTrial& plan, const std::filesystem::path& folder);

/// Writes markers, joint log and true waist of a trial.
void WriteSimulatedTrial(const TrialFiles& files, const SimulatedTrial& trial);

/// What is kept of a trial after its files are written.
struct TrialOutcome {
  std::string name;
  TrialKind kind = TrialKind::kCalibration;
  int postures = 0, frames = 0;
  SensorTruth sensors;
  WaistGive waist;  ///< largest deflection of the waist
};

/// Result of a simulation.
struct SimulationRun {
  std::vector<TrialOutcome> trials;
  std::vector<LegCompliance> legs;  ///< stiffness as seen from the waist
};

/// Plays the trials and writes their files into the set, in which all of `files` are declared and
/// which is prepared. The caller publishes the set. Progress counts trials. The same seed gives the
/// same files. Throws InputError where a free-standing robot falls.
SimulationRun PlaySimulation(const Project& project, const Simulation& simulation,
                             const SimulationFiles& files, int threads, OutputSet& outputs,
                             const Progress& progress = {});

/// All steps above, published: a recording folder with experiment.yaml and truth.yaml.
SimulationRun SimulateExperiment(const Project& project, const SimulationOptions& options,
                                 const std::filesystem::path& folder,
                                 const Progress& progress = {});

/// The run as JSON.
std::string FormatSimulationSummary(const SimulationRun& run);

/// Description of the project's robot for the virtual experiment.
DescribedRobot DescribeRobot(const Project& project);

/// Name of the trial that plays a file, which becomes part of file names: the name of the file
/// without extension and `_motion`. Characters other than letters, digits, '_', '.' and '-' become
/// '_'.
std::string TrialNameOf(const std::filesystem::path& file);

/// Options to play the trajectory in a file (CSV; docs/formats.md, Motion).
SimulationOptions SimulationOfMotion(const std::filesystem::path& file, const Project& project,
                                     std::optional<TrialKind> kind, std::uint64_t seed);

/// Reads postures to be played one after the other, from a posture file (YAML) or a table (CSV).
JointMotion ReadPosturesToPlay(const std::filesystem::path& file, const Project& project);

}  // namespace elastocal
