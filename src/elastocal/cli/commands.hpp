// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the name of the library
class App;
}

namespace elastocal::cli {

/// Exit codes of the program.
enum ExitCode {
  kFine = 0,
  kUsage = 2,
  kBadInput = 3,
  kNotConverged = 4,  ///< or infeasible
  kInternal = 1,      ///< a defect of the program
};

/// Options that all commands share; commands that draw nothing have no seed.
struct CommonOptions {
  std::string json_file;
  std::optional<std::uint64_t> seed;  ///< given by the user
  bool quiet = false;
  bool verbose = false;

  /// Standard output is not for people: with --quiet, or if the JSON goes there.
  bool Silent() const { return quiet || json_file == "-"; }
};

/// Add all of these options, or all but the seed.
void AddCommonOptions(CLI::App& command, CommonOptions& options);
void AddOutputOptions(CLI::App& command, CommonOptions& options);

/// Adds options for the calibration that a command uses and for its project.
void AddCalibratedRobot(CLI::App& command, std::string& calibration, std::string& project);

/// Adds arguments for a project, a calibration of its robot, and the recording to which it is
/// applied. With `tables` (for validate), several tables of observations form one recording.
void AddAppliedCalibration(CLI::App& command, std::string& project, std::string& calibration,
                           std::vector<std::string>& recording, bool tables = false);

/// Adds the option that names mistakes of a recording to be corrected, see AcceptMistakes.
void AddAcceptOption(CLI::App& command, std::vector<std::string>& names);

/// What a parsed command line does; returns the exit code.
using Action = std::function<int()>;

/// Parses and runs a command line (without the program's name). Returns the exit code.
int RunCommandLine(const std::vector<std::string>& arguments);

/// Describes what is wrong with the words of a command line, without running it; empty: nothing.
std::string UsageErrorOf(std::vector<std::string> words);

/// Each function adds a command. `action` is set when that command is on the command line.
void AddInit(CLI::App& app, Action& action);
void AddInspect(CLI::App& app, Action& action);
void AddCalibrate(CLI::App& app, Action& action);
void AddValidate(CLI::App& app, Action& action);
void AddBatch(CLI::App& app, Action& action);
void AddCheck(CLI::App& app, Action& action);
void AddDiagnose(CLI::App& app, Action& action);
void AddCompare(CLI::App& app, Action& action);
void AddDemo(CLI::App& app, Action& action);
void AddSimulate(CLI::App& app, Action& action);
void AddDesign(CLI::App& app, Action& action);
void AddAssess(CLI::App& app, Action& action);
void AddReport(CLI::App& app, Action& action);
void AddPlan(CLI::App& app, Action& action);
void AddCompensate(CLI::App& app, Action& action);
void AddExport(CLI::App& app, Action& action);
void AddInfo(CLI::App& app, Action& action);
void AddConvert(CLI::App& app, Action& action);

}  // namespace elastocal::cli
