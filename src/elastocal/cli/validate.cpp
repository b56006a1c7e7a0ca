#include <algorithm>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/report_page.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/output_files.hpp"
#include "elastocal/io/summary.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/validation/transfer.hpp"

namespace elastocal::cli {
namespace {

struct ValidateOptions {
  CommonOptions common;
  std::string project, calibration, recording;
  std::string output;  ///< folder; empty: none
};

/// A calibration means something only for the robot description that it was made with.
void CheckRobot(const StoredCalibration& stored, const Session& session, const std::string& file) {
  if (stored.nominal == NominalFingerprint(session.model)) return;
  throw InputError(file + ": made for robot '" + stored.robot +
                   "' with other nominal geometry than " + session.project.urdf.string() +
                   "; expected the URDF that was calibrated, not the calibrated one");
}

using Json = nlohmann::ordered_json;

std::string Table(const TransferValidation& validation) {
  TextTable table({"joints (waist and markers refitted)", "RMSE 3-D mm", "RMSE coordinate mm",
                   "max mm", "with outliers mm"});
  const auto millimetres = [](double value) { return fmt::format("{:.3f}", 1e3 * value); };
  for (const auto& [name, refit] : {std::pair{"uncalibrated", &validation.uncalibrated},
                                    std::pair{"calibrated", &validation.calibrated}}) {
    table.Add({name, millimetres(refit->metrics.rmse_3d),
               millimetres(refit->metrics.rmse_coordinate), millimetres(refit->metrics.maximum),
               millimetres(refit->metrics_all.rmse_3d)});
  }
  return table.Render();
}

Json MakeJson(const Session& session, const TransferValidation& validation,
              const std::string& status, const std::string& calibration) {
  Json json;
  json["status"] = status;
  json["calibration"] = calibration;
  json["recording"] = session.recording.source;
  json["postures"] = session.recording.posture_count();
  json["markers"] = session.recording.marker_count();
  for (const auto& [name, refit] : {std::pair{"uncalibrated", &validation.uncalibrated},
                                    std::pair{"calibrated", &validation.calibrated}}) {
    json["rmse_3d_mm"][name] = 1e3 * refit->metrics.rmse_3d;
    json["rmse_coordinate_mm"][name] = 1e3 * refit->metrics.rmse_coordinate;
    json["max_mm"][name] = 1e3 * refit->metrics.maximum;
    json["rmse_3d_mm_with_outliers"][name] = 1e3 * refit->metrics_all.rmse_3d;
  }
  json["outliers"] = Json::array();
  for (const Outlier& outlier : validation.calibrated.result.outliers) {
    json["outliers"].push_back({{"posture", outlier.posture},
                                {"marker", session.recording.marker_names[outlier.marker]},
                                {"residual_mm", 1e3 * outlier.residual}});
  }
  json["warnings"] = session.warnings;
  return json;
}

std::vector<std::filesystem::path> OutputFiles(const ValidateOptions& options) {
  std::vector<std::filesystem::path> files = {options.common.json_file};
  if (options.output.empty()) return files;
  for (const char* name : {"validation.json", "runs.json", "report.html"}) {
    files.push_back(std::filesystem::path(options.output) / name);
  }
  return files;
}

/// The results where they are wanted, and the report of the folder.
void Write(const ValidateOptions& options, const Session& session, const std::string& json) {
  if (!options.common.json_file.empty()) WriteFile(options.common.json_file, json);
  if (options.output.empty()) return;
  const std::filesystem::path folder = options.output;
  std::vector<InputRecord> inputs =
      StartRecordingInputs(session.project, {options.recording, options.calibration}).get();
  WriteFiles(
      {{folder / "validation.json", json},
       {folder / "runs.json", RunsJson(folder, "validate", options.common, std::move(inputs))}});
  WriteFolderReport(folder, options.common.Silent());
}

int Validate(const ValidateOptions& options) {
  const StoredCalibration stored = ReadCalibration(options.calibration);
  Session session = OpenSession(options.project, {options.recording}, options.common.seed);
  CheckRobot(stored, session, options.calibration);
  CheckOutputs(OutputFiles(options),
               {options.project, session.project.urdf, options.recording, options.calibration});
  const TransferValidation validation =
      ValidateTransfer(session.model, session.recording, session.base, session.project.calibration,
                       stored.joint_errors);
  const std::vector<Outlier>& outliers = validation.calibrated.result.outliers;
  const auto seen = SeenMask(session.recording).count();
  if (20 * static_cast<Eigen::Index>(outliers.size()) > seen) {
    session.warnings.push_back(
        fmt::format("{} of {} observations are outliers of the calibrated "
                    "model; see the figures with outliers",
                    outliers.size(), seen));
  }
  const bool converged = validation.calibrated.result.termination == Termination::kConverged &&
                         validation.uncalibrated.result.termination == Termination::kConverged;
  const bool better =
      validation.calibrated.metrics_all.rmse_3d < validation.uncalibrated.metrics_all.rmse_3d;

  const bool quiet = options.common.Silent();
  Print(quiet, fmt::format("{} with the calibration from {}\n{} postures, {} markers\n\n",
                           session.recording.source, stored.recording,
                           session.recording.posture_count(), session.recording.marker_count()) +
                   Table(validation));
  for (std::size_t i = 0; i < std::min<std::size_t>(10, outliers.size()); ++i) {
    Print(quiet, fmt::format("  outlier {}: off by {:.3f} mm\n",
                             DescribeObservation(session.recording, outliers[i].posture,
                                                 outliers[i].marker),
                             1e3 * outliers[i].residual));
  }
  PrintWarnings(session.warnings);
  if (!converged) spdlog::error("the fit of waist and markers has not converged");
  if (!better) spdlog::error("calibrated is no better than uncalibrated here: do not deploy");
  const std::string status = !converged ? "not converged" : better ? "better" : "not better";
  Write(options, session,
        MakeJson(session, validation, status, options.calibration).dump(2) + "\n");
  return converged && better ? kFine : kNotConverged;
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
  command
      ->add_option("--recording", options->recording,
                   "Table of static postures (CSV), or a folder with experiment.yaml")
      ->required();
  command->add_option("-o,--output", options->output,
                      "Folder for validation.json and a report with it: that of the calibration");
  AddCommonOptions(*command, options->common);
  command->footer(
      "Example: elastocal validate project.yaml --calibration out/calibration.yaml "
      "--recording other_day.csv -o out");
  command->callback([&action, options] { action = [options] { return Validate(*options); }; });
}

}  // namespace elastocal::cli
