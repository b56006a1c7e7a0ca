// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/check_calibration.hpp"

#include <utility>

#include <nlohmann/json.hpp>

#include "elastocal/calibration/prediction.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/earlier_calibration.hpp"
#include "elastocal/pipeline/recorded_model.hpp"
#include "elastocal/pipeline/recording_mistakes.hpp"
#include "elastocal/validation/deployment.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

Json SuspectJson(const JointSuspect& suspect) {
  Json json;
  json["joint"] = suspect.joint;
  json["told"] = suspect.told();
  json["F"] = suspect.told() ? Json(suspect.test.statistic) : Json(nullptr);
  json["p"] = suspect.test.p;
  json["p_adjusted"] = suspect.p_adjusted;
  json["probability"] = suspect.probability;
  json["changes"] = Json::array();
  for (const ParameterChange& change : suspect.changes) {
    json["changes"].push_back({{"name", change.name},
                               {"unit", UnitName(change.unit)},
                               {"change", change.value},
                               {"sd", change.sd}});
  }
  return json;
}

}  // namespace

CheckRun CheckCalibration(const Project& given, const std::filesystem::path& calibration,
                          const std::filesystem::path& recording, const CheckOptions& options) {
  CheckHasMarkers(given);
  CheckRun run;
  run.calibration_file = FindCalibrationFiles(calibration).calibration.string();
  Project project = given;
  Measurements measured = ReadMeasurements(project, {recording}, ReadFor::kAnyUse);
  for (const std::string& what : AcceptMistakes(project, options.accept, measured)) {
    run.warnings.push_back(DescribeUndone(what));
  }

  // Every joint free to have moved since the calibration.
  EarlierFit fit =
      FitAfterEarlier(calibration, options.days, measured, options.seed, options.joints, project);
  const Recording& postures = fit.measured.calibration;
  run.expected_error = ExpectedError(fit.robot.model, postures, project.calibration.prior);
  const auto seen = SeenMask(postures);
  run.rmse_estimate =
      ComputeMetrics(
          Predict(fit.estimate.model, fit.estimate.delta, postures, project.calibration).distances,
          seen)
          .rmse_3d;

  // The joints as calibrated.
  const auto as_calibrated = [&](const RecordedModel& robot, const Recording& of) {
    return ValidateTransfer(robot.model, of, robot.base, project.calibration,
                            fit.stored.joint_errors);
  };
  run.transfer = as_calibrated(fit.robot, postures);
  const std::vector<RecordingMistake> mistakes =
      FindMistakesBy(project, options.seed, measured, run.transfer.calibrated.metrics_all.rmse_3d,
                     [&](const RecordedModel& robot, const Recording& corrected) {
                       return as_calibrated(robot, corrected).calibrated.metrics_all.rmse_3d;
                     });
  for (const RecordingMistake& mistake : mistakes) {
    run.mistakes.push_back(DescribeMistake(mistake));
  }

  run.warnings.insert(run.warnings.end(), fit.measured.warnings.begin(),
                      fit.measured.warnings.end());
  run.estimate = std::move(fit.estimate);
  run.check = std::move(fit.check);
  run.recording = std::move(fit.measured.calibration);
  return run;
}

bool CheckRun::plausible() const {
  return !(transfer.calibrated.metrics_all.rmse_3d > kImplausible * expected_error);
}

bool CheckRun::unchanged() const {
  return converged() && mistakes.empty() && !check.changed() && plausible();
}

std::string CheckStatus(const CheckRun& run) {
  if (!run.converged()) return "not converged";
  if (!run.mistakes.empty()) return "recording wrong";
  if (!run.check.moved.empty()) return "moved";
  if (run.check.changed()) return "changed";
  return run.plausible() ? "unchanged" : "implausible";
}

std::string MakeCheckJson(const CheckRun& run) {
  Json json;
  json["status"] = CheckStatus(run);
  json["calibration"] = run.calibration_file;
  json["recording"] = run.recording.source;
  json["postures"] = run.recording.posture_count();
  json["rmse_3d_mm"]["uncalibrated"] = 1e3 * run.transfer.uncalibrated.metrics_all.rmse_3d;
  json["rmse_3d_mm"]["calibrated"] = 1e3 * run.transfer.calibrated.metrics_all.rmse_3d;
  json["rmse_3d_mm"]["updated"] = 1e3 * run.rmse_estimate;
  json["moved"] = Json::array();
  for (const JointSuspect& joint : run.check.moved) json["moved"].push_back(SuspectJson(joint));
  json["suspects"] = run.check.suspects;
  json["not_told"] = run.check.not_told;
  json["joints"] = Json::array();
  for (const JointSuspect& joint : run.check.joints) json["joints"].push_back(SuspectJson(joint));
  json["expected_error_mm"] = 1e3 * run.expected_error;
  json["mistakes"] = run.mistakes;
  json["warnings"] = run.warnings;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace elastocal
