#include <cmath>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/output_files.hpp"
#include "elastocal/io/summary.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ValidateOptions {
  CommonOptions common;
  std::string project, calibration, recording;
};

/// A model's joints fixed, waist and markers refitted.
struct Refit {
  CalibrationResult result;
  ErrorMetrics metrics;
};

Refit RefitAndMeasure(const Session& session, const std::map<std::string, double>& joint_errors,
                      const ObservationMask* mask) {
  Refit refit;
  refit.result = RefitExternals(session.model, session.recording, session.base,
                                session.project.calibration, joint_errors, mask);
  refit.metrics = ComputeMetrics(
      ResidualNorms(refit.result.model, session.recording, refit.result.delta), refit.result.used);
  return refit;
}

/// Errors of joints that the robot does not have are a sign of the wrong file.
void CheckNames(const StoredCalibration& stored, const Project& project, const std::string& file) {
  const ErrorModel all = MakeErrorModel(project.tree, project.markers, project.placement);
  for (const auto& [name, value] : stored.joint_errors) {
    if (value == 0.0) continue;
    try {
      FindParameter(all.parameters, name);
    } catch (const InputError& error) {
      throw InputError(file + ": " + error.what() + " in project " + project.file.string());
    }
  }
}

int Validate(const ValidateOptions& options) {
  const StoredCalibration stored = ReadCalibration(options.calibration);
  const Session session = OpenSession(options.project, options.recording);
  CheckNames(stored, session.project, options.calibration);
  // The calibrated model decides what is an outlier, so that both are judged on the same data.
  const Refit calibrated = RefitAndMeasure(session, stored.joint_errors, nullptr);
  const Refit nominal = RefitAndMeasure(session, {}, &calibrated.result.used);

  const bool quiet = options.common.quiet;
  const auto millimetres = [](double value) { return fmt::format("{:.3f}", 1e3 * value); };
  TextTable table(
      {"model (waist and markers refitted)", "RMSE 3-D mm", "RMSE coordinate mm", "max mm"});
  Json rmse_3d, rmse_coordinate, maximum;
  for (const auto& [name, refit] :
       {std::pair{"uncalibrated", &nominal}, std::pair{"calibrated", &calibrated}}) {
    const ErrorMetrics& metrics = refit->metrics;
    table.Add({name, millimetres(metrics.rmse_3d), millimetres(metrics.rmse_coordinate),
               millimetres(metrics.maximum)});
    rmse_3d[name] = 1e3 * metrics.rmse_3d;
    rmse_coordinate[name] = 1e3 * metrics.rmse_coordinate;
    maximum[name] = 1e3 * metrics.maximum;
  }
  Print(quiet, fmt::format("{} with the calibration from {}\n{} postures, {} markers\n\n",
                           session.recording.source, stored.recording,
                           session.recording.posture_count(), session.recording.marker_count()));
  Print(quiet, table.Render());
  Json outliers = Json::array();
  for (const Outlier& outlier : calibrated.result.outliers) {
    const std::string where =
        DescribeObservation(session.recording, outlier.posture, outlier.marker);
    Print(quiet, fmt::format("  outlier {}: off by {:.3f} mm\n", where, 1e3 * outlier.residual));
    outliers.push_back({{"posture", outlier.posture},
                        {"marker", session.recording.marker_names[outlier.marker]},
                        {"residual_mm", 1e3 * outlier.residual}});
  }
  PrintWarnings(quiet, session.warnings);
  const bool converged = calibrated.result.termination == Termination::kConverged &&
                         nominal.result.termination == Termination::kConverged;
  if (!options.common.json_file.empty()) {
    const Json json = {{"status", converged ? "converged" : "not converged"},
                       {"calibration", options.calibration},
                       {"recording", session.recording.source},
                       {"postures", session.recording.posture_count()},
                       {"markers", session.recording.marker_count()},
                       {"rmse_3d_mm", rmse_3d},
                       {"rmse_coordinate_mm", rmse_coordinate},
                       {"max_mm", maximum},
                       {"outliers", outliers},
                       {"warnings", session.warnings}};
    WriteFile(options.common.json_file, json.dump(2) + "\n");
  }
  return converged ? kFine : kNotConverged;
}

}  // namespace

void AddValidate(CLI::App& app, Action& action) {
  auto options = std::make_shared<ValidateOptions>();
  CLI::App* command = app.add_subcommand(
      "validate",
      "Apply a calibration to another recording: waist and markers refitted, joints not");
  command->add_option("project", options->project, "Project file (YAML)")->required();
  command->add_option("--calibration", options->calibration, "calibration.yaml of a calibration")
      ->required();
  command->add_option("--recording", options->recording, "Table of static postures (CSV)")
      ->required();
  AddCommonOptions(*command, options->common);
  command->footer(
      "Example: elastocal validate project.yaml --calibration out/calibration.yaml "
      "--recording other_day.csv");
  command->callback([&action, options] { action = [options] { return Validate(*options); }; });
}

}  // namespace elastocal::cli
