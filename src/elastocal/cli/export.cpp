// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/correction_limits.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/exports/export_calibration.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/report/version.hpp"

namespace elastocal::cli {
namespace {

struct ExportCommand {
  std::string calibration, project, output;
  bool quiet = false;
  std::optional<double> least_gain_mm;
  CorrectionLimits limits;
  double torque_time_constant_s = 0.0, period_s = CompensatorOptions().period_s;
  std::vector<CLI::Option*> of_header;  ///< options of the format c99 alone
  ExportOptions options;
};

/// Description of a format in a few words.
std::string WhatIs(const std::string& name) {
  const std::vector<ExportFormat> formats = ExportFormats();
  return std::ranges::find(formats, name, &ExportFormat::name)->what;
}

void RefuseIdleOptions(const ExportCommand& command) {
  if (command.options.format == "c99") return;
  for (const CLI::Option* option : command.of_header) {
    if (option->count() == 0) continue;
    throw InputError("format " + command.options.format + ": " + option->get_name() +
                     " is about format c99");
  }
}

int Export(const ExportCommand& command) {
  RefuseIdleOptions(command);
  const CalibratedRobot robot = OpenCalibratedRobot(command.calibration, command.project);
  OutputSet outputs;
  outputs.Protect(robot.inputs);
  if (!command.options.mjcf.empty()) outputs.Protect({command.options.mjcf});
  outputs.Protect(RecordedFiles(robot));
  outputs.Declare(command.output, IsExported);
  outputs.Prepare();
  ExportOptions options = command.options;
  options.version = ProgramVersion();
  options.output = command.output;
  options.limits = command.limits.Of();
  options.limits.torque_time_constant_s = command.torque_time_constant_s;
  options.limits.period_s = command.period_s;
  if (command.least_gain_mm) options.least_gain = 1e-3 * *command.least_gain_mm;
  const ExportedCalibration exported = ExportCalibration(robot, options);
  outputs.Set(command.output, exported.text);
  outputs.Publish();
  WarnOfExtra(robot, options.format == "c99" || options.format == "runtime");
  for (const std::string& note : exported.notes) Print(command.quiet, note + "\n");
  Print(command.quiet, fmt::format("Written: {}, {}\n", command.output, WhatIs(options.format)));
  return kFine;
}

/// Adds the calibration, the format and the file.
void AddWhatAndWhere(CLI::App& command, ExportCommand& options) {
  AddCalibratedRobot(command, options.calibration, options.project);
  std::string help = "One of";
  std::vector<std::string> names;
  for (const ExportFormat& format : ExportFormats()) {
    help += fmt::format("{} {}: {}", names.empty() ? "" : ";", format.name, format.what);
    names.push_back(format.name);
  }
  command.add_option("--format", options.options.format, help)
      ->required()
      ->transform(OneOf(names))
      ->type_name("NAME");
  command.add_option("-o,--output", options.output, "The file to write")
      ->required()
      ->check(IsNamed)
      ->type_name("FILE");
}

/// Adds options that select joints, for any format.
void AddChoiceOfJoints(CLI::App& command, ExportCommand& options) {
  command
      .add_option("--min-significance", options.options.least_significance,
                  "Joints whose errors are all below so many standard deviations stay nominal")
      ->check(FromTo(0.0, 100.0))
      ->capture_default_str();
  command
      .add_option("--min-gain", options.least_gain_mm,
                  "Joints whose errors gain no more than so many mm of RMSE on held-out data stay "
                  "nominal; recordings as the calibration's record names them")
      ->check(FromTo(0.0, 100.0))
      ->type_name("MM");
}

/// Adds options of single formats.
void AddOptionsOfFormats(CLI::App& command, ExportOptions& options) {
  command
      .add_option("--prefix", options.prefix,
                  "Beginning of all names in C; default: the robot's name")
      ->check(IsNamed)
      ->type_name("NAME");
  command
      .add_option("--mjcf", options.mjcf,
                  "The nominal MuJoCo model of the robot, for --format mjcf")
      ->type_name("FILE");
  command
      .add_option("--mjcf-joints", options.mjcf_joints,
                  "Joints that the MuJoCo model calls otherwise than the URDF, as URDF=MJCF; a * "
                  "on both sides stands for the rest of the name: 'panda_*=*'")
      ->type_name("NAME");
  command.add_flag("--mjcf-springs", options.mjcf_springs,
                   "For --format mjcf: springs in series with the joints, where the calibration "
                   "is elastic");
  command.add_flag("--beside-springs", options.beside_springs,
                   "For formats without springs: the geometry of the elastic model, for programs "
                   "that correct elasticity themselves (Correct of the run-time library, "
                   "flex-joints); default: the geometry that predicts best without springs");
  command
      .add_option("--hip-damping", options.hip_damping,
                  "For --format flex_joints: damping of the hips, N.m.s/rad, which no calibration "
                  "tells")
      ->check(FromTo(0.0, 1e9))
      ->type_name("VALUE");
}

/// Adds what the C header has fixed, for --format c99.
void AddOptionsOfHeader(CLI::App& command, ExportCommand& options) {
  const auto begin = command.get_options().size();
  command
      .add_option("--torque-time-constant-s", options.torque_time_constant_s,
                  "Time constant of the low-pass on given torques, s: measured torques of fast "
                  "motion hold more than the load that deflects the robot. 0: none")
      ->check(InBounds("export --torque-time-constant-s"))
      ->capture_default_str();
  command
      .add_option("--period-s", options.period_s,
                  "Interval between the controller's calls, s, for this low-pass")
      ->check(InBounds("export --period-s"))
      ->capture_default_str();
  AddCorrectionLimits(command, options.limits);
  const std::vector<CLI::Option*> all = command.get_options();
  for (std::size_t i = begin; i < all.size(); ++i) {
    all[i]->group("Fixed in the header (c99)");
    options.of_header.push_back(all[i]);
  }
}

}  // namespace

void AddExport(CLI::App& app, Action& action) {
  auto options = std::make_shared<ExportCommand>();
  CLI::App* command = app.add_subcommand(
      "export", "Write a calibration in a form that controllers and ROS read (docs/deploy.md)");
  AddWhatAndWhere(*command, *options);
  AddChoiceOfJoints(*command, *options);
  AddOptionsOfFormats(*command, options->options);
  AddOptionsOfHeader(*command, *options);
  command->add_flag("--quiet,-q", options->quiet, "Print nothing but warnings and errors");
  command->footer("Example: elastocal export out --format c99 -o talos_model.h");
  command->callback([&action, options] { action = [options] { return Export(*options); }; });
}

}  // namespace elastocal::cli
