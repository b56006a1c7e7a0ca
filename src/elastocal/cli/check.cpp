// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/figures.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/report_page.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/check_calibration.hpp"
#include "elastocal/pipeline/measurements.hpp"
#include "elastocal/pipeline/result_folder.hpp"

namespace elastocal::cli {
namespace {

constexpr double kLeastShown = 0.01;  // of the probability of a joint
constexpr std::size_t kMostShown = 5;

struct CheckCommand {
  CommonOptions common;
  std::string project, calibration;
  std::vector<std::string> recording;  ///< one
  CheckOptions check;
};

std::string ChangeText(const ParameterChange& change) {
  Parameter parameter{};
  parameter.unit = change.unit;
  const double factor = InUserUnits(parameter, 1.0);
  const double sd = factor * change.sd;
  return fmt::format("{} by {} +- {} {}", change.name, RoundedTo(factor * change.value, sd),
                     RoundedSd(sd), UserUnit(parameter));
}

/// Changes of more than two standard deviations, or the largest one.
std::string ChangesText(const JointSuspect& suspect) {
  std::string text;
  const ParameterChange* largest = nullptr;
  double most = -1.0;
  for (const ParameterChange& change : suspect.changes) {
    const double ratio = std::abs(change.value) / change.sd;
    if (ratio > most) {
      most = ratio;
      largest = &change;
    }
    if (ratio > 2.0) text += (text.empty() ? "" : ", ") + ChangeText(change);
  }
  return text.empty() && largest != nullptr ? ChangeText(*largest) : text;
}

std::string JointTable(const JointCheck& check) {
  TextTable table({"joint", "p of all joints", "probability that it is the one", "its change"});
  std::size_t shown = 0;
  for (const JointSuspect& joint : check.joints) {
    if (joint.probability < kLeastShown || ++shown > kMostShown) break;
    table.Add({joint.joint, fmt::format("{:.2g}", joint.p_adjusted),
               fmt::format("{:.2f}", joint.probability), ChangesText(joint)});
  }
  return table.Render();
}

std::string Conclusion(const CheckRun& run, const CheckCommand& command) {
  if (!run.check.changed()) {
    return fmt::format(
        "Unchanged: the calibration explains these postures (chance of a false alarm {:.3g} %).\n",
        100.0 * command.check.joints.level);
  }
  std::string text;
  for (const JointSuspect& joint : run.check.moved) {
    text += fmt::format("Moved: {} ({}; p {:.1g})\n", joint.joint, ChangesText(joint),
                        joint.p_adjusted);
  }
  if (!run.check.suspects.empty()) {
    text += fmt::format(
        "Changed: one of {}. Five postures of each limb that tell which:\n"
        "  elastocal design {} --after {} --check --count 5 --joints {} -o next.yaml\n",
        fmt::join(run.check.suspects, ", "), command.project, command.calibration,
        fmt::join(run.check.suspects, " "));
  }
  return text;
}

std::string DescribeCheck(const CheckRun& run, const CheckCommand& command) {
  const JointCheck& check = run.check;
  std::string text = Conclusion(run, command) + "\n";
  text += fmt::format("{} postures, {} markers of {}\n", run.recording.posture_count(),
                      run.recording.marker_count(), run.recording.source);
  text += fmt::format(
      "error of the markers: {} mm uncalibrated, {} mm calibrated, {} mm with the joints free\n",
      Millimetres(run.transfer.uncalibrated.metrics_all.rmse_3d, 3),
      Millimetres(run.transfer.calibrated.metrics_all.rmse_3d, 3),
      Millimetres(run.rmse_estimate, 3));
  if (!check.suspects.empty() || command.common.verbose) {
    text += "\n" + JointTable(check);
  }
  if (!check.not_told.empty()) {
    text +=
        fmt::format("These postures cannot tell whether the zeros of these joints have moved: {}\n",
                    fmt::join(check.not_told, ", "));
  }
  return text;
}

int Check(const CheckCommand& command) {
  const Project project = ReadProject(command.project);
  CheckHasMarkers(project);
  std::vector<std::filesystem::path> inputs = InputFiles(project, {command.recording.front()});
  const CalibrationFiles files = FindCalibrationFiles(command.calibration);
  inputs.insert(inputs.end(), {files.calibration, files.covariance});
  OutputSet outputs;
  outputs.Protect(inputs);
  DeclareJson(command.common.json_file, outputs);
  outputs.Prepare();
  CheckOptions options = command.check;
  options.seed = command.common.seed;
  const CheckRun run =
      CheckCalibration(project, command.calibration, command.recording.front(), options);
  outputs.Set(command.common.json_file, MakeCheckJson(run));
  outputs.Publish();

  Print(command.common.Silent(), DescribeCheck(run, command));
  PrintWarnings(run.warnings, command.common.verbose);
  if (!run.converged()) spdlog::error("the fit has not converged: {}", run.estimate.message);
  return run.converged() && !run.check.changed() ? kFine : kNotConverged;
}

}  // namespace

void AddCheck(CLI::App& app, Action& action) {
  auto options = std::make_shared<CheckCommand>();
  CLI::App* command = app.add_subcommand(
      "check", "Tell from a few postures whether a calibration still holds, and which joint moved");
  AddAppliedCalibration(*command, options->project, options->calibration, options->recording);
  command
      ->add_option("--level", options->check.joints.level,
                   "Chance that any joint of an unchanged robot is called moved all the same")
      ->check(InBounds("check --level"))
      ->capture_default_str();
  command
      ->add_option("--days", options->check.days,
                   "Days since the calibration: joints may have drifted a little")
      ->check(InBounds("check --days"))
      ->capture_default_str();
  AddAcceptOption(*command, options->check.accept);
  AddCommonOptions(*command, options->common);
  command->footer(
      "Ends with 0 where nothing has changed, and with 4 where a joint has moved.\n"
      "Example: elastocal check project.yaml --calibration out --recording today.csv");
  command->callback([&action, options] { action = [options] { return Check(*options); }; });
}

}  // namespace elastocal::cli
