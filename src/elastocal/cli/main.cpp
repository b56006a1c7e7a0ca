// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <malloc.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/completion.hpp"
#include "elastocal/cli/manual_page.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/progress.hpp"
#include "elastocal/cli/report_page.hpp"
#include "elastocal/cli/usage_message.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/utf8.hpp"
#include "elastocal/report/version.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal::cli {

void AddCommonOptions(CLI::App& command, CommonOptions& options) {
  AddOutputOptions(command, options);
  command
      .add_option("--seed", options.seed,
                  "Seed of all that is drawn at random (postures for identifiability, folds, the "
                  "demo's truth); default 1, or the project's")
      ->check(IsSeed);
}

void AddOutputOptions(CLI::App& command, CommonOptions& options) {
  command
      .add_option("--json", options.json_file,
                  "Also write the results to this file, as JSON (- for standard output)")
      ->type_name("FILE");
  command.add_flag("--quiet,-q", options.quiet, "Print nothing but warnings and errors");
  command.add_flag("--verbose,-v", options.verbose,
                   "Print all tables, and each warning by itself instead of those that say the "
                   "same together");
}

void AddAppliedCalibration(CLI::App& command, std::string& project, std::string& calibration,
                           std::vector<std::string>& recording, bool tables) {
  command.add_option("project", project, "Project file (YAML)")->required();
  command
      .add_option("--calibration", calibration, "Output folder of calibrate, or a calibration.yaml")
      ->required()
      ->type_name("FILE");
  command
      .add_option("--recording", recording,
                  std::string("Table of static postures (CSV), or a folder with experiment.yaml") +
                      (tables ? "; with contact or instruments, one or several tables" : ""))
      ->required()
      ->expected(tables ? -1 : 1)
      ->type_name("DIR|FILE");
}

void AddCalibratedRobot(CLI::App& command, std::string& calibration, std::string& project) {
  command
      .add_option("calibration", calibration, "Output folder of calibrate, or a calibration.yaml")
      ->required();
  command
      .add_option("--project", project,
                  "Project file; default: the one that runs.json beside the calibration names")
      ->type_name("FILE");
}

void AddAcceptOption(CLI::App& command, std::vector<std::string>& names) {
  command
      .add_option("--accept", names,
                  "Mistakes of the recording that are corrected before the fit, by the names that "
                  "calibrate or validate gave them: sign:JOINT, exchange:JOINT,JOINT, "
                  "frozen:JOINT, labels:NAME,NAME, rows:COUNT, gain:JOINT=FACTOR, "
                  "offset:JOINT@TRIAL=DEGREES, "
                  "offset:JOINT@TRIAL:POSTURE=DEGREES (from that one on; of a table "
                  "offset:JOINT:POSTURE), scale:TRIAL=FACTOR, "
                  "scale=FACTOR (in all trials); JOINT may be a motor of rods; of tables of "
                  "observations, TRIAL is a file, "
                  "and @FILE or @FILE:POSTURE may follow sign, exchange, labels and rows as well")
      ->type_name("NAME");
}

