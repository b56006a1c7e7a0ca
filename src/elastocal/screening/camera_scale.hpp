// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// A factor by which all measured lengths deviate from the true ones.
struct CommonScale {
  double size = 0.0;  ///< factor minus 1
  double sd = 0.0;
  /// Degrees of freedom of `sd`: number of lengths that determine how far single lengths err.
  double degrees_of_freedom = 1.0;
  /// A single length, which the robot description has wrongly, makes most of it.
  bool of_one_length = false;
};

/// Estimates the factor that the errors of all lengths of a robot have in common, beside the single
/// error of each length (score test of that pattern against the prior of lengths, whose width
/// follows from the residuals). Links are made one by one, so that errors of a robot have no such
/// pattern, but wrongly calibrated cameras do. Nothing where the lengths do not determine it, or
/// where an earlier calibration knows the robot.
std::optional<CommonScale> EstimateCommonScale(const CalibrationResult& result,
                                               const CalibrationOptions& options);

/// The common factor, if no robot has it: it differs from 1 by more than 0.3 %, and by as many
/// standard deviations as in one clean recording of a thousand by Student's t (3.5 for a humanoid,
/// 4.6 for an arm of seven joints). Not where it is of one length.
std::optional<CommonScale> FindWrongScale(const CalibrationResult& result,
                                          const CalibrationOptions& options);

/// The smallest and the largest scale of the cameras, minus 1, that the lengths do not contradict
/// (95 % interval). No other data determine it.
std::pair<double, double> CompatibleScales(const CommonScale& scale);

/// Whether the factor differs from 1 by more than 0.3 %, and by more than in one clean recording of
/// fifty: too little for an objection, too much to be ignored.
bool IsDoubtful(const CommonScale& scale);

/// Text such as "the cameras' positions may be 1.0039 +- 0.0014 times the true ones in all trials,
/// ...".
std::string DescribeDoubt(const CommonScale& scale);

/// Text such as "the cameras' positions seem 1.0050 +- 0.0003 times the true ones in all trials,
/// ...".
std::string Describe(const CommonScale& scale);

}  // namespace elastocal
