// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <chrono>
#include <filesystem>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/quick_demo.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/simulation_report.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/planning/simulate_experiment.hpp"

namespace elastocal::cli {
namespace {

struct DemoOptions {
  CommonOptions common;
  std::string output = "elastocal_demo";
  int count = 0;  ///< postures of each chain; 0: as many as needed
  bool quick = false;
};

/// Folder of the models that are installed with the program.
std::filesystem::path ModelsFolder() {
  const auto program = std::filesystem::read_symlink("/proc/self/exe");
  return std::filesystem::weakly_canonical(program.parent_path() / ELASTOCAL_MODELS);
}

using Words = std::vector<std::string>;

// The laboratory of the demo measures where the markers of hands, feet and waist are on their links
// (docs/tutorial.md): no recording tells it.
constexpr double kMarkerPlacesMm = 0.5;
constexpr std::array kMeasuredClusters = {"LHAND", "RHAND", "LFOOT", "RFOOT", "WAIST"};

/// Prints a command as a user would type it, and runs it.
int RunShown(Words command, const DemoOptions& options) {
  const bool silent = options.common.Silent();
  Print(silent, fmt::format("\n$ elastocal {}\n", fmt::join(command, " ")));
  if (silent) command.push_back("--quiet");
  return RunCommandLine(command);
}

/// Simulations that run while the next motions are planned, as by `simulate --motion`.
class Simulations {
 public:
  Simulations(const std::string& project, std::uint64_t seed) : project_(project), seed_(seed) {}

  /// The first recording also has the places of markers that were measured.
  void Start(const std::string& motion, const std::string& kind, const std::string& folder) {
    const std::size_t own = runs_.size();
    const bool first = runs_.empty();
    Words words = {"simulate", project_, "--motion", motion};
    if (!kind.empty()) words.insert(words.end(), {"--kind", kind});
    words.insert(words.end(), {"-o", folder, "--seed", std::to_string(seed_)});
    if (first) {
      words.insert(words.end(), {"--marker-places-mm", fmt::format("{}", kMarkerPlacesMm)});
      words.push_back("--marker-places-of");
      words.insert(words.end(), kMeasuredClusters.begin(), kMeasuredClusters.end());
    }
    const auto play = [this, own, first, motion, kind, folder] {
      const Project project = ReadProject(project_);
      SimulationOptions options = SimulationOfMotion(motion, project, TrialKindNamed(kind), seed_);
      if (first) {
        options.marker_places_sd = 1e-3 * kMarkerPlacesMm;
        options.marker_places_of.assign(kMeasuredClusters.begin(), kMeasuredClusters.end());
      }
      return SimulateExperiment(project, options, folder, [this, own](int done, int total) {
        const std::lock_guard lock(guard_);
        counts_[own] = {done, total};
      });
    };
    runs_.push_back({std::move(words), folder, std::async(std::launch::async, play)});
  }

  /// Waits for all simulations, and prints their output in turn.
  void Finish(bool silent) {
    const Progress progress = TerminalProgress("simulated trial", silent);
    for (Run& run : runs_) {
      while (run.result.wait_for(std::chrono::milliseconds(200)) != std::future_status::ready) {
        if (progress) Report(progress);
      }
    }
    if (progress) Report(progress);
    for (Run& run : runs_) {
      Print(silent, fmt::format("\n$ elastocal {}\n", fmt::join(run.words, " ")) +
                        DescribeSimulation(run.result.get()) + WrittenRecording(run.folder));
    }
  }

 private:
  struct Run {
    Words words;
    std::string folder;
    std::future<SimulationRun> result;
  };

  void Report(const Progress& progress) {
    int done = 0, total = 0;
    {
      const std::lock_guard lock(guard_);
      for (const auto& [own, count] : counts_) {
        done += count.first;
        total += count.second;
      }
    }
    if (total > 0) progress(done, total);
  }

