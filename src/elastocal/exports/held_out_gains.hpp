// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/pipeline/calibrated_robot.hpp"
#include "elastocal/validation/joint_gains.hpp"

namespace elastocal {

/// Gains of a stored calibration's joints on data from which it was not estimated.
struct HeldOutGains {
  GainStudy study;
  std::string judged_on;  ///< "2 held-out trials" or "30 postures, each without the fifth that ..."
  double least = 0.0;     ///< m
};

/// StudyGains for a calibration and the recordings that its record names.
///
/// - Recordings with trials for validation: these judge the stored estimate.
/// - Others are divided into five folds: of whole trials if there are at least five, else of
///   postures (nearly equal ones together). Each fold is judged by a new estimate from the other
///   four. This takes as long as five calibrations.
///
/// Marker positions that calibrate was given (--marker-places) are also given to the folds. These
/// markers stay where they are when a joint returns to nominal, so that the zero of a wrist can be
/// a gain. Mistakes of the recording that calibrate corrected (AcceptMistakes) are not corrected
/// here, and folds know no earlier calibration.
///
/// Throws InputError for a project without markers, as RecordedRecordings and ReadMeasurements, for
/// a calibration of another robot, and for fewer than ten postures.
HeldOutGains FindHeldOutGains(const CalibratedRobot& robot, const GainOptions& options);

/// The result, a line each: the figures, then the joints that stay nominal, with the reason.
std::vector<std::string> DescribeGains(const HeldOutGains& gains);

}  // namespace elastocal
