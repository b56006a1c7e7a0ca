#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>

#include "elastocal/io/experiment.hpp"
#include "elastocal/simulation/matched_experiment.hpp"

namespace elastocal {

/// A project as the virtual experiment takes it.
DescribedRobot DescribeRobot(const Project& project);

/// The true pose of the root link in the cameras' frame over a trial.
struct WaistTruth {
  Eigen::VectorXd time_s;                 ///< on the cameras' clock
  std::vector<Transform> T_camera_waist;  ///< as `time_s`
};

/// Reads such a table (docs/formats.md "Truth of a simulation"): CSV with the columns t [s], x, y,
/// z [m] and qw, qx, qy, qz. Throws InputError naming file, line and column.
WaistTruth ReadWaistTruth(const std::filesystem::path& file);

/// Writes it with all digits.
void WriteWaistTruth(const std::filesystem::path& file, const WaistTruth& truth);

/// Writes what is true of the robot and of each trial's sensors: `folder`/truth.yaml. `trials` are
/// those of the experiment that were run, in its order.
void WriteTruth(const std::filesystem::path& folder, const VirtualExperiment& experiment,
                const std::vector<std::size_t>& trials, const std::vector<SensorTruth>& sensors);

/// The same of an experiment whose truth is the error model: the model's parameters that are not
/// zero, by name, with value and unit (SI).
void WriteMatchedTruth(const std::filesystem::path& folder, const MatchedExperiment& experiment,
                       const std::vector<std::size_t>& trials,
                       const std::vector<SensorTruth>& sensors);

/// Writes the files of one simulated trial into `folder` and returns their names.
TrialFiles WriteSimulatedTrial(const std::filesystem::path& folder, const PlannedTrial& plan,
                               const SimulatedTrial& trial);

}  // namespace elastocal
