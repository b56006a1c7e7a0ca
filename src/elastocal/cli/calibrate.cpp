// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <future>
#include <iterator>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "elastocal/cli/calibration_report.hpp"
#include "elastocal/cli/calibration_run.hpp"
#include "elastocal/cli/command_result.hpp"
#include "elastocal/cli/contact_commands.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/report_page.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/io/marker_places_file.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/result_folder.hpp"

namespace elastocal::cli {
namespace {

FoldUnit UnitOf(const std::string& word) {
  if (word == "trial") return FoldUnit::kTrial;
  return word == "session" ? FoldUnit::kSession : FoldUnit::kPosture;
}

CommandResult CalibrateByMarkers(const CalibrateOptions& options, const Project& project,
                                 const std::vector<std::filesystem::path>& recordings,
                                 CalibrationRun& run) {
  run =
      CalibrateExperiment(project, recordings,
                          {.folds = options.folds,
                           .fold_unit = UnitOf(options.fold_by),
                           .threads = options.threads,
                           .zero_offsets = options.zero_offsets == "encoder" ? ZeroOffsets::kEncoder
                                                                             : ZeroOffsets::kOrigin,
                           .seed = options.common.seed,
                           .accept = options.accept,
                           .prior = options.prior,
                           .days = options.days,
                           .marker_places = options.marker_places,
                           .progress = TerminalSteps("reading and fitting", options.common.quiet)});
  return {.files = MakeCalibrationFiles(project, run),
          .json = {},
          .text = DescribeRun(run, options.common.verbose),
          .warnings = run.warnings,
          .errors = run.verdict.objections,
          .fine = run.deployable()};
}

}  // namespace

int RunCalibration(const CalibrateOptions& options, CalibrationRun* run_out) {
  const bool quiet = options.common.Silent();
  const std::filesystem::path folder = options.output;
  const std::vector<std::filesystem::path> recordings(options.recordings.begin(),
                                                      options.recordings.end());
  const Project project = ReadProject(options.project);
  if (project.contact && options.fold_by != "posture") {
    throw InputError("--fold-by " + options.fold_by + " is about recordings of trials");
  }
  std::vector<std::filesystem::path> inputs = InputFiles(project, recordings);
  if (!options.marker_places.empty()) {
    if (project.contact) {
      throw InputError(
          "--marker-places is about markers in recordings without contact and instruments; with "
          "them, mounting_sd_mm of the instrument says how well its place is known");
    }
    ReadMarkerPlaces(options.marker_places, project);  // refused before long computations
    inputs.emplace_back(options.marker_places);
  }
  OutputSet outputs;
  if (!options.prior.empty()) {
    const CalibrationFiles earlier = FindCalibrationFiles(options.prior);
    ReadCalibrationFiles(earlier);  // refused before long reading
    inputs.insert(inputs.end(), {earlier.calibration, earlier.covariance});
  }
  outputs.Protect(inputs);
  DeclareResults(folder, CalibrationFileNames(project), outputs);
  DeclareJson(options.common.json_file, outputs);
  outputs.Prepare();

  // Checksums of large recordings take a while and are computed on another thread.
  auto inputs_read = std::async(std::launch::async, RecordInputs, inputs);
  CalibrationRun run;
  CommandResult result = project.contact ? CalibrateByContacts(options, project, recordings)
                                         : CalibrateByMarkers(options, project, recordings, run);
  if (options.marker_places.empty() && !project.contact) {
    std::ranges::move(WarnOfIdleMarkerPlaces(recordings), std::back_inserter(result.warnings));
  }
  if (!result.fine) result.errors.emplace_back("no calibrated URDF is written");
  RunRecord record = MakeRunRecord("calibrate", options.common, inputs_read.get());
  record.assumptions = {options.accept, options.prior, options.days, options.marker_places};
  const std::string no_report = SetResults(folder, result.files, record, outputs);
  outputs.Set(options.common.json_file, result.files.at("summary.json"));
  outputs.Publish();

  result.Print(options.common);
  Print(quiet, fmt::format("\nWritten to {}\n", options.output));
  PrintReportPlace(folder, no_report, quiet);
  if (run_out != nullptr) *run_out = std::move(run);
  return result.exit_code();
}

namespace {

/// Adds the inputs and the output.
void AddInputs(CLI::App& command, CalibrateOptions& options) {
  command.add_option("project", options.project, "Project file (YAML)")->required();
  command
      .add_option(
          "--recording", options.recordings,
          "Table of static postures (CSV), folders with experiment.yaml, or tables of touches")
      ->required()
      ->type_name("DIR|FILE");
  command.add_option("-o,--output", options.output, "Folder for the results")
      ->required()
      ->check(IsNamed)
      ->type_name("DIR");
}

void AddFolds(CLI::App& command, CalibrateOptions& options) {
  command
      .add_option(
          "--kfold", options.folds,
          "Cross-validate with this many folds; 0: not (default: 10 for a table of postures, one "
          "each for fewer, 0 for trials)")
      ->check(FromTo(0, 100000));
  command
      .add_option("--fold-by", options.fold_by,
                  "What a fold leaves out: postures (nearly equal ones together), whole trials, or "
                  "sessions, which are all trials of a recording folder")
      ->transform(OneOf({"posture", "trial", "session"}))
      ->capture_default_str();
  command.add_option("--threads", options.threads, "Folds estimated at a time")
      ->check(FromTo(1, 64))
      ->capture_default_str();
}

/// Adds prior knowledge: an earlier calibration, marker positions, mistakes.
void AddKnowledge(CLI::App& command, CalibrateOptions& options) {
  CLI::Option* prior =
      command
          .add_option("--prior", options.prior,
                      "An earlier calibration of the robot (output folder of calibrate): a few "
                      "postures update it")
          ->type_name("DIR");
  command
      .add_option("--days", options.days,
                  "Days since that calibration: zeros may have drifted for as many of them as "
                  "the recording asks for")
      ->needs(prior)
      ->check(InBounds("calibrate --days"))
      ->capture_default_str();
  command
      .add_option("--marker-places", options.marker_places,
                  "Table (CSV) of markers whose places on their links were measured, with "
                  "standard deviations: tells where frames of hands and soles of feet are")
      ->type_name("FILE");
  AddAcceptOption(command, options.accept);
}

}  // namespace

void AddCalibrate(CLI::App& app, Action& action) {
  auto options = std::make_shared<CalibrateOptions>();
  CLI::App* command = app.add_subcommand(
      "calibrate", "Estimate the robot's errors from a recording; write the calibrated URDF");
  AddInputs(*command, *options);
  AddFolds(*command, *options);
  command
      ->add_option("--zero-offsets", options->zero_offsets,
                   "Where the joints' zero offsets go: into the URDF's joint origins (origin) or "
                   "apart, to be added to the encoders (encoder)")
      ->transform(OneOf({"origin", "encoder"}))
      ->capture_default_str();
  AddKnowledge(*command, *options);
  AddCommonOptions(*command, options->common);
  command->footer(
      "Writes ROBOT_calibrated.urdf, calibration.yaml, offsets.xacro and covariance.csv, and, "
      "also\n"
      "where the result is not to be trusted (exit code 4), summary.json, report_data.json,\n"
      "runs.json and report.html.\n"
      "Example: elastocal calibrate project.yaml --recording postures.csv --kfold 10 -o out");
  command->callback(
      [&action, options] { action = [options] { return RunCalibration(*options); }; });
}

}  // namespace elastocal::cli
