// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>

#include <nlohmann/json.hpp>

#include "elastocal/files/output_files.hpp"
#include "elastocal/files/yaml_value.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/planning/simulate_experiment.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPlacesFile = "marker_places.csv";

bool IsThere(const fs::path& file) {
  std::error_code error;
  return fs::exists(fs::symlink_status(file, error));
}

/// Files of the trials that truth.yaml lists, as they were simulated: somebody may have added
/// trials of a real robot to experiment.yaml.
std::vector<fs::path> SimulatedTrialFiles(const SimulationFiles& of) {
  std::vector<fs::path> files;
  const YamlValue root = YamlValue::Parse(ReadFile(of.truth), of.truth.string());
  const auto trials = root.Find("trials");
  if (!trials) return files;
  for (const auto& [name, truth] : trials->Entries()) {
    if (fs::path(name) != fs::path(name).filename()) continue;
    PlannedTrial simulated;
    simulated.name = name;
    const TrialFiles trial = FilesOfTrial(simulated, of.folder);
    for (const fs::path& file : {trial.markers, trial.joints, trial.truth}) {
      if (IsThere(file)) files.push_back(file);
    }
  }
  return files;
}

/// The files of an earlier simulation in the folder; empty where there was none.
std::vector<fs::path> EarlierSimulation(const SimulationFiles& files, bool force) {
  if (!IsThere(files.truth)) return {};
  std::vector<fs::path> earlier = {files.truth};
  if (IsThere(files.folder / kPlacesFile)) earlier.push_back(files.folder / kPlacesFile);
  if (!IsThere(files.experiment)) return earlier;
  earlier.push_back(files.experiment);
  try {
    const std::vector<fs::path> trials = SimulatedTrialFiles(files);
    earlier.insert(earlier.end(), trials.begin(), trials.end());
  } catch (const InputError&) {
    if (!force) throw;  // it is unknown which files belong to the earlier simulation
  }
  return earlier;
}

bool Contains(const std::vector<fs::path>& files, const fs::path& file) {
  return std::find(files.begin(), files.end(), file) != files.end();
}

}  // namespace

std::vector<fs::path> SimulationFiles::all() const {
  std::vector<fs::path> files = {experiment, truth};
  if (!marker_places.empty()) files.push_back(marker_places);
  for (const TrialFiles& trial : trials) {
    files.insert(files.end(), {trial.markers, trial.joints, trial.truth});
  }
  files.insert(files.end(), earlier.begin(), earlier.end());
  return files;
}

TrialFiles FilesOfTrial(const PlannedTrial& plan, const fs::path& folder) {
  TrialFiles trial;
  trial.name = plan.name;
  trial.kind = plan.kind;
  trial.chains = plan.chains;
  trial.support = plan.support;
  trial.markers = folder / (plan.name + ".tsv");
  trial.joints = folder / (plan.name + ".csv");
  trial.truth = folder / (plan.name + "_waist.csv");
  return trial;
}

SimulationFiles FilesOfSimulation(const Simulation& simulation, const fs::path& folder,
                                  bool force) {
  RecoverOutputs(folder);
  SimulationFiles files;
  files.folder = folder;
  files.experiment = folder / "experiment.yaml";
  files.truth = folder / "truth.yaml";
  if (!simulation.marker_places.empty()) files.marker_places = folder / kPlacesFile;
  for (const std::size_t i : simulation.chosen) {
    TrialFiles trial = FilesOfTrial(simulation.experiment.trials[i], folder);
    trial.free_root = simulation.experiment.options.free_root && trial.support.empty();
    files.trials.push_back(std::move(trial));
  }
  const std::vector<fs::path> earlier = EarlierSimulation(files, force);
  const std::vector<fs::path> written = files.all();
  for (const fs::path& file : written) {
    if (force || !IsThere(file) || Contains(earlier, file)) continue;
    throw InputError(file.string() + ": is there and was not simulated (" +
                     (earlier.empty() ? "there is no truth.yaml beside it"
                                      : "the truth.yaml beside it does not list its trial") +
                     "), so it is not replaced; choose another folder, or give --force");
  }
  for (const fs::path& file : earlier) {
    if (!Contains(written, file) && !Contains(files.earlier, file)) files.earlier.push_back(file);
  }
  return files;
}

std::string FormatSimulationSummary(const SimulationRun& run) {
  nlohmann::ordered_json json;
  json["trials"] = nlohmann::ordered_json::array();
  for (const TrialOutcome& trial : run.trials) {
    json["trials"].push_back({{"name", trial.name},
                              {"postures", trial.postures},
                              {"frames", trial.frames},
                              {"lag_s", trial.sensors.lag_s},
                              {"drift_ppm", trial.sensors.drift_ppm},
                              {"waist_mm", 1e3 * trial.waist.translation},
                              {"faults", trial.sensors.faults}});
  }
  for (const LegCompliance& leg : run.legs) {
    json["stiffness"][leg.chain] =
        std::vector<double>(leg.compliance.stiffness.begin(), leg.compliance.stiffness.end());
  }
  return JsonText(json);
}

std::string TrialNameOf(const fs::path& file) {
  std::string name = file.stem().string();
  const std::string ending = "_motion";
  if (name.size() > ending.size() && name.ends_with(ending)) {
    name.resize(name.size() - ending.size());
  }
  for (char& c : name) {
    const bool fine =
        std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.' || c == '-';
    if (!fine) c = '_';
  }
  if (name.empty() || name.front() == '.') name.insert(0, "_");
  return name;
}

}  // namespace elastocal
