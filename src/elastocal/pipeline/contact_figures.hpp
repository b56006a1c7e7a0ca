// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/pipeline/contact_run.hpp"

namespace elastocal {

/// Errors on what a run is judged by, without what was found to be wrong and left out.
ObservationFigures FiguresOfGood(const ContactRun& run);

/// "0.04 mm in position of lt, 0.02 degrees in rotation of lt"; of touches their height and tilt.
std::string FiguresInWords(const ContactRun& run, const ObservationFigures& figures);

/// Kinds of observations that the calibrated robot predicts by a quarter worse than the
/// uncalibrated one, and by more than a tenth of LargestError, which may be noise: "height of lt
/// from 101 to 251 mm".
std::vector<std::string> WorseRows(const ObservedRobot& model, const ObservationFigures& before,
                                   const ObservationFigures& after);

/// Kinds of observations that are off by more: "height of lt off by 101 mm".
std::vector<std::string> LargeErrors(const ObservedRobot& model, const ObservationFigures& figures);

}  // namespace elastocal
