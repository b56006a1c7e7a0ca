// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// A calibration linearised at its solution, with an additional column for every correction that
/// its model lacks. With it single causes and sets of causes can be tested without another fit.
/// Noise, weights and the width of the prior stay unchanged.
///
/// Rows are in units of their standard deviation, unknowns in those of the solver. The poses of the
/// waist in trials are eliminated posture by posture. Compliances that ended at zero stay at zero.
struct LinearStudy {
  struct Posture {
    Eigen::VectorXd residual;  ///< at the estimate
    Eigen::MatrixXd jacobian;  ///< rows x (base + corrections)
    /// Standard deviation of each row: m for markers, zero for the support constraint. Studies of
    /// other observations use 1, so that errors are in units of their noise.
    Eigen::VectorXd to_metres;
    int markers = 0;  ///< Markers seen. For other observations: rows.
  };
  std::vector<Posture> postures;  ///< postures of the recording
  Eigen::MatrixXd other;  ///< information of the rows that belong to no posture: floor and prior
  Eigen::VectorXd other_gradient;
  int base = 0;  ///< number of unknowns of the calibration, which are the first columns
  /// Index in the wide model of the parameter behind each further column.
  std::vector<int> corrections;
  /// Value of each of these parameters, SI, for one unit of the solver.
  std::vector<double> scale;
  std::vector<std::string> causes;         ///< names of the causes, in the order of `of_cause`
  std::vector<std::vector<int>> of_cause;  ///< columns of each cause, counted from `base`
  double degrees_of_freedom = 1.0;         ///< degrees of freedom of the noise

  int columns() const { return base + static_cast<int>(corrections.size()); }
};

/// Adds the column of a correction, `parameter` being its index in the wide model. Returns the
/// column.
int AddStudyColumn(const ErrorModel& wide, int parameter, LinearStudy& study);

/// A compliance up to this value, in units of the solver, counts as zero.
inline constexpr double kComplianceAtZero = 1e-9;

/// `wide` is the model of `result` with further corrections; corrections that `result` has already
/// are part of the base. The nominal pose of the waist is taken from `result`.
LinearStudy MakeLinearStudy(const ErrorModel& wide, const Recording& recording,
                            const CalibrationResult& result, const CalibrationOptions& options);

}  // namespace elastocal
