// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// All lengths that were measured are off by one factor.
struct CommonScale {
  double size = 0.0;  ///< the factor less 1
  double sd = 0.0;
  double degrees_of_freedom = 1.0;  ///< of `sd`: how many lengths tell how far they err themselves
};

/// How far all lengths of a robot are off by the same factor, beside what each is off by itself
/// (score test of that pattern against the prior of lengths, as wide as what is left asks for).
/// Links are made one by one, so errors of a robot have no such pattern; wrongly calibrated cameras
/// do. Nothing where the lengths do not tell it.
std::optional<CommonScale> EstimateCommonScale(const CalibrationResult& result,
                                               const CalibrationOptions& options);

/// The same if no robot has that: more than 0.3 %, and as many standard deviations as one clean
/// recording in a thousand has by Student's t (3.5 for a humanoid, 4.6 for an arm of seven joints).
std::optional<CommonScale> FindWrongScale(const CalibrationResult& result,
                                          const CalibrationOptions& options);

/// The least and the largest scale of the cameras, less 1, that the lengths do not contradict (95
/// %): no other data tell it.
std::pair<double, double> CompatibleScales(const CommonScale& scale);

/// Whether it is more than 0.3 %, and more than one clean recording in fifty has: too little to
/// object to, too much to say nothing.
bool IsDoubtful(const CommonScale& scale);

/// "the cameras' positions may be 1.0039 +- 0.0014 times the true ones in all trials, ..."
std::string DescribeDoubt(const CommonScale& scale);

/// "the cameras' positions seem 1.0050 +- 0.0003 times the true ones in all trials, ..."
std::string Describe(const CommonScale& scale);

}  // namespace elastocal
