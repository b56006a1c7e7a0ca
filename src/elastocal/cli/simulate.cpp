#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/io/output_files.hpp"
#include "elastocal/io/simulation_settings.hpp"
#include "elastocal/io/truth_file.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal::cli {
namespace {

using Json = nlohmann::ordered_json;

struct SimulateOptions {
  CommonOptions common;
  std::string project, output, trials = "all";
  std::string settings;
  int threads = 2;
  bool nominal = false, free = false;
  std::map<std::string, std::string> flags;  ///< options of the experiment given, by key
};

std::string FlagName(std::string key) {
  std::replace(key.begin(), key.end(), '_', '-');
  return "--" + key;
}

/// What is kept of a trial once its files are written.
struct PlayedTrial {
  TrialFiles files;
  SensorTruth sensors;
  int frames = 0;
  WaistGive waist;
};

std::vector<std::size_t> Chosen(const VirtualExperiment& experiment, const std::string& which) {
  std::vector<std::size_t> chosen;
  std::vector<std::string> names = {"all", "calibration", "validation"};
  for (std::size_t i = 0; i < experiment.trials.size(); ++i) {
    const PlannedTrial& trial = experiment.trials[i];
    names.push_back(trial.name);
    const bool calibration = trial.kind == TrialKind::kCalibration;
    if (which == "all" || which == trial.name ||
        which == (calibration ? "calibration" : "validation")) {
      chosen.push_back(i);
    }
  }
  if (chosen.empty()) {
    throw InputError("--trials: there is no trial '" + which + "'" + DidYouMean(which, names));
  }
  return chosen;
}

/// Plays and writes all trials, several at a time; the result does not depend on how many.
std::vector<PlayedTrial> PlayAll(const VirtualExperiment& experiment,
                                 const std::vector<std::size_t>& chosen,
                                 const SimulateOptions& options) {
  std::vector<PlayedTrial> played(chosen.size());
  std::atomic<std::size_t> next = 0;
  std::exception_ptr failure;
  std::mutex guard;
  int done = 0;
  const Progress progress = TerminalProgress("trial", options.common.Silent());
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < chosen.size(); i = next++) {
        const SimulatedTrial trial = RunTrial(experiment, chosen[i]);
        played[i] = {WriteSimulatedTrial(options.output, experiment.trials[chosen[i]], trial),
                     trial.raw.truth, trial.motion.frame_count(),
                     LargestWaistDeflection(experiment, chosen[i], trial.motion)};
        const std::lock_guard lock(guard);
        ++done;
        if (progress) progress(done, static_cast<int>(chosen.size()));
      }
    } catch (...) {
      const std::lock_guard lock(guard);
      failure = std::current_exception();
      next = chosen.size();
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < options.threads; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
  return played;
}

std::string TrialTable(const std::vector<PlayedTrial>& played, const VirtualExperiment& experiment,
                       const std::vector<std::size_t>& chosen) {
  TextTable table({"trial", "kind", "postures", "frames", "lag s", "waist gives way mm", "deg"});
  for (std::size_t i = 0; i < played.size(); ++i) {
    const PlannedTrial& plan = experiment.trials[chosen[i]];
    table.Add({plan.name, TrialKindName(plan.kind), std::to_string(plan.postures),
               std::to_string(played[i].frames), fmt::format("{:.3f}", played[i].sensors.lag_s),
               fmt::format("{:.2f}", 1e3 * played[i].waist.translation),
               fmt::format("{:.3f}", played[i].waist.rotation * 180.0 / M_PI)});
  }
  return table.Render();
}

std::string StiffnessTable(const VirtualExperiment& experiment) {
  TextTable table(
      {"leg", "Kx N/mm", "Ky N/mm", "Kz N/mm", "Krx N.m/rad", "Kry N.m/rad", "Krz N.m/rad"});
  for (const LegCompliance& leg : experiment.legs) {
    std::vector<std::string> row = {leg.chain};
    for (int i = 0; i < 6; ++i) {
      row.push_back(fmt::format("{:.3g}", leg.base.stiffness[i] * (i < 3 ? 1e-3 : 1.0)));
    }
    table.Add(row);
  }
  return table.Render();
}

