// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>

#include "elastocal/math/transform.hpp"

namespace elastocal {

/// The true pose of the root link in the cameras' frame over a trial.
struct WaistTruth {
  Eigen::VectorXd time_s;                 ///< on the cameras' clock
  std::vector<Transform> T_camera_waist;  ///< one for each entry of `time_s`
};

/// Reads the true pose from a table (docs/formats.md "Truth of a simulation"): CSV with the columns
/// t [s], x, y, z [m] and qw, qx, qy, qz. Throws InputError naming file, line and column.
WaistTruth ReadWaistTruth(const std::filesystem::path& file);

/// Writes it with all digits.
void WriteWaistTruth(const std::filesystem::path& file, const WaistTruth& truth);

}  // namespace elastocal
