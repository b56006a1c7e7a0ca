// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "elastocal/calibration/turned_axes.hpp"

namespace elastocal {
namespace {

// Share of all observations above which there is an objection.
constexpr double kMostOutliers = 0.25;
constexpr double kManyOutliers = 0.05;     // share above which there is a remark
constexpr double kSuspectedMarker = 0.25;  // share of the observations of a marker
constexpr double kMostWeak = 0.5;          // share of the parameters that may be hardly excited
constexpr double kAsGood = 1.01;           // ratio of errors below which they are as good
constexpr const char* kAdvice =
    " Check the order and signs of the columns, the joints' zeros, and which link each marker is "
    "on.";
constexpr const char* kFurthest = "furthest from nominal: ";

std::string Number(double value, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%.3g %s", value, unit);
  return text;
}

std::string PerCent(Eigen::Index part, Eigen::Index whole) {
  return std::to_string(100 * part / std::max<Eigen::Index>(1, whole)) + " %";
}

void JudgeAxes(const CalibrationResult& result, Verdict& verdict) {
  const std::vector<int> turned = TurnedAxes(result);
  if (turned.empty()) return;
  const std::vector<Joint>& joints = result.model.tree.joints;
  const int before = joints[turned.front()].parent_body - 1;
  std::string names;
  for (const int joint : turned) names += (names.empty() ? "" : ", ") + joints[joint].name;
  std::string check = "Check the sign of its positions";
  if (before >= 0) check += " and of those of " + joints[before].name;
  if (turned.size() > 1) {
    check = "Check the signs of their positions and of those of the joints before them";
  }
  verdict.objections.push_back(
      (turned.size() > 1 ? "the axes of " + names + " seem" : "the axis of " + names + " seems") +
      " to be turned by more than a right angle, which is not an error of a robot. " + check + ".");
}

void JudgeFit(const CalibrationResult& result, const CalibrationOptions& options,
              Verdict& verdict) {
  if (result.termination != Termination::kConverged) {
    verdict.objections.push_back("the fit has not converged: " + result.message);
  } else if (!result.settled) {
    verdict.remarks.emplace_back(
        "noise, prior and outliers have not converged: the standard deviations "
        "are approximate");
  }
  if (result.marker_sd > options.plausible_marker_sd) {
    verdict.objections.push_back(
        "the model does not explain this recording: markers would have "
        "to be measured with a noise of " +
        Number(1e3 * result.marker_sd, "mm") + "." + kAdvice);
  }
  for (const PriorGroup group : {PriorGroup::kAngles, PriorGroup::kLengths}) {
    if (result.prior_scale[group] < MostWidening(group)) continue;
    verdict.objections.push_back(
        std::string("the estimated ") + PriorGroupName(group) +
        " are more than ten times what the prior expects, which is not an error "
        "of a robot." +
        kAdvice);
  }
  JudgeAxes(result, verdict);
}

/// Names the geometric joint parameter that is furthest from nominal in units of its prior.
void NameLargest(const CalibrationResult& result, const Prior& prior, Verdict& verdict) {
  int largest = -1;
  double furthest = 0.0;
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    const Parameter& parameter = result.model.parameters[i];
    const double deviation = std::abs(result.delta[i]) / prior.Of(result.model.tree, parameter);
    const bool of_robot = parameter.joint >= 0 || parameter.linkage >= 0;
    if (!of_robot || IsElastic(parameter.kind) || !(deviation > furthest)) continue;
    furthest = deviation;
    largest = i;
  }
  if (largest < 0) return;
  const Parameter& parameter = result.model.parameters[largest];
  const bool angle = parameter.unit == ParameterUnit::kRadian;
  verdict.remarks.push_back(
      kFurthest + parameter.name + ", " +
      Number(result.delta[largest] * (angle ? 180.0 / M_PI : 1e3), angle ? "deg" : "mm"));
}

void JudgeOutliers(const CalibrationResult& result, const Recording& recording, Verdict& verdict) {
  const ObservationMask seen = SeenMask(recording);
  const ObservationMask out = seen && !result.used;
  if (result.too_many_outliers) {
    verdict.objections.push_back(
        std::to_string(result.outliers.size()) + " of " + std::to_string(seen.count()) +
        " observations contradict the others, and without them too few are left to calibrate by." +
        kAdvice);
  }
  if (static_cast<double>(out.count()) > kMostOutliers * static_cast<double>(seen.count())) {
    verdict.objections.push_back(PerCent(out.count(), seen.count()) +
                                 " of the observations are outliers." + kAdvice);
  } else if (static_cast<double>(out.count()) > kManyOutliers * static_cast<double>(seen.count())) {
    verdict.remarks.push_back(PerCent(out.count(), seen.count()) +
                              " of the observations are outliers");
  }
  for (Eigen::Index m = 0; m < seen.cols(); ++m) {
    const auto rejected = out.col(m).count();
    if (rejected < 3 || static_cast<double>(rejected) <
                            kSuspectedMarker * static_cast<double>(seen.col(m).count())) {
      continue;
    }
    verdict.remarks.push_back(
        "marker " + recording.marker_names[m] + ": " + std::to_string(rejected) + " of " +
        std::to_string(seen.col(m).count()) +
        " observations are outliers; is it on the right link, and did it keep its place?");
  }
}

void JudgeExcitation(const CalibrationResult& result, const Excitation& excitation,
                     Verdict& verdict) {
  const std::size_t weak = HardlyExcited(result.model.parameters, excitation).size();
  const std::size_t count = excitation.parameters.size();
  if (static_cast<double>(weak) <= kMostWeak * static_cast<double>(count)) return;
  verdict.objections.push_back("the postures do not determine the parameters (" +
                               std::to_string(weak) + " of " + std::to_string(count) +
                               " not to a degree or 5 mm): record more of them, and more "
                               "different ones");
}

}  // namespace