Json MakeJson(const std::vector<PlayedTrial>& played, const VirtualExperiment& experiment,
              const std::vector<std::size_t>& chosen) {
  Json json;
  json["trials"] = Json::array();
  for (std::size_t i = 0; i < played.size(); ++i) {
    json["trials"].push_back({{"name", experiment.trials[chosen[i]].name},
                              {"postures", experiment.trials[chosen[i]].postures},
                              {"frames", played[i].frames},
                              {"lag_s", played[i].sensors.lag_s},
                              {"drift_ppm", played[i].sensors.drift_ppm},
                              {"waist_mm", 1e3 * played[i].waist.translation},
                              {"faults", played[i].sensors.faults}});
  }
  for (const LegCompliance& leg : experiment.legs) {
    json["stiffness"][leg.chain] =
        std::vector<double>(leg.base.stiffness.begin(), leg.base.stiffness.end());
  }
  return json;
}

/// Defaults, or a perfect robot; then the settings file; then the command line.
VirtualExperimentOptions Settings(const SimulateOptions& options) {
  VirtualExperimentOptions settings;
  if (options.nominal) SwitchOffImperfections(settings);
  if (!options.settings.empty()) ReadSimulationSettings(options.settings, settings);
  for (const SimulationSetting& setting : SimulationSettings(settings)) {
    const auto given = options.flags.find(setting.key);
    if (given == options.flags.end() || given->second.empty()) continue;
    ApplySetting(setting, given->second, FlagName(setting.key) + ": ");
  }
  if (options.free) settings.physics.standing = Standing::kFree;
  return settings;
}

int Simulate(const SimulateOptions& options) {
  const Project project = ReadProject(options.project);
  CheckOutputs({options.common.json_file}, {options.project, project.urdf, options.settings});
  VirtualExperimentOptions settings = Settings(options);
  settings.seed = options.common.seed.value_or(1);
  const VirtualExperiment experiment = PrepareExperiment(DescribeRobot(project), settings);
  const std::vector<std::size_t> chosen = Chosen(experiment, options.trials);
  const std::vector<PlayedTrial> played = PlayAll(experiment, chosen, options);

  Experiment written;
  std::vector<SensorTruth> sensors;
  for (const PlayedTrial& trial : played) {
    written.trials.push_back(trial.files);
    sensors.push_back(trial.sensors);
  }
  WriteTruth(options.output, experiment, chosen, sensors);
  WriteExperiment(options.output, written, project);
  Print(options.common.Silent(),
        TrialTable(played, experiment, chosen) + "\nStiffness of the legs as felt at the waist\n" +
            StiffnessTable(experiment) +
            fmt::format("\nWritten: {} with experiment.yaml and truth.yaml\n", options.output));
  if (!options.common.json_file.empty()) {
    WriteFile(options.common.json_file, MakeJson(played, experiment, chosen).dump(2) + "\n");
  }
  return kFine;
}

}  // namespace

void AddSimulate(CLI::App& app, Action& action) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* command = app.add_subcommand(
      "simulate", "Simulate a whole calibration experiment: a recording folder with known truth");
  command->add_option("project", options->project, "Project file (YAML)")->required();
  command->add_option("-o,--output", options->output, "Folder for the recording")->required();
  command
      ->add_option("--trials", options->trials,
                   "Which are played: all, calibration, validation, or the name of one")
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Trials played at a time")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--settings", options->settings,
                      "File with any of the options below (YAML; docs/formats.md)");
  command->add_flag("--nominal", options->nominal,
                    "Begin with a robot and sensors without any imperfection");
  command->add_flag("--free", options->free,
                    "Feet lie on the floor by contact instead of being part of it");
  AddCommonOptions(*command, options->common);
  VirtualExperimentOptions defaults;
  for (const SimulationSetting& setting : SimulationSettings(defaults)) {
    const std::string value = SettingText(setting);
    command
        ->add_option(FlagName(setting.key), options->flags[setting.key],
                     setting.help + (value.empty() ? "" : " [" + value + "]"))
        ->group(setting.group);
  }
  command->footer("Example: elastocal simulate models/talos/project.yaml -o recording");
  command->callback([&action, options] { action = [options] { return Simulate(*options); }; });
}

}  // namespace elastocal::cli
