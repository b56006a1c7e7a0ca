#include <algorithm>
#include <atomic>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/simulation_report.hpp"
#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/io/motion_file.hpp"
#include "elastocal/io/output_files.hpp"
#include "elastocal/io/posture_file.hpp"
#include "elastocal/io/simulation_settings.hpp"
#include "elastocal/io/truth_file.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/simulation/given_motion.hpp"

namespace elastocal::cli {
namespace {

struct SimulateOptions {
  CommonOptions common;
  std::string project, output, trials = "all";
  std::string settings;
  std::string postures, motion, kind;  ///< of a motion that the user gives
  std::vector<std::string> chains;
  int threads = 2;
  bool nominal = false, free = false, matched = false;
  std::map<std::string, std::string> flags;  ///< options of the experiment given, by key
};

std::string FlagName(std::string key) {
  std::replace(key.begin(), key.end(), '_', '-');
  return "--" + key;
}

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

/// The experiment that is played: the virtual one, or that of the error model.
struct Played {
  VirtualExperiment experiment;
  std::optional<MatchedExperiment> matched = {};

  SimulatedTrial Run(std::size_t trial) const {
    return matched ? RunMatchedTrial(*matched, trial) : RunTrial(experiment, trial);
  }
  WaistGive LargestDeflection(std::size_t trial, const TrueMotion& motion) const {
    return matched ? LargestMatchedDeflection(*matched, trial, motion)
                   : LargestWaistDeflection(experiment, trial, motion);
  }
};

/// The model that a calibration of these trials has.
MatchedExperiment Match(const VirtualExperiment& experiment, const Project& project,
                        const std::vector<std::size_t>& chosen) {
  std::vector<Trial> trials;
  for (std::size_t i : chosen) {
    const PlannedTrial& planned = experiment.trials[i];
    if (planned.kind != TrialKind::kCalibration) continue;
    Trial trial{planned.name, planned.kind, {}, planned.support};
    for (int chain : planned.chains) trial.chains.push_back(project.chains[chain].name);
    trials.push_back(trial);
  }
  if (trials.empty()) {
    throw InputError("--matched: the model is that of calibration trials, and none is played");
  }
  const ErrorModel model = MakeProjectModel(project, trials);
  return MatchExperiment(experiment, model,
                         FindBaseParameters(model, project.identifiability).kept);
}

/// Plays and writes all trials, several at a time; the result does not depend on how many.
std::vector<WrittenTrial> PlayAll(const Played& play, const std::vector<std::size_t>& chosen,
                                  const SimulateOptions& options) {
  std::vector<WrittenTrial> played(chosen.size());
  std::atomic<std::size_t> next = 0;
  std::exception_ptr failure;
  std::mutex guard;
  int done = 0;
  const Progress progress = TerminalProgress("trial", options.common.Silent());
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < chosen.size(); i = next++) {
        const SimulatedTrial trial = play.Run(chosen[i]);
        played[i] = {WriteSimulatedTrial(options.output, play.experiment.trials[chosen[i]], trial),
                     trial.raw.truth, trial.motion.frame_count(),
                     play.LargestDeflection(chosen[i], trial.motion)};
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

/// A list of postures as a table, or a posture file.
JointMotion ReadPostures(const std::string& file, const Project& project) {
  const std::string extension = std::filesystem::path(file).extension().string();
  if (extension != ".yaml" && extension != ".yml") return ReadPostureList(file, project);
  return ListPostures(ReadPostureFile(file, project), file);
}

/// The experiment with the trials that it plans or with those that the user gives.
VirtualExperiment Prepare(const SimulateOptions& options, const Project& project) {
  VirtualExperimentOptions settings = Settings(options);
  settings.seed = options.common.seed.value_or(1);
  const DescribedRobot robot = DescribeRobot(project);
  if (options.postures.empty() && options.motion.empty()) {
    return PrepareExperiment(robot, settings);
  }
  const std::string& file = options.motion.empty() ? options.postures : options.motion;
  const JointMotion motion =
      options.motion.empty() ? ReadPostures(file, project) : ReadMotion(file, project);
  GivenMotionOptions given;
  given.name = std::filesystem::path(file).stem().string();
  given.kind = TrialKindNamed(options.kind);
  for (const std::string& name : options.chains) {
    given.chains.push_back(FindChain(project, name));
  }
  settings.motion.seed = settings.seed;
  return PrepareExperiment(
      robot, settings, PlanGivenMotion(robot.tree, robot.chains, motion, settings.motion, given));
}

/// No file that is written may replace one that was read.
void CheckSimulated(const SimulateOptions& options, const Project& project,
                    const VirtualExperiment& experiment, const std::vector<std::size_t>& chosen) {
  const std::filesystem::path folder = options.output;
  std::vector<std::filesystem::path> outputs = {options.common.json_file,
                                                folder / "experiment.yaml", folder / "truth.yaml"};
  for (std::size_t i : chosen) {
    for (const char* end : {".tsv", ".csv", "_waist.csv"}) {
      outputs.push_back(folder / (experiment.trials[i].name + end));
    }
  }
  CheckOutputs(outputs,
               {options.project, project.urdf, options.settings, options.postures, options.motion});
}

int Simulate(const SimulateOptions& options) {
  const Project project = ReadProject(options.project);
  Played play{Prepare(options, project)};
  const std::vector<std::size_t> chosen = Chosen(play.experiment, options.trials);
  CheckSimulated(options, project, play.experiment, chosen);
  if (options.matched) {
    play.matched = Match(play.experiment, project, chosen);
    play.experiment = play.matched->plan;
  }
  const VirtualExperiment& experiment = play.experiment;
  const std::vector<WrittenTrial> played = PlayAll(play, chosen, options);

  Experiment written;
  std::vector<SensorTruth> sensors;
  for (const WrittenTrial& trial : played) {
    written.trials.push_back(trial.files);
    sensors.push_back(trial.sensors);
  }
  if (play.matched) {
    WriteMatchedTruth(options.output, *play.matched, chosen, sensors);
  } else {
    WriteTruth(options.output, experiment, chosen, sensors);
  }
  WriteExperiment(options.output, written, project);
  Print(options.common.Silent(),
        DescribeSimulation(played, experiment, chosen) +
            fmt::format("\nWritten: {} with experiment.yaml and truth.yaml\n", options.output));
  if (!options.common.json_file.empty()) {
    WriteFile(options.common.json_file, MakeSimulationJson(played, experiment, chosen));
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
  auto* postures = command->add_option(
      "--postures", options->postures,
      "Plays these postures instead, move_s + rest_s apart (CSV or a posture file, YAML)");
  command
      ->add_option("--motion", options->motion,
                   "Plays this joint trajectory instead (CSV with time)")
      ->excludes(postures);
  command->add_option("--chains", options->chains,
                      "Chains that they exercise; default: those that move");
  command
      ->add_option("--kind", options->kind,
                   "What they are for: calibration, sine, random or repeatability; default: "
                   "calibration where the robot rests, else sine")
      ->check(CLI::IsMember({"calibration", "sine", "random", "repeatability"}));
  command->add_option("--threads", options->threads, "Trials played at a time")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--settings", options->settings,
                      "File with any of the options below (YAML; docs/formats.md)");
  command->add_flag("--nominal", options->nominal,
                    "Begin with a robot and sensors without any imperfection");
  command->add_flag(
      "--matched", options->matched,
      "The truth is the estimator's own error model at rest at every instant, instead "
      "of physics: to see whether it finds what it models");
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
