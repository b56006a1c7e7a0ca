#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/quick_demo.hpp"
#include "elastocal/cli/session.hpp"

namespace elastocal::cli {
namespace {

struct DemoOptions {
  CommonOptions common;
  std::string output = "elastocal_demo";
  int postures = 0;  ///< of each chain; 0: as many as it takes
  bool quick = false;
};

/// The embedded models: where they are installed beside the program, or the source tree's.
std::filesystem::path ModelsFolder() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto installed = program.parent_path() / ELASTOCAL_INSTALLED_MODELS;
  if (!error && std::filesystem::exists(installed / "talos")) return installed;
  return ELASTOCAL_SOURCE_MODELS;
}

using CommandLine = std::vector<std::string>;

/// From the robot's description to a calibrated one: the commands that a user would give.
std::vector<CommandLine> CompleteChain(const std::string& project, const DemoOptions& options) {
  const auto in = [&](const char* name) {
    return (std::filesystem::path(options.output) / name).string();
  };
  const std::string seed = std::to_string(options.common.seed.value_or(1));
  CommandLine design = {"design", project, "-o", in("postures.yaml"), "--seed", seed};
  if (options.postures > 0) {
    design.insert(design.end(), {"--postures", std::to_string(options.postures)});
  }
  std::vector<CommandLine> chain = {
      design,
      {"plan", project, "--postures", in("postures.yaml"), "-o", in("motion.csv")},
      {"simulate", project, "--motion", in("motion.csv"), "-o", in("recording"), "--seed", seed}};
  CommandLine calibrate = {"calibrate",    project,       "-o",
                           options.output, "--recording", in("recording")};
  for (const char* kind : {"sine", "random"}) {
    const std::string motion = in((std::string(kind) + ".csv").c_str());
    const std::string recording = in((std::string("recording_") + kind).c_str());
    chain.push_back({"plan", project, "--validation", kind, "-o", motion, "--seed", seed});
    chain.push_back(
        {"simulate", project, "--motion", motion, "--kind", kind, "-o", recording, "--seed", seed});
    calibrate.push_back(recording);
  }
  chain.push_back(calibrate);
  return chain;
}

int RunCompleteChain(const std::string& project, const DemoOptions& options) {
  for (CommandLine command : CompleteChain(project, options)) {
    if (options.common.Silent()) command.push_back("--quiet");
    Print(options.common.Silent(), fmt::format("\n$ elastocal {}\n", fmt::join(command, " ")));
    const int exit_code = RunCommandLine(command);
    if (exit_code != kFine) return exit_code;
  }
  return kFine;
}

/// The last line: what to look at.
void PointToReport(const DemoOptions& options) {
  const std::filesystem::path report =
      std::filesystem::absolute(std::filesystem::path(options.output) / "report.html");
  if (std::filesystem::exists(report)) {
    Print(options.common.Silent(), fmt::format("\nOpen in a browser: {}\n", report.string()));
  }
}

int Demo(const DemoOptions& options) {
  const std::string project = (ModelsFolder() / "talos" / "project.yaml").string();
  QuickDemoOptions quick{options.common, project, options.output};
  if (options.postures > 0) quick.postures = options.postures;
  const int exit_code = options.quick ? QuickDemo(quick) : RunCompleteChain(project, options);
  PointToReport(options);
  return exit_code;
}

}  // namespace

void AddDemo(CLI::App& app, Action& action) {
  auto options = std::make_shared<DemoOptions>();
  CLI::App* command = app.add_subcommand(
      "demo",
      "The complete chain on a virtual humanoid: design, plan, simulate, calibrate, validate");
  command->add_option("-o,--output", options->output, "Folder for all files")
      ->capture_default_str();
  command
      ->add_option("--postures", options->postures,
                   "Postures of each chain; default: as many as it takes (--quick: 60 in all)")
      ->check(CLI::Range(4, 10000));
  command->add_flag("--quick", options->quick,
                    "Only estimate, from a generated table of random postures of the upper body, "
                    "and show truth against estimate");
  AddCommonOptions(*command, options->common);
  command->footer("Example: elastocal demo --quick --seed 7");
  command->callback([&action, options] { action = [options] { return Demo(*options); }; });
}

}  // namespace elastocal::cli
