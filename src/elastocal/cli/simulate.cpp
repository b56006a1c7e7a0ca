// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/execution_report.hpp"
#include "elastocal/cli/observation_commands.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/report_page.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/simulation_report.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/io/motion_file.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/planning/compensate_motion.hpp"
#include "elastocal/planning/execute_motion.hpp"
#include "elastocal/planning/simulate_experiment.hpp"
#include "elastocal/planning/simulation_settings.hpp"

namespace elastocal::cli {
namespace {

struct SimulateCommand {
  CommonOptions common;
  std::string project, output, trials = "all";
  std::string settings;
  std::string postures, motion, kind;  ///< for a motion that the user gives
  std::vector<std::string> chains, marker_places_of;
  int threads = 2, count = 0;
  std::string deploy;           ///< folder of a calibration that is used by controllers
  std::vector<std::string> as;  ///< knowledge of the controllers; empty: all kinds
  std::string stabiliser = "both";
  double until_s = DeployOptions().until_s;
  std::optional<std::uint64_t> robot_seed;
  double marker_places_mm = 0.0;  ///< sd of the table of measured marker positions; 0: none
  bool nominal = false, free = false, matched = false, force = false;
  std::map<std::string, std::string> flags;  ///< given options of the experiment, by key
};

std::string FlagName(std::string key) {
  std::replace(key.begin(), key.end(), '_', '-');
  return "--" + key;
}

/// Settings in increasing priority: defaults or a perfect robot, the settings file, the command
/// line.
VirtualExperimentOptions Settings(const SimulateCommand& options) {
  VirtualExperimentOptions settings;
  if (options.nominal) SwitchOffImperfections(settings);
  if (!options.settings.empty()) ReadSimulationSettings(options.settings, settings);
  for (const SimulationSetting& setting : SimulationSettings(settings)) {
    const auto given = options.flags.find(setting.key);
    if (given == options.flags.end() || given->second.empty()) continue;
    ApplySetting(setting, given->second, FlagName(setting.key) + ": ");
  }
  CheckRanges(settings);
  CheckTargets(settings);
  if (options.free) settings.physics.standing = Standing::kFree;
  return settings;
}

SimulationOptions MakeOptions(const SimulateCommand& command, const Project& project) {
  SimulationOptions options;
  options.experiment = Settings(command);
  options.experiment.seed = command.common.seed.value_or(1);
  options.experiment.robot_seed = command.robot_seed;
  options.trials = command.trials;
  options.matched = command.matched;
  options.marker_places_sd = 1e-3 * command.marker_places_mm;
  for (const std::string& name : command.marker_places_of) {
    FindCluster(project, name);  // refused here if it is unknown
    options.marker_places_of.push_back(name);
  }
  if (command.postures.empty() && command.motion.empty()) return options;
  const std::string& file = command.motion.empty() ? command.postures : command.motion;
  options.motion =
      command.motion.empty() ? ReadPosturesToPlay(file, project) : ReadMotion(file, project);
  options.given.name = TrialNameOf(file);
  options.given.kind = TrialKindNamed(command.kind);
  for (const std::string& name : command.chains) {
    options.given.chains.push_back(FindChain(project, name));
  }
  return options;
}

/// Refuses options that would have no effect with --deploy: it records nothing.
void RefuseIdleOfDeploy(const SimulateCommand& command) {
  const std::vector<std::pair<std::string, bool>> idle = {
      {"--postures", !command.postures.empty()},
      {"--count", command.count > 0},
      {"--kind", !command.kind.empty()},
      {"--chains", !command.chains.empty()},
      {"--trials", command.trials != "all"},
      {"--matched", command.matched},
      {"--force", command.force},
      {"--marker-places-mm", command.marker_places_mm > 0}};
  for (const auto& [option, given] : idle) {
    if (given) {
      throw InputError(option + ": it is for simulated recordings, and --deploy records nothing");
    }
  }
}

/// Executes a motion on the robot that was calibrated, and measures the gain by the calibration.
int Deploy(const SimulateCommand& command) {
  if (command.motion.empty()) throw InputError("--deploy: --motion FILE was expected with it");
  RefuseIdleOfDeploy(command);
  const Project project = ReadProject(command.project);
  const CalibrationFiles calibration = FindCalibrationFiles(command.deploy);
  const std::vector<std::filesystem::path> inputs = {
      command.project, project.urdf, command.settings, command.motion, calibration.calibration};
  OutputSet outputs;
  outputs.Protect(inputs);
  DeclareResults(command.output, {"deployment.json"}, outputs);
  DeclareJson(command.common.json_file, outputs);
  outputs.Prepare();

  DeployOptions options;
  const VirtualExperimentOptions settings = Settings(command);
  options.truth = settings.truth;
  options.truth.seed = command.robot_seed.value_or(command.common.seed.value_or(1));
  options.physics = settings.physics;
  options.threads = command.threads;
  if (!command.as.empty()) options.as.clear();
  for (const DeployAs as : {DeployAs::kNominal, DeployAs::kUrdf, DeployAs::kCompensated}) {
    const auto& given = command.as;
    if (std::find(given.begin(), given.end(), DeployName(as)) != given.end()) {
      options.as.push_back(as);
    }
  }
  if (command.stabiliser != "both") options.stabilised = {command.stabiliser == "with"};
  options.until_s = command.until_s;
  const bool quiet = command.common.Silent();
  const StoredCalibration stored = ReadCalibration(calibration.calibration);
  const JointMotion motion = ReadMotion(command.motion, project);
  const std::vector<Execution> executions =
      PlayExecutions(project, stored, motion, options, LoggedProgress("executed motion", quiet));
  const std::string json = FormatExecutions(project.tree, stored.fingerprint, executions);
  outputs.Set(command.common.json_file, json);
  const std::string no_report =
      SetResults(command.output, {{"deployment.json", json}},
                 MakeRunRecord("simulate --deploy", command.common, RecordInputs(inputs)), outputs);
  outputs.Publish();
  Print(quiet, DescribeOpenJoints(OpenJoints(project, motion)) + DescribeExecutions(executions));
  PrintReportPlace(command.output, no_report, quiet);
  const bool played =
      std::ranges::any_of(executions, [](const Execution& one) { return one.refused.empty(); });
  return played ? kFine : kNotConverged;
}

/// For a project with contact or instruments: simulates tables of observations instead of trials.
int SimulateInstruments(const SimulateCommand& command, const Project& project) {
  const bool of_trials = !command.motion.empty() || !command.kind.empty() ||
                         !command.chains.empty() || command.trials != "all" || command.matched ||
                         command.free || command.marker_places_mm > 0.0;
  if (of_trials) {
    throw InputError(
        project.file.string() +
        ": with contact or instruments, the robot holds postures: --motion, --kind, "
        "--chains, --trials, --matched, --free and --marker-places-mm are for projects without "
        "them");
  }
  SimulateObservationsCommand of;
  of.common = command.common;
  of.output = command.output;
  of.postures = command.postures;
  of.count = command.count;
  of.force = command.force;
  of.experiment = Settings(command);
  of.experiment.seed = command.common.seed.value_or(1);
  of.experiment.robot_seed = command.robot_seed;
  return RunObservationSimulation(of, project);
}

/// Refuses options that would have no effect.
void RefuseIdleOptions(const SimulateCommand& command, const Project& project) {
  if (command.count > 0) {
    throw InputError("--count: " + project.file.string() +
                     " has neither contact nor instruments, whose postures it counts");
  }
  if (!command.kind.empty() && command.motion.empty() && command.postures.empty()) {
    throw InputError("--kind: --motion FILE or --postures FILE was expected with it");
  }
  const bool given = !command.motion.empty() || !command.postures.empty();
  if (!command.chains.empty() && !given) {
    throw InputError("--chains: --motion FILE or --postures FILE was expected with it");
  }
}

int Simulate(const SimulateCommand& command) {
  if (!command.deploy.empty()) return Deploy(command);
  const Project project = ReadProject(command.project);
  if (project.contact) return SimulateInstruments(command, project);
  RefuseIdleOptions(command, project);
  const Simulation simulation = PrepareSimulation(project, MakeOptions(command, project));
  const SimulationFiles files = FilesOfSimulation(simulation, command.output, command.force);
  OutputSet outputs;
  outputs.Protect(
      {command.project, project.urdf, command.settings, command.postures, command.motion});
  for (const std::filesystem::path& file : files.all()) outputs.Declare(file);
  DeclareJson(command.common.json_file, outputs);
  outputs.Prepare();

  const bool quiet = command.common.Silent();
  const SimulationRun run = PlaySimulation(project, simulation, files, command.threads, outputs,
                                           TerminalProgress("played trial", quiet));
  outputs.Set(command.common.json_file, FormatSimulationSummary(run));
  outputs.Publish();
  Print(quiet, DescribeSimulation(run) + WrittenRecording(command.output));
  PrintWarnings(SimulationWarnings(project, simulation), command.common.verbose);
  return kFine;
}

/// Adds options that select what the robot plays.
void AddMotionOptions(CLI::App& command, SimulateCommand& options) {
  command
      .add_option("--trials", options.trials,
                  "Trials to play: all, calibration, validation, or the name of one")
      ->capture_default_str();
  auto* postures =
      command
          .add_option(
              "--postures", options.postures,
              "Plays these postures instead, move_s + rest_s apart (CSV or a posture file, YAML)")
          ->type_name("FILE");
  command
      .add_option("--count", options.count,
                  "In projects with contact or instruments, without --postures: number of random "
                  "postures for each plate, and for instruments (30)")
      ->check(FromTo(1, 1000))
      ->excludes(postures);
  command
      .add_option("--motion", options.motion, "Plays this joint trajectory instead (CSV with time)")
      ->excludes(postures)
      ->type_name("FILE");
  command
      .add_option("--chains", options.chains,
                  "Chains that --motion or --postures exercise; default: those that move")
      ->type_name("NAME");
  command
      .add_option("--kind", options.kind,
                  "What --motion or --postures are for; default: "
                  "calibration where the robot rests, else sine")
      ->transform(OneOf({"calibration", "sine", "random", "repeatability"}));
}

/// Adds options for robots that execute a motion by a calibration.
void AddDeployOptions(CLI::App& command, SimulateCommand& options) {
  auto* deploy =
      command
          .add_option("--deploy", options.deploy,
                      "Executes --motion on the robot that was calibrated (the same --seed and "
                      "options), whose controller uses the calibration in this folder: how far "
                      "are hands, feet and waist from the plan?")
          ->type_name("DIR");
  command
      .add_option("--as", options.as,
                  "What the controller of --deploy knows: nominal, urdf (the calibrated one) or "
                  "compensated; default: each in turn")
      ->needs(deploy)
      ->transform(OneOf({"nominal", "urdf", "compensated"}));
  command
      .add_option("--stabiliser", options.stabiliser,
                  "Whether the robots of --deploy are balanced by what feet and inertial unit "
                  "feel: with, without, or both, which takes twice as long")
      ->needs(deploy)
      ->transform(OneOf({"with", "without", "both"}))
      ->capture_default_str();
  command
      .add_option("--until-s", options.until_s,
                  "Time of the motion until which the robots of --deploy play it, s; default: to "
                  "its end")
      ->needs(deploy)
      ->check(FromTo(1.0, 1e6));
}

/// Adds options on playing and recording.
void AddPlayOptions(CLI::App& command, SimulateCommand& options) {
  command.add_option("--threads", options.threads, "Trials played at a time")
      ->check(FromTo(1, 64))
      ->capture_default_str();
  command
      .add_option("--settings", options.settings,
                  "File with any of the options below (YAML; docs/formats.md)")
      ->type_name("FILE");
  command.add_flag("--nominal", options.nominal,
                   "Begin with a robot and sensors without any imperfection");
  command.add_flag("--matched", options.matched,
                   "The truth is the estimator's own error model at rest at every instant, instead "
                   "of physics: to see whether it finds what it models");
  command.add_flag("--free", options.free,
                   "Feet lie on the floor by contact instead of being part of it");
  command.add_flag("--force", options.force,
                   "Replace recordings in the folder that were not simulated");
}

/// Message if the value of a setting is wrong; else empty. It is checked first, so that a long
/// batch refuses it at once.
std::string WrongSetting(const std::string& key, const std::string& text) {
  VirtualExperimentOptions tried;
  for (const SimulationSetting& setting : SimulationSettings(tried)) {
    if (setting.key != key) continue;
    try {
      ApplySetting(setting, text, "");
    } catch (const InputError& error) {
      return error.what();
    }
  }
  return "";
}

/// Adds the settings of --settings as flags.
void AddSettings(CLI::App& command, SimulateCommand& options) {
  VirtualExperimentOptions defaults;
  for (const SimulationSetting& setting : SimulationSettings(defaults)) {
    const std::string value = SettingText(setting);
    command
        .add_option(FlagName(setting.key), options.flags[setting.key],
                    setting.help + (value.empty() ? "" : " [" + value + "]"))
        ->check([key = setting.key](const std::string& text) { return WrongSetting(key, text); })
        ->group(setting.group);
  }
}

}  // namespace

void AddSimulate(CLI::App& app, Action& action) {
  auto options = std::make_shared<SimulateCommand>();
  CLI::App* command = app.add_subcommand(
      "simulate", "Simulate a whole calibration experiment: a recording folder with known truth");
  command->add_option("project", options->project, "Project file (YAML)")->required();
  command->add_option("-o,--output", options->output, "Folder for the recording")
      ->required()
      ->check(IsNamed)
      ->type_name("DIR");
  AddMotionOptions(*command, *options);
  AddDeployOptions(*command, *options);
  AddPlayOptions(*command, *options);
  AddCommonOptions(*command, options->common);
  command
      ->add_option("--robot-seed", options->robot_seed,
                   "Seed of the robot's errors, if another than --seed: the same robot, recorded "
                   "again with other postures and noise")
      ->check(IsSeed);
  CLI::Option* places =
      command
          ->add_option("--marker-places-mm", options->marker_places_mm,
                       "Also writes marker_places.csv for `calibrate --marker-places`: the places "
                       "of the markers on their links, measured with this standard deviation, mm")
          ->check(InBounds("simulate --marker-places-mm"));
  command
      ->add_option("--marker-places-of", options->marker_places_of,
                   "Clusters whose markers are measured for it; default: all")
      ->type_name("NAME")
      ->needs(places);
  AddSettings(*command, *options);
  command->footer("Example: elastocal simulate models/talos/project.yaml -o recording");
  command->callback([&action, options] { action = [options] { return Simulate(*options); }; });
}

}  // namespace elastocal::cli
