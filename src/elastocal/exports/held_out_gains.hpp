// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/pipeline/calibrated_robot.hpp"
#include "elastocal/validation/joint_gains.hpp"

namespace elastocal {

/// Which joints of a stored calibration help on data that it was not estimated from.
struct HeldOutGains {
  GainStudy study;
  std::string judged_on;  ///< "2 held-out trials" or "30 postures, each without the fifth that ..."
  double least = 0.0;     ///< m
};

/// StudyGains for a calibration and the recordings that its record names.
///
/// - Recordings with trials for validation: these judge the stored estimate.
/// - Others are cut into five folds, of whole trials where there are five or more, else of postures
///   (nearly equal ones together). Each is judged by the estimate of the other four, which is made
///   anew. That takes as long as five calibrations.
///
/// Places of markers that calibrate was told (--marker-places) are told to folds too, and these
/// markers stay there where a joint returns to nominal: the zero of a wrist then is a gain.
/// Mistakes of the recording that calibrate undid (AcceptMistakes) are not undone here, and folds
/// know no earlier calibration.
///
/// Throws InputError: a project without markers; what RecordedRecordings and ReadMeasurements
/// refuse; a calibration of another robot; fewer than ten postures.
HeldOutGains FindHeldOutGains(const CalibratedRobot& robot, const GainOptions& options);

/// What came of it, a line each: the figures, then the joints that stay nominal, and why.
std::vector<std::string> DescribeGains(const HeldOutGains& gains);

}  // namespace elastocal
