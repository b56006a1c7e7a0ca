#include <algorithm>
#include <limits>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "elastocal/cli/calibration_report.hpp"
#include "elastocal/cli/calibration_run.hpp"
#include "elastocal/cli/report_page.hpp"
#include "elastocal/identifiability/regressor.hpp"
#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/output_files.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal::cli {
namespace {

Excitation ExcitationOf(const Session& session, const CalibrationResult& result) {
  const Eigen::MatrixXd factor =
      RegressorFactor(result.model, ApplyErrors(result.model, result.delta), session.recording.q,
                      SeenMask(session.recording));
  // Of the geometry: whether a compliance was excited, its loads say (see unsupported parameters).
  std::vector<int> geometric;
  for (int i : session.base.kept) {
    if (!IsElastic(session.model.parameters[i].kind)) geometric.push_back(i);
  }
  return AssessExcitation(factor, geometric, session.recording.posture_count(), result.marker_sd);
}

/// On trials for validation where there are any, else on those of the estimate.
void AssessWaist(const Session& session, CalibrationRun& run) {
  run.waist_error.fill(std::numeric_limits<double>::quiet_NaN());
  const Recording& recording = run.held_out ? session.validation : session.recording;
  const auto& truth = run.held_out ? session.validation_truth : session.recording_truth;
  const auto known = [](const std::optional<Transform>& waist) { return waist.has_value(); };
  if (std::none_of(truth.begin(), truth.end(), known)) return;
  for (ModelKind kind : run.comparison.kinds) {
    const CalibrationResult& result = run.comparison.results[static_cast<int>(kind)];
    const Prediction prediction =
        Predict(result.model, result.delta, recording, session.project.calibration, nullptr,
                FootingBy::kFootMarkers);
    run.waist_error[static_cast<int>(kind)] = WaistError(prediction.placement, truth);
  }
}

CalibrationRun Calculate(const Session& session, const CalibrateOptions& options) {
  const CalibrationOptions& settings = session.project.calibration;
  CalibrationRun run;
  run.recording = session.recording;
  run.base = session.base;
  run.warnings = session.warnings;
  run.comparison = CompareModels(session.model, session.recording, session.base, settings);
  if (options.folds > 0) {
    run.cross_validation =
        CrossValidate(run.comparison, session.model, session.recording, session.base, settings,
                      options.folds, options.common.seed.value_or(1),
                      TerminalProgress("cross-validation", options.common.quiet));
  }
  run.trials = session.trials;
  run.knocks = session.knocks;
  if (session.validation.posture_count() > 0) {
    run.held_out = JudgeOnTrials(run.comparison, session.validation, settings);
  }
  AssessWaist(session, run);
  run.excitation = ExcitationOf(session, run.comparison.largest());
  run.verdict =
      Judge(run.comparison, run.cross_validation, run.excitation, run.recording, settings);
  if (run.held_out) JudgeHeldOut(run.held_out->table, run.comparison.largest_kind(), run.verdict);
  run.warnings.insert(run.warnings.end(), run.verdict.remarks.begin(), run.verdict.remarks.end());
  return run;
}

using Files = std::vector<std::pair<std::filesystem::path, std::string>>;

/// Results that stand in the folder if there are any, of this run or of an earlier one.
std::vector<std::filesystem::path> DeployablePaths(const CalibrateOptions& options,
                                                   const Project& project) {
  const std::filesystem::path folder = options.output;
  return {folder / (project.urdf.stem().string() + "_calibrated.urdf"), folder / "calibration.yaml",
          folder / "offsets.xacro", folder / "covariance.csv"};
}

/// What can be deployed; adds what the export has to warn of.
Files DeployableFiles(const CalibrateOptions& options, const Session& session,
                      CalibrationRun& run) {
  const ZeroOffsets zero_offsets =
      options.zero_offsets == "encoder" ? ZeroOffsets::kEncoder : ZeroOffsets::kOrigin;
  const CalibrationResult& result = run.comparison.largest();
  const CalibratedUrdf urdf = MakeCalibratedUrdf(
      ReadFile(session.project.urdf), session.project.urdf.string(), result, zero_offsets);
  run.warnings.insert(run.warnings.end(), urdf.warnings.begin(), urdf.warnings.end());
  const std::vector<std::filesystem::path> paths = DeployablePaths(options, session.project);
  return {{paths[0], urdf.text},
          {paths[1], MakeCalibrationYaml(result, run.base, run.recording.source, zero_offsets)},
          {paths[2], MakeXacroOffsets(urdf)},
          {paths[3], MakeCovarianceCsv(result)}};
}

/// What tells how it went, whether it can be deployed or not.
void AddAccount(const CalibrateOptions& options, const Session& session, const CalibrationRun& run,
                std::vector<InputRecord> inputs, Files& files) {
  const std::filesystem::path folder = options.output;
  const std::string summary = MakeSummaryJson(run);
  files.push_back({folder / "summary.json", summary});
  files.push_back({folder / "report_data.json", CalibrationDataJson(session, run)});
  files.push_back(
      {folder / "runs.json", RunsJson(folder, "calibrate", options.common, std::move(inputs))});
  if (!options.common.json_file.empty()) files.push_back({options.common.json_file, summary});
}

}  // namespace