  std::string project_;
  std::uint64_t seed_;
  std::mutex guard_;
  std::map<std::size_t, std::pair<int, int>> counts_;  ///< trials done and all trials, by run
  std::vector<Run> runs_;  ///< last, because their threads must end before the other members do
};

/// Throws InputError at once where `--json` cannot be written or is a file that the demo writes:
/// `calibrate` would see it only after the motions are simulated.
void RequireJsonPlace(const std::string& project, const DemoOptions& options) {
  const std::filesystem::path folder = options.output;
  OutputSet outputs;
  DeclareResults(folder, CalibrationFileNames(ReadProject(project)), outputs);
  for (const char* name : {"postures.yaml", "motion.csv", "sine.csv", "random.csv"}) {
    outputs.Declare(folder / name);
  }
  DeclareJson(options.common.json_file, outputs);
  outputs.Prepare();
}

/// Runs the commands from a robot description to a calibrated one. Each simulation begins when its
/// motion is planned, and runs beside the next steps.
int RunCompleteChain(const std::string& project, const DemoOptions& options) {
  if (!options.common.json_file.empty()) RequireJsonPlace(project, options);
  const auto in = [&](const std::string& name) {
    return (std::filesystem::path(options.output) / name).string();
  };
  const std::uint64_t seed = options.common.seed.value_or(1);
  const std::string seed_text = std::to_string(seed);
  Words design = {"design", project, "-o", in("postures.yaml"), "--seed", seed_text};
  if (options.count > 0) {
    design.insert(design.end(), {"--count", std::to_string(options.count)});
  }
  int exit_code = RunShown(design, options);
  if (exit_code != kFine) return exit_code;
  Words calibrate = {"calibrate", project, "-o", options.output, "--recording", in("recording")};
  if (!options.common.json_file.empty()) {
    calibrate.insert(calibrate.begin() + 2, {"--json", options.common.json_file});
  }
  Simulations simulations(project, seed);
  exit_code = RunShown({"plan", project, "--postures", in("postures.yaml"), "-o", in("motion.csv")},
                       options);
  if (exit_code != kFine) return exit_code;
  simulations.Start(in("motion.csv"), "", in("recording"));
  for (const std::string kind : {"sine", "random"}) {
    Words plan = {"plan", project, "--kind", kind, "-o", in(kind + ".csv"), "--seed", seed_text};
    if (options.count > 0 && kind == "random") {
      plan.insert(plan.end(), {"--count", std::to_string(options.count)});
    }
    exit_code = RunShown(plan, options);
    if (exit_code != kFine) return exit_code;
    simulations.Start(in(kind + ".csv"), kind, in("recording_" + kind));
    calibrate.push_back(in("recording_" + kind));
  }
  calibrate.insert(calibrate.end(), {"--marker-places", in("recording/marker_places.csv")});
  simulations.Finish(options.common.Silent());
  exit_code = RunShown(calibrate, options);
  if (exit_code != kFine) return exit_code;
  Words deploy = {"simulate",     project, "--deploy",     options.output, "--motion",
                  in("sine.csv"), "-o",    options.output, "--seed",       seed_text};
  if (options.count > 0) deploy.insert(deploy.end(), {"--stabiliser", "with", "--until-s", "120"});
  return RunShown(deploy, options);
}

/// Prints the last line, which says what to look at.
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
  if (options.count > 0) quick.postures = options.count;
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
      ->check(IsNamed)
      ->type_name("DIR")
      ->capture_default_str();
  command
      ->add_option(
          "--count", options->count,
          "Postures of each chain, designed and random, for a shorter demo that shows the "
          "calibration at work for two minutes, with a stabiliser only; default: as many as "
          "it takes, and 20 "
          "(--quick: 60 in all)")
      ->check(FromTo(4, 10000));
  command->add_flag("--quick", options->quick,
                    "Only estimate, from a generated table of random postures of the upper body, "
                    "and show truth against estimate");
  AddCommonOptions(*command, options->common);
  command->footer("Example: elastocal demo --quick --seed 7");
  command->callback([&action, options] { action = [options] { return Demo(*options); }; });
}

}  // namespace elastocal::cli
