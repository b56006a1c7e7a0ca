// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/cli/progress.hpp"
#include "elastocal/pipeline/calibrated_robot.hpp"
#include "elastocal/robot/parameters.hpp"

namespace elastocal::cli {

/// Prints to stdout unless quiet; Printable defines how names in the text are shown.
void Print(bool quiet, const std::string& text);

/// Prints warnings to stderr. Similar warnings about several things are grouped, unless `verbose`.
void PrintWarnings(const std::vector<std::string>& warnings, bool verbose = false);

/// Warns of causes in a calibration that an export does not apply. `at_run_time`: the export is for
/// a robot at run time.
void WarnOfExtra(const CalibratedRobot& robot, bool at_run_time);

/// Value of a parameter in units for people: mm and deg.
double InUserUnits(const Parameter& parameter, double value);
const char* UserUnit(const Parameter& parameter);

}  // namespace elastocal::cli
