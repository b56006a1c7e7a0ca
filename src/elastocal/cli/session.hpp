#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/pipeline/calibrate_experiment.hpp"
#include "elastocal/robot/parameters.hpp"

namespace elastocal::cli {

/// Throws InputError where an output (empty ones aside) would replace an input.
void CheckOutputs(const std::vector<std::filesystem::path>& outputs,
                  const std::vector<std::filesystem::path>& inputs);

/// Shows progress on stderr where that is a terminal and the user does not want quiet.
Progress TerminalProgress(const std::string& what, bool quiet);

/// The same for the steps of a calibration.
StepProgress TerminalSteps(bool quiet);

/// Prints to stdout unless quiet.
void Print(bool quiet, const std::string& text);

/// Prints warnings to stderr.
void PrintWarnings(const std::vector<std::string>& warnings);

/// A parameter in the units that people use: mm and deg.
double InUserUnits(const Parameter& parameter, double value);
const char* UserUnit(const Parameter& parameter);

}  // namespace elastocal::cli