int RunCalibration(const CalibrateOptions& options, CalibrationRun* run_out) {
  const bool quiet = options.common.Silent();
  const std::vector<std::filesystem::path> recordings(options.recordings.begin(),
                                                      options.recordings.end());
  const Session session = OpenSession(options.project, recordings, options.common.seed);
  const std::filesystem::path folder = options.output;
  const std::vector<std::filesystem::path> deployable_paths =
      DeployablePaths(options, session.project);
  std::vector<std::filesystem::path> outputs = deployable_paths;
  outputs.insert(outputs.end(),
                 {folder / "summary.json", folder / "report_data.json", folder / "runs.json",
                  folder / "report.html", options.common.json_file});
  std::vector<std::filesystem::path> inputs = {options.project, session.project.urdf};
  for (const std::filesystem::path& recording : recordings) {
    inputs.push_back(recording);
    inputs.push_back(recording / "experiment.yaml");
  }
  CheckOutputs(outputs, inputs);

  auto inputs_read = StartRecordingInputs(session.project, recordings);
  CalibrationRun run = Calculate(session, options);
  const bool deployable = run.verdict.objections.empty();
  Files files;
  if (deployable) files = DeployableFiles(options, session, run);
  AddAccount(options, session, run, inputs_read.get(), files);
  WriteFiles(files);
  if (!deployable) {
    std::error_code ignored;
    for (const auto& file : deployable_paths) std::filesystem::remove(file, ignored);
  }

  Print(quiet, DescribeRun(run));
  PrintWarnings(run.warnings);
  for (const std::string& objection : run.verdict.objections) spdlog::error("{}", objection);
  if (!deployable) spdlog::error("no calibrated URDF is written");
  Print(quiet, fmt::format("\nWritten to {}\n", options.output));
  WriteFolderReport(folder, quiet);
  if (run_out != nullptr) *run_out = std::move(run);
  return deployable ? kFine : kNotConverged;
}

void AddCalibrate(CLI::App& app, Action& action) {
  auto options = std::make_shared<CalibrateOptions>();
  CLI::App* command = app.add_subcommand(
      "calibrate", "Estimate the robot's errors from a recording; write the calibrated URDF");
  command->add_option("project", options->project, "Project file (YAML)")->required();
  command
      ->add_option("--recording", options->recordings,
                   "Table of static postures (CSV), or folders with experiment.yaml")
      ->required();
  command->add_option("-o,--output", options->output, "Folder for the results")
      ->required()
      ->check([](const std::string& folder) {
        return folder.empty() ? std::string("the folder needs a name") : std::string();
      });
  command->add_option("--kfold", options->folds, "Also cross-validate with this many folds")
      ->check(CLI::Range(2, 100000));
  command
      ->add_option("--zero-offsets", options->zero_offsets,
                   "Where the joints' zero offsets go: into the URDF's joint origins (origin) or "
                   "apart, to be added to the encoders (encoder)")
      ->check(CLI::IsMember({"origin", "encoder"}))
      ->capture_default_str();
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