Verdict Judge(const ModelComparison& comparison, const CrossValidation& validation,
              const Excitation& excitation, const Recording& recording,
              const CalibrationOptions& options) {
  const CalibrationResult& result = comparison.largest();
  Verdict verdict;
  JudgeFit(result, options, verdict);
  JudgeExcitation(result, excitation, verdict);
  JudgeOutliers(result, recording, verdict);
  if (validation.folds > 0) {
    if (validation.unconverged > 0) {
      verdict.remarks.push_back(std::to_string(validation.unconverged) +
                                " fits of the cross-validation have not converged");
    }
    const auto largest = static_cast<std::size_t>(comparison.largest_kind());
    if (!std::isfinite(validation.metrics[largest].rmse_3d)) {
      verdict.remarks.emplace_back(
          "no held-out posture could be predicted, because the root link could not be placed in "
          "any: the errors are those of the fit, which judge little");
    } else if (validation.not_predicted > 0) {
      verdict.remarks.push_back(
          std::to_string(validation.not_predicted) +
          " held-out observations could not be predicted: their marker is in no other fold, the "
          "waist could not be placed, or their cluster was knocked next to them");
    }
  }
  if (!verdict.objections.empty()) NameLargest(result, options.prior, verdict);
  return verdict;
}

void LeaveOutConsequences(Verdict& verdict) {
  std::erase_if(verdict.objections,
                [](const std::string& objection) { return objection.ends_with(kAdvice); });
  std::erase_if(verdict.remarks,
                [](const std::string& remark) { return remark.starts_with(kFurthest); });
}

void JudgeDeployment(const Deployment& deployment, double expected_error, Verdict& verdict) {
  if (deployment.urdf > kImplausible * expected_error) {
    verdict.objections.push_back("on " + deployment.judged_on +
                                 " the calibrated robot description errs by " +
                                 Number(1e3 * deployment.urdf, "mm") +
                                 ", where one that was never " + "calibrated should err by some " +
                                 Number(1e3 * expected_error, "mm") + " (the prior)." + kAdvice);
  }
  const bool judged = std::isfinite(deployment.urdf) && std::isfinite(deployment.uncalibrated);
  if (!judged || deployment.judged_on == "the fit" || deployment.urdf < deployment.uncalibrated) {
    return;
  }
  const bool worse = deployment.urdf > kWorseBeyondChance * deployment.uncalibrated;
  (worse ? verdict.objections : verdict.remarks)
      .push_back("on " + deployment.judged_on + " the calibrated robot description is " +
                 (worse ? "worse" : "no better") +
                 " than the uncalibrated one: " + Number(1e3 * deployment.urdf, "mm") +
                 " against " + Number(1e3 * deployment.uncalibrated, "mm"));
}

