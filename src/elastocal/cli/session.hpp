#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/knocks.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/io/project.hpp"
#include "elastocal/measurement/trial_summary.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal::cli {

/// A project with a recording: what calibrate, validate and demo begin with.
struct Session {
  Project project;
  Recording recording;   ///< without markers that were never seen
  Recording validation;  ///< of recording folders: trials of other kinds, with the same markers
  std::vector<TrialSummary> trials;  ///< of recording folders: what was used of each
  /// True poses of the waist in each posture, where the recording was simulated; else empty.
  std::vector<std::optional<Transform>> recording_truth, validation_truth;
  ErrorModel model;  ///< with the recording's markers
  BaseParameters base;
  std::vector<Knock> knocks;          ///< found in the recording; their clusters are taken as two
  std::vector<std::string> warnings;  ///< of reading, and of special marker positions
};

/// Reads both and decides the base parameters; a seed replaces the project's. Throws InputError.
/// `recordings`: one posture table, or one or more recording folders.
Session OpenSession(const std::filesystem::path& project,
                    const std::vector<std::filesystem::path>& recordings,
                    std::optional<std::uint64_t> seed);

/// Throws InputError where an output (empty ones aside) would replace an input.
void CheckOutputs(const std::vector<std::filesystem::path>& outputs,
                  const std::vector<std::filesystem::path>& inputs);

/// Shows progress on stderr where that is a terminal and the user does not want quiet.
Progress TerminalProgress(const std::string& what, bool quiet);

/// Prints to stdout unless quiet.
void Print(bool quiet, const std::string& text);

/// Prints warnings to stderr.
void PrintWarnings(const std::vector<std::string>& warnings);

/// A parameter in the units that people use: mm and deg.
double InUserUnits(const Parameter& parameter, double value);
const char* UserUnit(const Parameter& parameter);

/// "a, b, c" of parameter names, the coordinates of a marker and the constants of a joint together:
/// "arm_left_7_joint.{theta,r}".
std::string JoinNames(const std::vector<Parameter>& parameters, const std::vector<int>& which);

}  // namespace elastocal::cli
