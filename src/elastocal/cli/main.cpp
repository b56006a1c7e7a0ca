#include <algorithm>
#include <exception>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/report_page.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal::cli {

void AddCommonOptions(CLI::App& command, CommonOptions& options) {
  command.add_option("--json", options.json_file,
                     "Also write the results to this file, as JSON (- for standard output)");
  command
      .add_option("--seed", options.seed,
                  "Seed of all that is drawn at random (postures for identifiability, folds, the "
                  "demo's truth); default 1, or the project's")
      ->check([](const std::string& text) {
        return text.starts_with('-') ? std::string("a seed is 0 or above") : std::string();
      });
  command.add_flag("--quiet,-q", options.quiet, "Print nothing but warnings and errors");
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

int Run(int argc, char** argv) {
  SetCommandLine(argc, argv);
  CLI::App app("Elasto-geometric calibration of humanoid robots from marker positions.");
  app.name("elastocal");
  app.set_version_flag("--version", ELASTOCAL_VERSION);
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

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("elastocal"));
  spdlog::set_pattern("elastocal: %^%l%$: %v");
  try {
    return elastocal::cli::Run(argc, argv);
  } catch (const std::exception& error) {
    spdlog::critical("{}", error.what());
    return elastocal::cli::kInternal;
  }
}
