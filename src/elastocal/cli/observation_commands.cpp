// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/observation_commands.hpp"

#include <filesystem>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "elastocal/cli/next_postures_report.hpp"
#include "elastocal/cli/progress.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/planning/design_observations.hpp"
#include "elastocal/planning/simulate_observations.hpp"

namespace elastocal::cli {
namespace {

constexpr int kUsualCount = 30;

int CountOr(int count) { return count > 0 ? count : kUsualCount; }

std::string DesignText(const ObservationDesign& design) {
  TextTable table({"touches of, or seen by", "postures"});
  for (const ChainPostures& of : design.postures) {
    table.Add({of.chain, std::to_string(of.q.size())});
  }
  TextTable zeros({"zero of", "smallest change that is seen"});
  for (const ZeroSensitivity& zero : design.zeros) zeros.Add({zero.joint, SmallestChange(zero)});
  return "Postures for touches and instruments\n" + table.Render() +
         fmt::format("\nInformation {:.1f} nats, as many of the {} candidates at random: {:.1f}\n",
                     design.information, design.candidates, design.information_at_random) +
         (design.zeros.empty() ? "" : "\n" + zeros.Render());
}

std::vector<ChainPostures> PosturesToPlay(const SimulateObservationsCommand& command,
                                          const Project& project, const Progress& progress) {
  if (!command.postures.empty()) return ReadPostureFile(command.postures, project);
  const ObservationDesign drawn =
      DrawObservedPostures(project, CountOr(command.count), command.experiment.seed, progress);
  if (!drawn.infeasible.empty()) throw InputError(project.file.string() + ": " + drawn.infeasible);
  return drawn.postures;
}

std::string RecordingText(const ObservedRecording& recording) {
  std::map<std::string, int> shown;
  for (const SimulatedPosture& of : recording.postures) {
    if (of.plate >= 0) ++shown[recording.setup.instruments[of.plate]->name];
    for (std::size_t n = 0; n < of.measured.size(); ++n) {
      if (of.measured[n].size() > 0) ++shown[recording.setup.instruments[n]->name];
    }
  }
  TextTable table({"plate or instrument", "observations"});
  for (const auto& instrument : recording.setup.instruments) {
    table.Add({instrument->name, std::to_string(shown[instrument->name])});
  }
  return fmt::format("A virtual robot in {} postures\n", recording.postures.size()) +
         table.Render();
}

}  // namespace

int RunObservationDesign(const DesignObservationsCommand& command, const Project& project) {
  OutputSet outputs;
  outputs.Protect({project.file, project.urdf});
  if (!command.after.empty()) {
    const CalibrationFiles files = FindCalibrationFiles(command.after);
    outputs.Protect({files.calibration, files.covariance});
  }
  outputs.Declare(command.output, "robot: ");
  DeclareJson(command.common.json_file, outputs);
  outputs.Prepare();
  const bool quiet = command.common.Silent();
  ObservationDesignOptions options;
  options.count = CountOr(command.count);
  options.seed = command.common.seed.value_or(1);
  options.after = command.after;
  options.days = command.days;
  options.changes = command.changes;
  options.joints = command.joints;
  const ObservationDesign design =
      DesignObservations(project, options, TerminalProgress("drew posture", quiet));
  if (!design.infeasible.empty()) {
    spdlog::error("{}", design.infeasible);
    return kNotConverged;
  }
  outputs.Set(command.output, FormatPostureFile(project.tree, design.postures));
  outputs.Set(command.common.json_file, FormatObservationDesign(design));
  outputs.Publish();
  Print(quiet, DesignText(design) + fmt::format("\nWrote {}\n", command.output));
  return kFine;
}

int RunObservationSimulation(const SimulateObservationsCommand& command, const Project& project) {
  const std::filesystem::path folder = command.output;
  OutputSet outputs;
  outputs.Protect({project.file, project.urdf, command.postures});
  for (const std::filesystem::path& file :
       FilesOfObservedSimulation(project, folder, command.force)) {
    outputs.Declare(file);
  }
  DeclareJson(command.common.json_file, outputs);
  outputs.Prepare();
  const bool quiet = command.common.Silent();
  const ObservedRecording recording = SimulateObservations(
      project, PosturesToPlay(command, project, TerminalProgress("drew posture", quiet)),
      command.experiment, TerminalProgress("played posture", quiet));
  for (auto& [name, text] : FormatObservedRecording(project, recording)) {
    outputs.Set(folder / name, text);
  }
  outputs.Set(command.common.json_file, FormatObservedSimulation(recording));
  outputs.Publish();
  Print(quiet, RecordingText(recording) + fmt::format("\nWrote {}\n", command.output));
  PrintWarnings(recording.warnings, command.common.verbose);
  return kFine;
}

}  // namespace elastocal::cli
