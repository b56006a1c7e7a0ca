// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "elastocal/cli/command_result.hpp"
#include "elastocal/cli/commands.hpp"
#include "elastocal/cli/contact_commands.hpp"
#include "elastocal/cli/figures.hpp"
#include "elastocal/cli/option_checks.hpp"
#include "elastocal/cli/report_page.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/io/marker_places_file.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/pipeline/validate_calibration.hpp"
#include "elastocal/recorded/measurements.hpp"
#include "elastocal/robot/parameters.hpp"

namespace elastocal::cli {
namespace {

struct ValidateOptions {
  CommonOptions common;
  std::string project, calibration;
  std::vector<std::string> recording;
  std::string output;  ///< path of the folder; empty: none
  bool frozen = false;
  std::string refit;  ///< "table"; empty: nothing
  std::vector<std::string> accept;
  std::string marker_places;  ///< table of measured marker positions; empty: none
};

std::string Table(const ValidationRun& run) {
  TextTable table({run.frozen ? "joints (nothing fitted)" : "joints (waist and markers refitted)",
                   "RMSE 3-D mm", "RMSE coordinate mm", "max mm", "with outliers mm"});
  const auto millimetres = [](double value) { return fmt::format("{:.3f}", 1e3 * value); };
  std::vector<std::pair<const char*, const Refit*>> refits = {
      {"uncalibrated", &run.transfer.uncalibrated}, {"calibrated", &run.transfer.calibrated}};
  if (run.urdf) refits.emplace_back("as the calibrated URDF has it", &*run.urdf);
  for (const auto& [name, refit] : refits) {
    table.Add({name, millimetres(refit->metrics.rmse_3d),
               millimetres(refit->metrics.rmse_coordinate), millimetres(refit->metrics.maximum),
               millimetres(refit->metrics_all.rmse_3d)});
  }
  return table.Render();
}

bool ModelGivesWay(const ErrorModel& model) {
  return std::any_of(model.parameters.begin(), model.parameters.end(),
                     [](const Parameter& one) { return IsElastic(one.kind); });
}

/// The verdict in one sentence.
std::string VerdictText(const ValidationRun& run) {
  if (!run.mistakes.empty()) {
    return "Verdict: the recording has a mistake or contradicts the calibration; see below.\n\n";
  }
  if (!run.converged() || !run.plausible() || !run.better()) {
    return "Verdict: do not deploy; see below.\n\n";
  }
  if (run.urdf_worse()) return "Verdict: do not deploy the URDF alone; see below.\n\n";
  const auto error = [](const Refit& refit) { return Millimetres(refit.metrics_all.rmse_3d, 3); };
  const char* word = run.own_recording      ? "the recording is the calibration's own. From"
                     : run.predicted == 0.0 ? "from"
                     : run.as_predicted()   ? "as calibrated. From"
                                            : "worse than calibrated. From";
  const std::string judged =
      run.not_judged.empty()
          ? ""
          : fmt::format("not all trials can be judged ({} cannot, see below). The others: ",
                        run.not_judged.size());
  std::string text =
      fmt::format("Verdict: {}{} {} to {} mm{}", judged, word, error(run.transfer.uncalibrated),
                  error(run.urdf ? *run.urdf : run.transfer.calibrated),
                  run.urdf ? " by the URDF alone" : ", nothing fitted");
  if (run.predicted > 0.0) {
    text += fmt::format(" (predicted: {} mm)", Millimetres(run.predicted, 3));
  }
  if (run.urdf && ModelGivesWay(run.transfer.calibrated.result.model)) {
    text += fmt::format(", {} mm with compensation of elasticity", error(run.transfer.calibrated));
  }
  return text + ".\n\n";
}

/// Text on the agreement of measured marker positions; empty where none were given.
std::string PlacesText(const ValidationRun& run) {
  if (run.places.empty()) return "";
  TextTable table({"measured place", "distance mm", "in standard deviations"});
  for (const PlaceResidual& place : run.places) {
    table.Add({place.marker, fmt::format("{:.2f}", 1e3 * place.distance),
               fmt::format("{:.1f}", place.in_sds())});
  }
  return "\nThe refitted markers and their measured places (1 standard deviation is expected)\n" +
         table.Render();
}

std::string RunText(const ValidationRun& run) {
  std::string text = VerdictText(run) +
                     fmt::format("{} with the calibration from {}\n{} postures, {} markers\n\n",
                                 run.recording.source, run.calibration.recording,
                                 run.recording.posture_count(), run.recording.marker_count()) +
                     Table(run);
  const std::vector<Outlier>& outliers = run.transfer.calibrated.result.outliers;
  for (std::size_t i = 0; i < std::min<std::size_t>(10, outliers.size()); ++i) {
    text += fmt::format("  outlier {}: off by {:.3f} mm\n",
                        DescribeObservation(run.recording, outliers[i].posture, outliers[i].marker),
                        1e3 * outliers[i].residual);
  }
  return text + PlacesText(run);
}

std::vector<std::string> ErrorsOf(const ValidationRun& run) {
  std::vector<std::string> errors = run.mistakes;
  errors.insert(errors.end(), run.not_judged.begin(), run.not_judged.end());
  if (!run.mistakes.empty()) return errors;  // the mistakes explain the errors
  if (!run.converged()) errors.emplace_back("the fit of waist and markers has not converged");
  if (!run.plausible()) {
    errors.push_back(fmt::format(
        "the calibrated robot errs by {:.3g} mm on {}, where one that was never calibrated should "
        "err by some {:.2g} mm: recording, project and calibration do not belong together",
        1e3 * run.transfer.calibrated.metrics_all.rmse_3d, run.recording.source,
        1e3 * run.expected_error));
  }
  if (!run.better()) {
    errors.emplace_back("calibrated is no better than uncalibrated here: do not deploy");
  } else if (run.urdf_worse()) {
    errors.push_back(fmt::format(
        "the calibrated URDF alone is worse than the uncalibrated one here: {:.3g} mm against "
        "{:.3g} mm; only a controller that compensates what a URDF cannot hold makes the robot "
        "better ({:.3g} mm)",
        1e3 * run.urdf->metrics_all.rmse_3d, 1e3 * run.transfer.uncalibrated.metrics_all.rmse_3d,
        1e3 * run.transfer.calibrated.metrics_all.rmse_3d));
  }
  return errors;
}

CommandResult ValidateByMarkers(const ValidateOptions& options, const Project& project) {
  const ValidationRun run =
      ValidateCalibration(project, options.calibration, options.recording.front(),
                          {.frozen = options.frozen,
                           .seed = options.common.seed,
                           .accept = options.accept,
                           .marker_places = options.marker_places});
  return {.files = {},
          .json = MakeValidationJson(run),
          .text = RunText(run),
          .warnings = run.warnings,
          .errors = ErrorsOf(run),
          .fine = run.converged() && run.better() && !run.urdf_worse() && run.plausible() &&
                  run.mistakes.empty() && run.not_judged.empty()};
}

void RefuseOtherKindsOptions(const ValidateOptions& options, const Project& project) {
  if (project.contact) {
    if (options.frozen) throw InputError("--frozen is about markers; touches have --refit table");
    if (!options.marker_places.empty()) {
      throw InputError(
          "--marker-places is about markers in recordings without contact and "
          "instruments");
    }
    return;
  }
  if (!options.refit.empty()) throw InputError("--refit table is about touches of a table");
  if (options.recording.size() > 1) {
    throw InputError("--recording: " + std::to_string(options.recording.size()) +
                     " files; one recording was expected, because the project has neither contact "
                     "nor instruments");
  }
}

int Validate(const ValidateOptions& options) {
  const bool quiet = options.common.Silent();
  const std::filesystem::path folder = options.output;
  const std::vector<std::filesystem::path> recordings(options.recording.begin(),
                                                      options.recording.end());
  const Project project = ReadProject(options.project);
  RefuseOtherKindsOptions(options, project);
  std::vector<std::filesystem::path> inputs = InputFiles(project, recordings);
  inputs.push_back(FindCalibrationFiles(options.calibration).calibration);
  if (!options.marker_places.empty()) {
    ReadMarkerPlaces(options.marker_places, project);  // refused before long computations
    inputs.emplace_back(options.marker_places);
  }
  OutputSet outputs;
  outputs.Protect(inputs);
  if (!folder.empty()) DeclareResults(folder, {"validation.json"}, outputs);
  DeclareJson(options.common.json_file, outputs);
  outputs.Prepare();

  const CommandResult result = project.contact
                                   ? ValidateByContacts(project, options.calibration, recordings,
                                                        options.refit == "table", options.accept)
                                   : ValidateByMarkers(options, project);
  outputs.Set(options.common.json_file, result.json);
  std::string no_report;
  if (!folder.empty()) {
    no_report =
        SetResults(folder, {{"validation.json", result.json}},
                   MakeRunRecord("validate", options.common, RecordInputs(inputs)), outputs);
  }
  outputs.Publish();

  result.Print(options.common);
  if (!folder.empty()) PrintReportPlace(folder, no_report, quiet);
  return result.exit_code();
}

}  // namespace

void AddValidate(CLI::App& app, Action& action) {
  auto options = std::make_shared<ValidateOptions>();
  CLI::App* command = app.add_subcommand("validate",
                                         "Apply a calibration to another recording: waist and "
                                         "markers refitted (or nothing, --frozen)");
  AddAppliedCalibration(*command, options->project, options->calibration, options->recording, true);
  command
      ->add_option("-o,--output", options->output,
                   "Folder for validation.json and a report with it: that of the calibration")
      ->check(IsNamed)
      ->type_name("DIR");
  command->add_flag("--frozen", options->frozen,
                    "Fit nothing: waist and markers as in the calibration (cameras and markers "
                    "must not have been moved)");
  command
      ->add_option("--refit", options->refit,
                   "Of tables of observations: what is registered anew, each posture by the others "
                   "of the file: "
                   "table (with it trackers, walls, wires and cameras in the room)")
      ->transform(OneOf({"table"}))
      ->type_name("WHAT");
  AddAcceptOption(*command, options->accept);
  command
      ->add_option("--marker-places", options->marker_places,
                   "Where markers are on their links, as measured there (docs/formats.md): beside "
                   "them waist and markers are refitted")
      ->type_name("FILE");
  AddCommonOptions(*command, options->common);
  command->footer(
      "Example: elastocal validate project.yaml --calibration out "
      "--recording other_day.csv -o out");
  command->callback([&action, options] { action = [options] { return Validate(*options); }; });
}

}  // namespace elastocal::cli
