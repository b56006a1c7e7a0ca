// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/cli/progress.hpp"
#include "elastocal/pipeline/calibrated_robot.hpp"
#include "elastocal/robot/parameters.hpp"

namespace elastocal::cli {

/// Prints to stdout unless quiet; see Printable for what is shown of names in the text.
void Print(bool quiet, const std::string& text);

/// Prints warnings to stderr; those that say the same of several things together, unless `verbose`.
void PrintWarnings(const std::vector<std::string>& warnings, bool verbose = false);

/// Says what a calibration knows that an export does not apply. `at_run_time`: to a robot at run
/// time.
void WarnOfExtra(const CalibratedRobot& robot, bool at_run_time);

/// A parameter in the units that people use: mm and deg.
double InUserUnits(const Parameter& parameter, double value);
const char* UserUnit(const Parameter& parameter);

}  // namespace elastocal::cli