namespace {

/// Message if the first word of the command line is no command; else empty.
std::string UnknownCommand(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return "";
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  if (std::find(known.begin(), known.end(), argv[1]) != known.end()) return "";
  return "unknown command '" + std::string(argv[1]) + "'" + DidYouMean(argv[1], known);
}

/// Writes what the build installs beside the program: its manual page, and completion for shells.
int Generate(const CLI::App& app, const std::string& what) {
  ProgramWords words = ReadWords(app);
  const std::string version = ProgramVersion();
  words.version = version.substr(0, version.find(' '));
  words.exit_codes = {
      {kFine, "Fine"},
      {kInternal, "A defect of the program"},
      {kUsage, "A command line that the program does not understand"},
      {kBadInput, "An input that cannot be used, or an output that cannot be written"},
      {kNotConverged, "Not converged, infeasible, or not to be trusted"}};
  if (what == "man") {
    fmt::print("{}", ManualPage(words));
  } else if (what == "bash") {
    fmt::print("{}", BashCompletion(words));
  } else if (what == "zsh") {
    fmt::print("{}", ZshCompletion(words));
  } else {
    spdlog::error("--generate {}: man, bash or zsh was expected", what);
    return kUsage;
  }
  return kFine;
}

/// Adds all commands; parsing a command line sets `action`.
void AddCommands(CLI::App& app, Action& action) {
  app.name("elastocal");
  app.set_version_flag("--version", std::string("elastocal ") + ProgramVersion());
  app.require_subcommand(1);
  app.failure_message(UsageMessage);
  app.footer(
      "Exit codes: 0 fine, 2 usage, 3 bad input, 4 not converged or infeasible.\n"
      "Example: elastocal demo");
  AddInit(app, action);
  AddInspect(app, action);
  AddCalibrate(app, action);
  AddValidate(app, action);
  AddDiagnose(app, action);
  AddBatch(app, action);
  AddCheck(app, action);
  AddCompare(app, action);
  AddDemo(app, action);
  AddSimulate(app, action);
  AddDesign(app, action);
  AddAssess(app, action);
  AddReport(app, action);
  AddPlan(app, action);
  AddExport(app, action);
  AddCompensate(app, action);
  AddInfo(app, action);
  AddConvert(app, action);
}

constexpr const char* kAbout =
    "Elasto-geometric calibration of humanoid robots from marker positions.";

int Run(int argc, char** argv) {
  SetCommandLine(argc, argv);
  CLI::App app(kAbout);
  Action action;
  AddCommands(app, action);
  if (argc == 3 && std::string(argv[1]) == "--generate") return Generate(app, argv[2]);
  if (const std::string unknown = UnknownCommand(app, argc, argv); !unknown.empty()) {
    spdlog::error("{} (elastocal --help lists the commands)", unknown);
    return kUsage;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream out, err;
    const bool fine = app.exit(error, out, err) == 0;
    fmt::print("{}", Printable(out.str()));
    fmt::print(stderr, "{}", Printable(err.str()));
    return fine ? kFine : kUsage;
  }
  return action();
}

/// Whether everything that was printed has been written.
bool Printed() { return std::fflush(stdout) == 0 && std::ferror(stdout) == 0; }

/// Runs the program, and reports exceptions of libraries that an input or an output causes; these
/// are no defects of the program.
int RunAndExplain(int argc, char** argv) {
  try {
    const int code = Run(argc, argv);
    if (Printed()) return code;
    spdlog::error("cannot write to standard output: {}", std::strerror(errno));
    return code == kFine ? kBadInput : code;
  } catch (const InputError& error) {
    spdlog::error("{}", error.what());
  } catch (const std::bad_alloc&) {
    spdlog::error("there is not enough memory for an input of this size");
  } catch (const std::system_error& error) {
    // An error of the file system, with the path, or of standard output.
    spdlog::error("{}", error.what());
  }
  return kBadInput;
}

}  // namespace

std::string UsageErrorOf(std::vector<std::string> words) {
  CLI::App app(kAbout);
  Action action;
  AddCommands(app, action);
  std::reverse(words.begin(), words.end());  // the order that the library expects
  try {
    app.parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    return UsageError(app, error);
  }
  return "";
}

int RunCommandLine(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {"elastocal"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  return RunAndExplain(static_cast<int>(words.size()), argv.data());
}

}  // namespace elastocal::cli

/// Writes messages to standard error, never within a line of standard output or of progress.
class MessageSink : public spdlog::sinks::stderr_color_sink_mt {
 public:
  void log(const spdlog::details::log_msg& message) override {
    std::fflush(stdout);
    elastocal::cli::EraseProgressLine();
    const std::string text = elastocal::Printable({message.payload.data(), message.payload.size()});
    spdlog::details::log_msg printable = message;
    printable.payload = text;
    spdlog::sinks::stderr_color_sink_mt::log(printable);
  }
};

int main(int argc, char** argv) {
  // Keeps freed memory of matrices for the next ones, because new pages of the system take time.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("elastocal", std::make_shared<MessageSink>()));
  spdlog::set_pattern("elastocal: %^%l%$: %v");
  // Beyond a limit on the size of files, a write then fails with a message instead of this signal.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return elastocal::cli::RunAndExplain(argc, argv);
  } catch (const std::exception& error) {
    spdlog::critical(
        "{}\nThis is a defect of the program and not of your input. Please report it to its "
        "maintainers, with this message, the command line, the files that it names and what "
        "elastocal --version says.",
        error.what());
    return elastocal::cli::kInternal;
  }
}
