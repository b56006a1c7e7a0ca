// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/output_set.hpp"
#include "elastocal/planning/design_observations.hpp"
#include "elastocal/planning/simulate_experiment.hpp"
#include "elastocal/planning/simulate_observations.hpp"
#include "elastocal/planning/simulation_settings.hpp"
#include "motions.hpp"
#include "postures.hpp"

namespace elastocal::python {
namespace {

/// A value as on the command line: all digits of numbers, and commas between several values.
std::string SettingTextOf(const py::handle& value) {
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (!py::hasattr(value, "__len__")) return py::repr(py::float_(py::cast<double>(value)));
  std::string text;
  for (const py::handle& one : value) text += (text.empty() ? "" : ",") + SettingTextOf(one);
  return text;
}

void ApplySettings(const py::dict& given, VirtualExperimentOptions& options) {
  const std::vector<SimulationSetting> known = SimulationSettings(options);
  Names keys;
  for (const SimulationSetting& setting : known) keys.push_back(setting.key);
  for (const auto& [name, value] : given) {
    const auto key = name.cast<std::string>();
    const auto at = std::find(keys.begin(), keys.end(), key);
    if (at == keys.end()) {
      throw InputError("settings: no setting '" + key + "'" + DidYouMean(key, keys));
    }
    ApplySetting(known[static_cast<std::size_t>(at - keys.begin())], SettingTextOf(value),
                 "settings: " + key + ": ");
  }
}

/// Default or perfect robot, changed by the settings of a file or a dict.
VirtualExperimentOptions ExperimentOf(const py::object& settings, bool nominal, bool free,
                                      std::uint64_t seed, std::optional<std::uint64_t> robot_seed) {
  VirtualExperimentOptions options;
  if (nominal) SwitchOffImperfections(options);
  if (py::isinstance<py::dict>(settings)) {
    ApplySettings(settings.cast<py::dict>(), options);
  } else if (!settings.is_none()) {
    ReadSimulationSettings(settings.cast<Path>(), options);
  }
  CheckRanges(options);
  CheckTargets(options);
  if (free) options.physics.standing = Standing::kFree;
  options.seed = seed;
  options.robot_seed = robot_seed;
  return options;
}

/// The file of a trajectory or of postures; "motion" if they do not come from a file.
Path FileOf(const py::object& given) {
  const bool in_memory = py::isinstance<py::dict>(given) || py::isinstance<PyPlan>(given) ||
                         py::isinstance<PyDesign>(given);
  return in_memory ? Path("motion") : given.cast<Path>();
}

JointMotion PosturesToPlay(const py::object& given, const Project& project) {
  const bool in_memory = py::isinstance<py::dict>(given) || py::isinstance<PyDesign>(given);
  if (!in_memory) return ReadPosturesToPlay(given.cast<Path>(), project);
  return ListPostures(PosturesOf(given, project), "postures");
}

/// The results of a simulation, for programs.
struct Outcome {
  std::string summary;
  Names warnings;
};

Outcome SimulateTrials(const Project& project, const SimulationOptions& options, const Path& folder,
                       bool force, const Progress& progress) {
  const Simulation simulation = PrepareSimulation(project, options);
  const SimulationFiles files = FilesOfSimulation(simulation, folder, force);
  OutputSet outputs;
  outputs.Protect({project.file, project.urdf});
  for (const Path& file : files.all()) outputs.Declare(file);
  outputs.Prepare();
  const SimulationRun run =
      PlaySimulation(project, simulation, files, options.threads, outputs, progress);
  outputs.Publish();
  return {FormatSimulationSummary(run), SimulationWarnings(project, simulation)};
}

Outcome SimulateInstruments(const Project& project, std::vector<ChainPostures> postures, int count,
                            const VirtualExperimentOptions& experiment, const Path& folder,
                            bool force, const Progress& progress) {
  const Paths files = FilesOfObservedSimulation(project, folder, force);
  OutputSet outputs;
  outputs.Protect({project.file, project.urdf});
  for (const Path& file : files) outputs.Declare(file);
  outputs.Prepare();
  if (postures.empty()) {
    ObservationDesign drawn = DrawObservedPostures(project, count, experiment.seed);
    if (!drawn.infeasible.empty()) throw Infeasible(drawn.infeasible);
    postures = std::move(drawn.postures);
  }
  const ObservedRecording recording = SimulateObservations(project, postures, experiment, progress);
  for (auto& [name, text] : FormatObservedRecording(project, recording)) {
    outputs.Set(folder / name, text);
  }
  outputs.Publish();
  return {FormatObservedSimulation(recording), recording.warnings};
}

py::object Simulate(const ProjectOrFile& project_or_file, const Path& folder,
                    const py::object& motion, const py::object& postures, const std::string& trials,
                    const std::optional<std::string>& kind, const Names& chains,
                    const py::object& settings, bool nominal, bool matched, bool free, bool force,
                    int count, std::uint64_t seed, std::optional<std::uint64_t> robot_seed,
                    int threads, const Progress& progress) {
  const Project& project = project_or_file.project;
  if (folder.empty()) throw InputError("folder: a name was expected");
  if (!motion.is_none() && !postures.is_none()) {
    throw InputError("motion and postures: one of them was expected");
  }
  ExpectWithin("threads", threads, 1, 64);
  ExpectWithin("count", count, 1, 1000);
  SimulationOptions options;
  options.experiment = ExperimentOf(settings, nominal, free, seed, robot_seed);
  options.trials = trials;
  options.matched = matched;
  options.threads = threads;
  Outcome outcome;
  if (project.contact) {
    if (!motion.is_none() || kind || !chains.empty() || trials != "all" || matched || free) {
      throw InputError(project.file.string() +
                       ": with contact or instruments, the robot holds postures: motion, kind, "
                       "chains, trials, matched and free are for projects without them");
    }
    std::vector<ChainPostures> given;
    if (!postures.is_none()) given = PosturesOf(postures, project);
    outcome = Unlocked([&] {
      return SimulateInstruments(project, given, count, options.experiment, folder, force,
                                 progress);
    });
  } else {
    if (!motion.is_none() || !postures.is_none()) {
      options.motion =
          motion.is_none() ? PosturesToPlay(postures, project) : MotionOf(motion, project);
      options.given.name = TrialNameOf(FileOf(motion.is_none() ? postures : motion));
      if (kind) {
        options.given.kind = Named<TrialKind>("kind", *kind,
                                              {{"calibration", TrialKind::kCalibration},
                                               {"sine", TrialKind::kSine},
                                               {"random", TrialKind::kRandom},
                                               {"repeatability", TrialKind::kRepeatability}});
      }
      for (const std::string& name : chains) {
        options.given.chains.push_back(FindChain(project, name));
      }
    } else if (kind || !chains.empty()) {
      throw InputError("kind and chains: only with motion or postures");
    }
    outcome = Unlocked([&] { return SimulateTrials(project, options, folder, force, progress); });
  }
  py::object summary = FromJson(outcome.summary);
  summary["warnings"] = outcome.warnings;
  return summary;
}

/// All settings with their defaults as text, and their meanings.
py::dict DescribeSettings() {
  VirtualExperimentOptions defaults;
  py::dict all;
  for (const SimulationSetting& setting : SimulationSettings(defaults)) {
    all[py::str(setting.key)] =
        py::dict("default"_a = SettingText(setting), "help"_a = setting.help);
  }
  return all;
}

}  // namespace

void AddSimulating(py::module_& module) {
  const SimulationOptions defaults;
  module.def(
      "simulate", Simulate, "project"_a, "folder"_a, py::kw_only(), "motion"_a = py::none(),
      "postures"_a = py::none(), "trials"_a = defaults.trials, "kind"_a = std::nullopt,
      "chains"_a = Names(), "settings"_a = py::none(), "nominal"_a = false, "matched"_a = false,
      "free"_a = false, "force"_a = false, "count"_a = ObservationDesignOptions().count,
      "seed"_a = 1, "robot_seed"_a = std::nullopt, "threads"_a = defaults.threads,
      "progress"_a = Progress(),
      "Simulates a calibration experiment on a robot with known errors into `folder`, like the "
      "command of that name, and returns the dict of `elastocal simulate --json` with 'warnings'. "
      "motion: a Plan, a file (CSV), or a dict with time_s (samples,), positions (samples, joints) "
      "and perhaps support (lists of links). postures: a Design, a file, or a dict of chains. "
      "settings: a file, or a dict of simulation_settings(). nominal: begins without "
      "imperfections. Progress counts trials.");
  module.def("simulation_settings", DescribeSettings,
             "What `settings` of simulate() may hold: by key, its 'default' and 'help'.");
}

}  // namespace elastocal::python
