// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// A calibration linearised where it ended, with one more column for every correction that its
/// model has beside: what single causes and sets of causes bring can then be told without fitting
/// anew. Noise, weights and the width of the prior stay as they were.
///
/// Rows are in units of their standard deviation, unknowns in those of the solver. The poses of the
/// waist in trials are eliminated posture by posture, and compliances that ended at zero stay
/// there.
struct LinearStudy {
  struct Posture {
    Eigen::VectorXd residual;  ///< at the estimate
    Eigen::MatrixXd jacobian;  ///< rows x (base + corrections)
    /// Standard deviation of each row, m; 1 for observations that are not markers, so that errors
    /// are in units of their noise.
    Eigen::VectorXd to_metres;
    int markers = 0;  ///< seen; of other observations, rows
  };
  std::vector<Posture> postures;  ///< of the recording
  Eigen::MatrixXd other;          ///< information of what belongs to no posture: floor and prior
  Eigen::VectorXd other_gradient;
  int base = 0;                            ///< unknowns of the calibration; they come first
  std::vector<int> corrections;            ///< parameter of the wide model behind each other column
  std::vector<double> scale;               ///< its value in SI for one unit of the solver
  std::vector<std::string> causes;         ///< in order
  std::vector<std::vector<int>> of_cause;  ///< columns of each, counted from `base`
  double degrees_of_freedom = 1.0;         ///< of the noise

  int columns() const { return base + static_cast<int>(corrections.size()); }
};

/// Adds the column of a correction, which is a parameter of the wide model; returns it.
int AddStudyColumn(const ErrorModel& wide, int parameter, LinearStudy& study);

/// A compliance that ended here, in the unit of the solver, stays at zero.
inline constexpr double kComplianceAtZero = 1e-9;

/// `wide`: the model of `result` with corrections that `result` does not have (those that it has
/// are part of the base). The pose of the waist is taken from `result`.
LinearStudy MakeLinearStudy(const ErrorModel& wide, const Recording& recording,
                            const CalibrationResult& result, const CalibrationOptions& options);

}  // namespace elastocal
