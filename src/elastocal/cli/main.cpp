#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/completion.hpp"
#include "elastocal/cli/manual_page.hpp"
#include "elastocal/cli/progress.hpp"
#include "elastocal/cli/report_page.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/report/version.hpp"

namespace elastocal::cli {

void AddCommonOptions(CLI::App& command, CommonOptions& options) {
  AddOutputOptions(command, options);
  command
      .add_option("--seed", options.seed,
                  "Seed of all that is drawn at random (postures for identifiability, folds, the "
                  "demo's truth); default 1, or the project's")
      ->check([](const std::string& text) {
        return text.starts_with('-') ? std::string("a seed is 0 or above") : std::string();
      });
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

namespace {

/// What is wrong with the first word of the command line where it is no command; else empty.
std::string UnknownCommand(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return "";
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  if (std::find(known.begin(), known.end(), argv[1]) != known.end()) return "";
  return "unknown command '" + std::string(argv[1]) + "'" + DidYouMean(argv[1], known);
}

/// What the build installs beside the program: its manual page, and completion for shells.
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

int Run(int argc, char** argv) {
  SetCommandLine(argc, argv);
  CLI::App app("Elasto-geometric calibration of humanoid robots from marker positions.");
  app.name("elastocal");
  app.set_version_flag("--version", std::string("elastocal ") + ProgramVersion());
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 fine, 2 usage, 3 bad input, 4 not converged or infeasible.\n"
      "Example: elastocal demo");
  Action action;
  AddInspect(app, action);
  AddCalibrate(app, action);
  AddValidate(app, action);
  AddCompare(app, action);
  AddDemo(app, action);
  AddSimulate(app, action);
  AddDesign(app, action);
  AddAssess(app, action);
  AddReport(app, action);
  AddPlan(app, action);
  if (argc == 3 && std::string(argv[1]) == "--generate") return Generate(app, argv[2]);
  if (const std::string unknown = UnknownCommand(app, argc, argv); !unknown.empty()) {
    spdlog::error("{} (elastocal --help lists the commands)", unknown);
    return kUsage;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kFine : kUsage;
  }
  try {
    return action();
  } catch (const InputError& error) {
    spdlog::error("{}", error.what());
    return kBadInput;
  }
}

}  // namespace

int RunCommandLine(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {"elastocal"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  return Run(static_cast<int>(words.size()), argv.data());
}

}  // namespace elastocal::cli

/// Messages on standard error, never within a line of standard output or of progress.
class MessageSink : public spdlog::sinks::stderr_color_sink_mt {
 public:
  void log(const spdlog::details::log_msg& message) override {
    std::fflush(stdout);
    elastocal::cli::EraseProgressLine();
    spdlog::sinks::stderr_color_sink_mt::log(message);
  }
};

int main(int argc, char** argv) {
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("elastocal", std::make_shared<MessageSink>()));
  spdlog::set_pattern("elastocal: %^%l%$: %v");
  try {
    return elastocal::cli::Run(argc, argv);
  } catch (const std::exception& error) {
    spdlog::critical("{}", error.what());
    return elastocal::cli::kInternal;
  }
}
