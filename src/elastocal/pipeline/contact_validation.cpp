// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/contact_validation.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/contact_file.hpp"
#include "elastocal/io/observation_table.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/mistakes/observed_corrections.hpp"
#include "elastocal/mistakes/observed_mistakes.hpp"
#include "elastocal/observation/exchanged_sessions.hpp"
#include "elastocal/observation/standing_robot.hpp"
#include "elastocal/pipeline/calibrated_robot.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/contact_earlier.hpp"
#include "elastocal/pipeline/contact_figures.hpp"
#include "elastocal/pipeline/contact_json.hpp"
#include "elastocal/pipeline/leave_out_touches.hpp"
#include "elastocal/pipeline/off_alone.hpp"
#include "elastocal/tables/json_text.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

std::vector<Eigen::VectorXd> PredictStored(const ContactValidation& run,
                                           const Observations& observations,
                                           const StoredContact& stored,
                                           const Eigen::VectorXd& errors) {
  ObservedValues values{errors, {}, {}};
  for (const Quantity& quantity : run.model.setup.quantities) {
    const auto found = stored.quantities.find(quantity.name);
    values.quantities.push_back(
        found != stored.quantities.end()
            ? found->second
            : QuantityValue{quantity.origin, Eigen::VectorXd::Zero(quantity.size())});
  }
  return run.surroundings_refitted
             ? LeftAfterRegistration(run.model, observations, values, stored.spread)
             : LeftOf(run.model, observations, values);
}

/// Compares the errors with the noise that the calibration left, by which an unchanged robot should
/// err. Errors that are far larger are a warning, and an objection where they matter. Rows of the
/// tables that are off alone are named.
void CompareWithCalibration(const Spread& spread, const PredictObservations& predict,
                            ContactValidation& run) {
  constexpr double kAsBefore = 2.0, kLarger = 4.0, kFarLarger = 10.0, kMatters = 0.1;
  const char* cause =
      run.surroundings_refitted
          ? "has the robot, or what is measured on it, changed, or is the table wrong?"
          : "were trackers, cameras or tables moved since? --refit table registers them anew";
  for (const RowErrors& row : run.calibrated.rows) {
    const double noise = NoiseOf(run.model, row, spread);
    if (row.unit == SourceUnit::kNone || !(row.rms > kLarger * noise)) continue;
    const ShownUnit unit = ShownUnitOf(row.unit);
    const OffAlone alone =
        FindOffAlone(run.model, run.observations, row, kAsBefore * noise, predict);
    const std::string why =
        alone.observations.empty()
            ? cause
            : fmt::format("without {} it is {:.2g} {}: {}",
                          PlacesOf(alone.observations, run.observations),
                          unit.factor * alone.rms_of_others, unit.name,
                          run.model.IsPlate(row.instrument) ? "was there contact?"
                                                            : "was it measured there?");
    const std::string text =
        fmt::format("{} of {} off by {:.3g} {}, where the calibration left {:.2g} ({})", row.row,
                    run.model.instrument(row.instrument).name, unit.factor * row.rms, unit.name,
                    unit.factor * noise, why);
    const bool grave =
        row.rms > kFarLarger * noise && row.rms > kMatters * LargestError(run.model, row.unit);
    (grave ? run.objections : run.warnings).push_back(text);
  }
}

/// Names rows that belong to another session than stated, by a robot as calibrated, where its
/// errors are larger than they should be.
void NameExchangedSessions(const std::filesystem::path& calibration, const Project& project,
                           ContactValidation& run) {
  if (run.observations.effects.empty()) return;
  ObservedRobot known = run.model;
  try {
    known.earlier =
        MakeEarlierOfContacts(ReadEarlierContacts(calibration, project), known, project, 1.0);
  } catch (const InputError&) {  // without its covariance: this is for information
    return;
  }
  const std::vector<OtherSession> found = FindExchangedSessions(known, run.observations);
  if (found.empty()) return;
  auto& said = run.objections.empty() ? run.warnings : run.objections;
  said.insert(said.begin(), DescribeOtherSessions(found, run.observations));
}

