// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/check_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/calibration/prediction.hpp"
#include "elastocal/mistakes/check_alternatives.hpp"
#include "elastocal/mistakes/read_accepting.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/pipeline/calibrated_robot.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/check_json.hpp"
#include "elastocal/pipeline/earlier_calibration.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/tables/json_text.hpp"
#include "elastocal/validation/deployment.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

/// Distances between measured and predicted positions by the fit, postures x markers, m.
Eigen::MatrixXd DistancesBy(const EarlierFit& fit, const CalibrationOptions& options) {
  return Predict(fit.estimate.model, fit.estimate.delta, fit.measured.calibration, options)
      .distances;
}

/// Names accused joints whose known play is as large as their apparent change: the direction of
/// approach may differ from that in the log.
std::vector<std::string> DescribePlay(const JointCheck& check, const StoredCalibration& earlier) {
  std::vector<JointSuspect> accused = check.moved;
  std::ranges::copy_if(check.joints, std::back_inserter(accused), [&](const JointSuspect& joint) {
    return std::ranges::count(check.suspects, joint.joint) > 0;
  });
  std::vector<std::string> texts;
  for (const JointSuspect& joint : accused) {
    const bool angle = !joint.zero_is_length;
    const std::string zero = joint.joint + (angle ? ".theta" : ".r");
    for (const char* cause : {"backlash", "hysteresis"}) {
      const auto half = earlier.joint_errors.find(joint.joint + "." + cause);
      if (half == earlier.joint_errors.end()) continue;
      const double play = 2.0 * std::abs(half->second);
      for (const ParameterChange& change : joint.changes) {
        if (change.name != zero) continue;
        if (std::abs(change.value) > play + 2.0 * change.sd) continue;
        texts.push_back(fmt::format(
            "{}: the calibration has {} there, {:.2g} {} from one side to the other; what seems to "
            "have changed may be the side on which the joint came to rest",
            joint.joint, cause, angle ? play * 180.0 / M_PI : 1e3 * play,
            angle ? "degrees" : "mm"));
      }
    }
  }
  return texts;
}

/// Errors that `estimate` leaves: over all observations, and rms over the markers of each posture.
void MeasureLeft(const EarlierFit& fit, const CalibrationOptions& options, CheckRun& run) {
  const Eigen::MatrixXd distances = DistancesBy(fit, options);
  run.rmse_estimate = ComputeMetrics(distances, SeenMask(fit.measured.calibration)).rmse_3d;
  run.left.setZero(distances.rows());
  for (Eigen::Index i = 0; i < run.left.size(); ++i) {
    double squares = 0.0, count = 0.0;
    for (const double distance : distances.row(i)) {
      if (!std::isfinite(distance)) continue;  // not seen
      squares += distance * distance;
      count += 1.0;
    }
    run.left[i] = std::sqrt(squares / std::max(1.0, count));
  }
}

}  // namespace

CheckRun CheckCalibration(const Project& given, const std::filesystem::path& calibration_file,
                          const std::filesystem::path& recording, const CheckOptions& options) {
  CheckHasMarkers(given);
  CheckRun run;
  run.calibration_file = FindCalibrationFiles(calibration_file).calibration.string();
  Project project = given;
  auto [measured, undone] = ReadAccepting(project, {recording}, options.accept, ReadFor::kAnyUse);
  for (const std::string& what : undone) run.warnings.push_back(DescribeUndone(what));

  // A fit in which every joint is free to have moved since the calibration.
  EarlierFit fit = FitAfterEarlier(calibration_file, options.days, measured, options.seed,
                                   options.joints, project);
  const Recording& postures = fit.measured.calibration;
  run.expected_error = ExpectedError(fit.robot.model, postures, project.calibration.prior);
  run.left_before = fit.stored.rmse_3d;
  MeasureLeft(fit, project.calibration, run);

  // Fits with the joints as calibrated.
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

  run.estimate = std::move(fit.estimate);
  run.check = std::move(fit.check);
  if (mistakes.empty() && !run.unchanged()) {
    const CheckedCalibration calibration = {
        [&](const Recording& of) { return as_calibrated(fit.robot, of).calibrated; },
        [&](const Measurements& corrected) {
          Project again = given;
          const EarlierFit other = FitAfterEarlier(calibration_file, options.days, corrected,
                                                   options.seed, options.joints, again);
          const double left =
              as_calibrated(other.robot, other.measured.calibration).calibrated.metrics_all.rmse_3d;
          return !other.check.changed() && left <= run.most_left();
        }};
    run.alternatives = FindAlternatives(calibration, postures, measured, project);
  }

  std::ranges::move(DescribeWidened(run.check, run.calibration_file),
                    std::back_inserter(run.warnings));
  std::ranges::move(DescribePlay(run.check, fit.stored), std::back_inserter(run.warnings));
  WarnOfOwnRecording(fit.stored.source, InputFiles(given, {recording}), run.warnings);
  run.warnings.insert(run.warnings.end(), fit.measured.warnings.begin(),
                      fit.measured.warnings.end());
  run.recording = std::move(fit.measured.calibration);
  return run;
}

bool CheckRun::plausible() const {
  return !(transfer.calibrated.metrics_all.rmse_3d > kImplausible * expected_error);
}

double CheckRun::most_left() const {
  constexpr double kMore = 4.0;
  // Share of the error of an uncalibrated robot below which an error is small.
  constexpr double kMatters = 0.02;
  return left_before > 0.0 ? std::max(kMore * left_before, kMatters * expected_error)
                           : std::numeric_limits<double>::infinity();
}

bool CheckRun::recording_explains() const {
  const bool by_one_joint = check.moved.size() == 1 && check.suspects.empty() && explained();
  return !alternatives.empty() && !by_one_joint;
}

bool CheckRun::changed_beyond_telling() const {
  return !check.changed() && transfer.calibrated.metrics_all.rmse_3d > most_left();
}

bool CheckRun::unchanged() const {
  return converged() && mistakes.empty() && !check.changed() && plausible() && explained() &&
         !changed_beyond_telling();
}

std::string CheckStatus(const CheckRun& run) {
  if (!run.converged()) return "not converged";
  if (!run.mistakes.empty()) return "recording wrong";
  if (run.recording_explains()) return "recording wrong";
  if (!run.check.changed() && !run.plausible()) return "implausible";
  if (!run.explained()) return "unexplained";
  if (!run.check.moved.empty()) return "moved";
  return run.unchanged() ? "unchanged" : "changed";
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
  if (run.left_before > 0.0) json["left_by_calibration_mm"] = 1e3 * run.left_before;
  json["left_by_posture_mm"] = Json::array();
  for (const double left : run.left) json["left_by_posture_mm"].push_back(1e3 * left);
  AddJointCheck(run.check, json);
  json["expected_error_mm"] = 1e3 * run.expected_error;
  json["mistakes"] = run.mistakes;
  json["alternatives"] = run.alternatives;
  json["warnings"] = run.warnings;
  return JsonText(json);
}

}  // namespace elastocal
