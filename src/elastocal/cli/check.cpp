// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "elastocal/cli/command_result.hpp"
#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/contact_check.hpp"
#include "elastocal/cli/figures.hpp"
#include "elastocal/cli/moved_joints_report.hpp"
#include "elastocal/cli/next_postures_report.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/report_page.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/check_calibration.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/planning/next_postures.hpp"
#include "elastocal/recorded/measurements.hpp"

namespace elastocal::cli {
namespace {

std::string PlaceOf(const Recording& recording, Eigen::Index posture) {
  return recording.line.empty()
             ? fmt::format("posture {}", posture + 1)
             : fmt::format("line {}", recording.line[static_cast<std::size_t>(posture)]);
}

/// Describes postures with too large errors, the worst first.
std::vector<std::string> FarPostures(const CheckRun& run) {
  constexpr std::size_t kMostFar = 5;
  std::vector<Eigen::Index> far;
  for (Eigen::Index i = 0; i < run.left.size(); ++i) {
    if (run.left[i] > run.most_left()) far.push_back(i);
  }
  std::stable_sort(far.begin(), far.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return run.left[a] > run.left[b]; });
  std::vector<std::string> texts;
  for (const Eigen::Index i : far) {
    if (texts.size() == kMostFar) break;
    texts.push_back(
        fmt::format("{} ({} mm)", PlaceOf(run.recording, i), Millimetres(run.left[i], 2)));
  }
  return texts;
}

/// Text for errors that moved joints do not explain; these joints are then not named.
std::string Unexplained(const CheckRun& run) {
  std::string text = fmt::format(
      "Not explained: even if every joint may have moved, the robot errs by {} mm here, where the "
      "calibration left {} mm. Is something else wrong: a joint's gain, a marker or a cluster that "
      "was moved, one bad posture, the scale of the cameras? Look at the recording and measure "
      "again.\n",
      Millimetres(run.rmse_estimate, 3), Millimetres(run.left_before, 3));
  const std::vector<std::string> far = FarPostures(run);
  if (!far.empty()) text += fmt::format("Farthest off: {}\n", fmt::join(far, ", "));
  return text;
}

std::string Conclusion(const CheckRun& run, const CheckCommand& command) {
  if (!run.mistakes.empty()) {
    return fmt::format("The recording is wrong: {}\n", fmt::join(run.mistakes, "; "));
  }
  if (run.recording_explains()) return DescribeWrongRecording(run.alternatives);
  if (!run.check.changed() && !run.plausible()) {
    return fmt::format(
        "Not explained: the calibrated robot errs by {} mm here, where one that was never "
        "calibrated should err by some {:.2g} mm, and no joint that has moved explains it. Do "
        "recording, project and calibration belong together?\n",
        Millimetres(run.transfer.calibrated.metrics_all.rmse_3d, 3), 1e3 * run.expected_error);
  }
  if (!run.explained()) return Unexplained(run);
  if (run.changed_beyond_telling()) {
    const double errs = run.transfer.calibrated.metrics_all.rmse_3d;
    const bool joints_explain = run.rmse_estimate < 0.5 * errs;
    return fmt::format(
        "Changed: the calibrated robot errs by {} mm here, where the calibration left {} mm; {}\n",
        Millimetres(errs, 3), Millimetres(run.left_before, 3),
        joints_explain
            ? "these postures are too few to tell which joint has moved. Record more, and more "
              "different ones."
            : "no joint that has moved explains it. Was the robot calibrated in the same way: on "
              "its feet or held, with the same load, in postures as far apart?");
  }
  return DescribeMoved(run.check, run.alternatives, command.check.joints.level);
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
    text += "\n" + SuspectTable(check);
  }
  if (run.explained() && !FarPostures(run).empty()) {
    text += fmt::format("These are far off, and the others are not: {}. Look at them.\n",
                        fmt::join(FarPostures(run), ", "));
  }
  return text + DescribeMarkers(check.markers) + DescribeSensitivity(check);
}

CommandResult CheckByMarkers(const CheckCommand& command, const Project& project) {
  CheckOptions options = command.check;
  options.seed = command.common.seed;
  const CheckRun run =
      CheckCalibration(project, command.calibration, command.recording.front(), options);
  const NextPostures next =
      DesignNextPostures(project, command.calibration, run, options, kNextPostures,
                         TerminalProgress("designed chain", command.common.Silent()));
  CommandResult result;
  if (!next.postures.empty()) {
    result.files[command.output] = FormatPostureFile(project.tree, next.postures);
  }
  result.json = MakeCheckJson(project, run, next);
  result.text = DescribeCheck(run, command) + DescribeNext(project, next, command.output);
  result.warnings = run.warnings;
  if (!run.converged()) {
    result.errors.push_back("the fit has not converged: " + run.estimate.message);
  }
  result.fine = run.unchanged();
  return result;
}

void RefuseOtherKindsOptions(const CheckCommand& command, const Project& project) {
  if (project.contact && command.check.joints.new_markers) {
    throw InputError("check --new-markers: " + project.file.string() +
                     " has contact or instruments; a project with markers was expected");
  }
  if (!project.contact && command.recording.size() > 1) {
    throw InputError(
        "check: several recordings; one was expected, or a project with contact or instruments");
  }
}

int Check(const CheckCommand& command) {
  const std::vector<std::filesystem::path> recordings(command.recording.begin(),
                                                      command.recording.end());
  const Project project = ReadProject(command.project);
  RefuseOtherKindsOptions(command, project);
  std::vector<std::filesystem::path> inputs = InputFiles(project, recordings);
  const CalibrationFiles files = FindCalibrationFiles(command.calibration);
  inputs.insert(inputs.end(), {files.calibration, files.covariance});
  OutputSet outputs;
  outputs.Protect(inputs);
  outputs.Declare(command.output, "robot: ");
  DeclareJson(command.common.json_file, outputs);
  outputs.Prepare();

  const CommandResult result =
      project.contact ? CheckByContacts(command, project) : CheckByMarkers(command, project);
  for (const auto& [file, text] : result.files) outputs.Set(file, text);
  outputs.Set(command.common.json_file, result.json);
  outputs.Publish();
  result.Print(command.common);
  return result.exit_code();
}

}  // namespace

void AddCheck(CLI::App& app, Action& action) {
  auto options = std::make_shared<CheckCommand>();
  CLI::App* command = app.add_subcommand(
      "check", "Tell from a few postures whether a calibration still holds, and which joint moved");
  AddAppliedCalibration(*command, options->project, options->calibration, options->recording, true);
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
  command
      ->add_option("-o,--output", options->output,
                   "Where a joint has changed and several may be it: five postures of each limb "
                   "that tell which, as a posture file (YAML)")
      ->type_name("FILE");
  command->add_flag("--new-markers", options->check.joints.new_markers,
                    "Markers were taken off since: conclude nothing from their places");
  AddAcceptOption(*command, options->check.accept);
  AddCommonOptions(*command, options->common);
  command->footer(
      "Ends with 0 where nothing has changed, and with 4 where a joint has moved or the recording "
      "is not explained.\n"
      "Example: elastocal check project.yaml --calibration out --recording today.csv");
  command->callback([&action, options] { action = [options] { return Check(*options); }; });
}

}  // namespace elastocal::cli
