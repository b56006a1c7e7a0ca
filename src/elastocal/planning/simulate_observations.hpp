// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "elastocal/io/posture_file.hpp"
#include "elastocal/math/progress.hpp"
#include "elastocal/observation/observed_posture.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/simulation/virtual_experiment.hpp"

namespace elastocal {

/// Measurements of a virtual robot in one posture.
struct SimulatedPosture {
  int plate = -1;            ///< index of the plate that touches; -1: none
  Eigen::VectorXd encoders;  ///< by coordinate, rad or m
  /// By instrument of the setup, in the order of its kind; empty: no measurement.
  std::vector<Eigen::VectorXd> measured;
};

/// A recording of a robot that touches tables and is seen by instruments, with its truth.
struct ObservedRecording {
  VirtualExperiment robot;                ///< the robot; no trials are played
  ObservationSetup setup;                 ///< with the planned poses of the feet
  std::vector<QuantityValue> quantities;  ///< by quantity of the setup: the truth
  std::vector<SimulatedPosture> postures;
  std::vector<std::string> warnings;  ///< touches that were given up
};

/// Plays postures on the virtual robot in MuJoCo, one after the other, and measures it at rest.
///
/// The robot stands on the feet of `contact`, which lie flat on one level floor (LevelFeet) and do
/// not move; without feet its root link is held still. In a touch, the hand is lowered on its table
/// until it lies flush, by the forces of MuJoCo's contact (TouchTable); the table exists only
/// during the touch. Truth beside the robot (tables, mountings, trackers, cameras) is drawn by the
/// standard deviations of the set-up, at most 0.1 m and rad, with the seed of the robot, so that a
/// second recording with the same robot seed has the same tables and mountings. Instruments measure
/// the poses of MuJoCo's links by their own geometry (Instrument::Predict), with noise.
///
/// `postures` holds sets by the name of a plate, or kLooks. The same seeds give the same recording.
/// Throws InputError for other names, for a plate without a table, and for what MuJoCo refuses.
ObservedRecording SimulateObservations(const Project& project,
                                       const std::vector<ChainPostures>& postures,
                                       const VirtualExperimentOptions& options,
                                       const Progress& progress = {});

/// Contents of the files by name: observations.csv, corners.csv if cameras see tags, and truth.yaml
/// (docs/formats.md).
std::map<std::string, std::string> FormatObservedRecording(const Project& project,
                                                           const ObservedRecording& recording);

/// Paths of these files in a folder. An earlier simulation there is replaced. Throws InputError
/// where files with these names were not simulated (there is no truth.yaml beside them), unless
/// `force` is set.
std::vector<std::filesystem::path> FilesOfObservedSimulation(const Project& project,
                                                             const std::filesystem::path& folder,
                                                             bool force);

/// The run as JSON.
std::string FormatObservedSimulation(const ObservedRecording& recording);

}  // namespace elastocal
