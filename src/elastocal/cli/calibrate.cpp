#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "elastocal/cli/calibration_report.hpp"
#include "elastocal/cli/calibration_run.hpp"
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
  return AssessExcitation(factor, session.base.kept, session.recording.posture_count(),
                          result.marker_sd);
}

CalibrationRun Calculate(const Session& session, const CalibrateOptions& options) {
  CalibrationRun run;
  run.recording = session.recording;
  run.base = session.base;
  run.warnings = session.warnings;
  run.comparison =
      CompareModels(session.model, session.recording, session.base, session.project.calibration);
  if (options.folds > 0) {
    run.cross_validation =
        CrossValidate(run.comparison, session.model, session.recording, session.base,
                      session.project.calibration, options.folds, options.common.seed,
                      TerminalProgress("cross-validation", options.common.quiet));
  }
  run.excitation = ExcitationOf(session, run.comparison.geometric());
  return run;
}

void WriteResults(const CalibrateOptions& options, const Session& session,
                  const CalibrationRun& run, const CalibratedUrdf& urdf, ZeroOffsets zero_offsets) {
  const std::filesystem::path folder = options.output;
  const std::string calibration =
      MakeCalibrationYaml(run.comparison.geometric(), run.base, run.recording.source, zero_offsets);
  const std::string offsets = MakeXacroOffsets(urdf);
  WriteFile(folder / (session.project.urdf.stem().string() + "_calibrated.urdf"), urdf.text);
  WriteFile(folder / "calibration.yaml", calibration);
  WriteFile(folder / "offsets.xacro", offsets);
}

}  // namespace

int RunCalibration(const CalibrateOptions& options, CalibrationRun* run_out) {
  const bool quiet = options.common.quiet;
  const Session session = OpenSession(options.project, options.recording);
  CalibrationRun run = Calculate(session, options);
  const CalibrationResult& result = run.comparison.geometric();
  const bool converged = result.termination == Termination::kConverged;

  const std::filesystem::path folder = options.output;
  if (converged) {
    const ZeroOffsets zero_offsets =
        options.zero_offsets == "encoder" ? ZeroOffsets::kEncoder : ZeroOffsets::kOrigin;
    const CalibratedUrdf urdf = MakeCalibratedUrdf(
        ReadFile(session.project.urdf), session.project.urdf.string(), result, zero_offsets);
    run.warnings.insert(run.warnings.end(), urdf.warnings.begin(), urdf.warnings.end());
    WriteResults(options, session, run, urdf, zero_offsets);
  } else {
    run.warnings.push_back("not converged (" + result.message + "): no calibrated URDF is written");
  }
  const std::string summary = MakeSummaryJson(run);
  WriteFile(folder / "summary.json", summary);
  if (!options.common.json_file.empty()) WriteFile(options.common.json_file, summary);

  Print(quiet, DescribeRun(run));
  if (converged) Print(quiet, fmt::format("\nWritten to {}\n", folder.string()));
  PrintWarnings(quiet, run.warnings);
  if (run_out != nullptr) *run_out = std::move(run);
  return converged ? kFine : kNotConverged;
}

void AddCalibrate(CLI::App& app, Action& action) {
  auto options = std::make_shared<CalibrateOptions>();
  CLI::App* command = app.add_subcommand(
      "calibrate", "Estimate the robot's errors from a recording; write the calibrated URDF");
  command->add_option("project", options->project, "Project file (YAML)")->required();
  command->add_option("--recording", options->recording, "Table of static postures (CSV)")
      ->required();
  command->add_option("-o,--output", options->output, "Folder for the results")->required();
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
      "Writes ROBOT_calibrated.urdf, calibration.yaml, offsets.xacro and summary.json.\n"
      "Example: elastocal calibrate project.yaml --recording postures.csv --kfold 10 -o out");
  command->callback(
      [&action, options] { action = [options] { return RunCalibration(*options); }; });
}

}  // namespace elastocal::cli