void JudgePostures(const Eigen::MatrixXd& distances, const ObservationMask& used,
                   const Recording& recording, double expected_error, Verdict& verdict) {
  constexpr double kGross = 5.0;  // times the expected error
  constexpr double kMany = 0.2;   // share of the postures
  const int trials = std::max<int>(1, static_cast<int>(recording.trials.size()));
  for (int trial = 0; trial < trials; ++trial) {
    int count = 0, gross = 0;
    double worst = 0.0;
    for (int i = 0; i < recording.posture_count(); ++i) {
      if (!recording.trials.empty() && recording.trial[i] != trial) continue;
      ++count;
      double squares = 0.0, seen = 0.0;
      for (Eigen::Index m = 0; m < distances.cols(); ++m) {
        if (!used(i, m) || !std::isfinite(distances(i, m))) continue;
        squares += distances(i, m) * distances(i, m);
        ++seen;
      }
      const double left = seen > 0.0 ? std::sqrt(squares / seen) : 0.0;
      if (left > kGross * expected_error) ++gross;
      worst = std::max(worst, left);
    }
    if (gross == 0) continue;
    const bool many = gross > 1 && gross >= kMany * count;
    (many ? verdict.objections : verdict.remarks)
        .push_back(
            (recording.trials.empty() ? "" : "trial " + recording.trials[trial].name + ": ") +
            std::to_string(gross) + " of " + std::to_string(count) + " postures are off by up to " +
            Number(1e3 * worst, "mm") +
            " in the fit, which is no error of a robot: was a joint's log or a label wrong "
            "there, or did the support move?");
  }
}

void JudgeHeldOut(const ErrorTable& table, ModelKind model, ModelKind urdf, Verdict& verdict) {
  for (const TrialErrors& trial : table.trials) {
    const auto errors = trial.metrics.find(model);
    if (errors == trial.metrics.end() || std::isfinite(errors->second.rmse_3d)) continue;
    verdict.remarks.push_back(trial.trial +
                              ", a trial for validation, is not judged: the root link could be "
                              "placed in none of its postures. Were its markers seen?");
  }
  for (const ErrorTableRow& row : table.groups) {
    const auto calibrated = row.metrics.find(model);
    if (calibrated == row.metrics.end() || !std::isfinite(calibrated->second.rmse_3d)) continue;
    const double rmse = calibrated->second.rmse_3d;
    for (const auto& [kind, metrics] : row.metrics) {
      // For a rigid robot all models but the uncalibrated one are equally good.
      const double as_good = kind == ModelKind::kUncalibrated ? 1.0 : kAsGood;
      if (kind == model || kind == ModelKind::kRigid || !(rmse >= as_good * metrics.rmse_3d)) {
        continue;
      }
      const std::string text = "on held-out trials of " + row.group + " the " +
                               ModelKindName(model) + " model errs by " + Number(1e3 * rmse, "mm") +
                               ", the " + ModelKindName(kind) + " one by " +
                               Number(1e3 * metrics.rmse_3d, "mm");
      const bool worse =
          kind == ModelKind::kUncalibrated && rmse > kWorseBeyondChance * metrics.rmse_3d;
      (worse ? verdict.objections : verdict.remarks).push_back(text);
    }
    const auto alone = row.metrics.find(urdf);
    const auto nominal = row.metrics.find(ModelKind::kUncalibrated);
    if (urdf == model || alone == row.metrics.end() || nominal == row.metrics.end() ||
        alone->second.rmse_3d < nominal->second.rmse_3d) {
      continue;
    }
    verdict.remarks.push_back("on held-out trials of " + row.group +
                              " the URDF alone, without compensation of elasticity, errs by " +
                              Number(1e3 * alone->second.rmse_3d, "mm") +
                              ", the uncalibrated one by " +
                              Number(1e3 * nominal->second.rmse_3d, "mm"));
  }
}

}  // namespace elastocal