/// Names the mistakes in the tables that explain the objections.
void NameMistakesOf(ContactValidation& run) {
  if (run.objections.empty()) return;
  const std::vector<std::string> mistakes = FindObservedMistakes(run.model, run.observations);
  if (mistakes.empty()) return;
  run.objections.insert(run.objections.begin(), fmt::format("{}", fmt::join(mistakes, "; or ")));
}

}  // namespace

ContactValidation ValidateContacts(const Project& project, const std::filesystem::path& calibration,
                                   const std::vector<std::filesystem::path>& recordings,
                                   bool refit_table, const std::vector<std::string>& accept) {
  const std::filesystem::path file = FindCalibrationFiles(calibration).calibration;
  const StoredCalibration stored = ReadCalibration(file);
  const StoredContacts contacts = ReadContacts(file, project);
  ObservationTables tables = ReadObservationTables(recordings, project, &contacts.feet);
  ContactValidation run;
  run.calibration_file = file.string();
  run.calibration_fingerprint = stored.fingerprint;
  for (const std::filesystem::path& table : recordings) {
    run.recording += (run.recording.empty() ? "" : ", ") + table.string();
  }
  run.surroundings_refitted = refit_table;
  run.observations = std::move(tables.observations);
  run.warnings = std::move(tables.warnings);
  WarnOfOwnRecording(file, recordings, run.warnings);
  run.model = MakeStoredRobot(stored, project, tables.setup);
  for (const std::string& what : CorrectObservations(accept, run.model, run.observations)) {
    run.warnings.push_back("corrected on request: " + what);
  }
  const std::vector<Eigen::VectorXd> before =
      PredictStored(run, run.observations, contacts.uncalibrated,
                    Eigen::VectorXd::Zero(run.model.robot.parameter_count()));
  const Eigen::VectorXd errors = ErrorsByName(run.model.robot, stored.joint_errors);
  const auto predict = [&](const Observations& observations) {
    return PredictStored(run, observations, contacts.calibrated, errors);
  };
  const std::vector<Eigen::VectorXd> after = predict(run.observations);
  run.uncalibrated = MakeFigures(run.model, run.observations, before);
  run.calibrated = MakeFigures(run.model, run.observations, after);
  run.gain_in_sds =
      GainInSds(run.model, run.observations, before, after, contacts.calibrated.spread);
  for (const std::string& row : WorseRows(run.model, run.uncalibrated, run.calibrated)) {
    run.objections.push_back("the calibrated robot is worse here: " + row);
  }
  // Without registration, a displaced table or tracker tells nothing about the robot.
  if (run.surroundings_refitted) {
    for (const std::string& row : LargeErrors(run.model, run.calibrated)) {
      run.objections.push_back("no calibrated robot errs like this: " + row);
    }
  }
  const std::size_t before_comparison = run.warnings.size();
  CompareWithCalibration(contacts.calibrated.spread, predict, run);
  if (!(run.gain_in_sds > 0.0)) {
    run.objections.emplace_back("calibrated is no better than uncalibrated here");
  }
  NameMistakesOf(run);
  if (!run.objections.empty() || run.warnings.size() > before_comparison) {
    NameExchangedSessions(calibration, project, run);
  }
  return run;
}

std::string MakeContactValidationJson(const ContactValidation& run) {
  nlohmann::ordered_json json;
  json["status"] = run.better() ? "better" : "not better";
  json["objections"] = run.objections;
  json["calibration"] = run.calibration_file;
  json["calibration_fingerprint"] = run.calibration_fingerprint;
  json["recording"] = run.recording;
  json["postures"] = run.observations.posture_count();
  json["contact"] = FiguresJson(run.model, run.calibrated);
  json["contact"]["table"] = run.surroundings_refitted ? "refitted" : "as calibrated";
  json["contact"]["uncalibrated"] = FiguresJson(run.model, run.uncalibrated);
  json["contact"]["gain_in_sds"] = run.gain_in_sds;
  json["warnings"] = run.warnings;
  return JsonText(json);
}

}  // namespace elastocal
