// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/pipeline/contact_run.hpp"

namespace elastocal {

/// Errors by which a run is judged, without the observations that are left out.
ObservationFigures FiguresOfGood(const ContactRun& run);

/// Text such as "0.04 mm in position of lt, 0.02 degrees in rotation of lt"; for touches their
/// height and tilt.
std::string FiguresInWords(const ContactRun& run, const ObservationFigures& figures);

/// Kinds of observations whose error after calibration exceeds that before by more than a quarter,
/// and a tenth of LargestError, below which it may be noise: "height of lt from 101 to 251 mm".
std::vector<std::string> WorseRows(const ObservedRobot& model, const ObservationFigures& before,
                                   const ObservationFigures& after);

/// Kinds of observations whose error exceeds LargestError: "height of lt off by 101 mm".
std::vector<std::string> LargeErrors(const ObservedRobot& model, const ObservationFigures& figures);

}  // namespace elastocal
