// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/earlier_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "elastocal/io/fingerprint.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/choose_causes.hpp"

namespace elastocal {
namespace {

/// Zeros drift where encoders are homed anew; links and springs do not change, but by an accident.
constexpr double kDriftOfOthers = 0.25;

/// Errors with another frame of the root link are those of other quantities.
void CheckGauge(const std::filesystem::path& calibration, const Project& project) {
  const CalibrationEstimate earlier = ReadEstimate(FindCalibrationFiles(calibration).calibration);
  const std::string wanted = GaugeText(project.calibration.gauge);
  if (earlier.gauge == wanted) return;
  throw InputError(earlier.source + ": has the gauge '" + earlier.gauge +
                   "', and calibration.gauge of the project is '" + wanted +
                   "'; the gauge of the earlier calibration was expected");
}

}  // namespace

ElasticityChoice ElasticityOf(const StoredCalibration& calibration, const Project& project) {
  ElasticityChoice choice = project.elasticity;
  choice.extra = StoredCauses(project.tree, calibration.joint_errors);
  choice.torsion.emplace();
  choice.bending.emplace();
  choice.root_bending = false;
  for (const Joint& joint : project.tree.joints) {
    const auto has = [&](const char* axis) {
      return calibration.joint_errors.contains(joint.name + ".compliance_" + axis);
    };
    if (has("z")) choice.torsion->push_back(joint.name);
    if (has("x")) choice.bending->push_back(joint.name);
    choice.root_bending = choice.root_bending || has("root_x");
  }
  return choice;
}

void CheckApplies(const StoredCalibration& calibration, const Project& project,
                  const ErrorModel& model) {
  if (calibration.nominal != NominalFingerprint(model)) {
    throw InputError(calibration.source + ": made for robot '" + calibration.robot +
                     "' with other nominal geometry than " + project.urdf.string() +
                     "; expected the URDF that was calibrated, not the calibrated one");
  }
  std::vector<std::string> chains;
  for (const Chain& chain : project.chains) chains.push_back(chain.name);
  CheckParameters(calibration, MakeErrorModel(project.tree, project.markers, project.placement),
                  chains);
}

EarlierEstimate MakeEarlierEstimate(const CalibrationEstimate& calibration, const ErrorModel& model,
                                    const CalibrationOptions& options, double days) {
  if (!calibration.has_covariance()) {
    throw InputError(calibration.source +
                     ": no covariance.csv beside it, which says how certain it is");
  }
  std::map<std::string, const Parameter*> of_model;
  for (const Parameter& parameter : model.parameters) of_model[parameter.name] = &parameter;
  std::map<std::string, const ParameterEstimate*> estimates;
  for (const ParameterEstimate& one : calibration.parameters) estimates[one.name] = &one;
  EarlierEstimate earlier;
  std::vector<int> rows;
  std::vector<double> mean, drift;
  for (std::size_t row = 0; row < calibration.covariance_names.size(); ++row) {
    const std::string& name = calibration.covariance_names[row];
    const auto estimate = estimates.find(name);
    const auto parameter = of_model.find(name);
    if (estimate == estimates.end() || parameter == of_model.end()) continue;
    const ParameterKind kind = parameter->second->kind;
    if (IsExternal(kind) || kind == ParameterKind::kTorqueBias) continue;
    earlier.names.push_back(name);
    rows.push_back(static_cast<int>(row));
    mean.push_back(estimate->second->value);
    const double part = IsZeroOffset(*parameter->second, model.tree) ? 1.0 : kDriftOfOthers;
    drift.push_back(part * options.drift * options.prior.Of(model.tree, *parameter->second));
  }
  const auto count = static_cast<Eigen::Index>(rows.size());
  earlier.mean = Eigen::Map<const Eigen::VectorXd>(mean.data(), count);
  earlier.covariance = calibration.covariance(rows, rows);
  earlier.covariance.diagonal() +=
      days * Eigen::Map<const Eigen::VectorXd>(drift.data(), count).cwiseAbs2();
  return earlier;
}

EarlierFit FitAfterEarlier(const std::filesystem::path& calibration, double days,
                           const Measurements& measured, std::optional<std::uint64_t> seed,
                           const JointCheckOptions& options, Project& project) {
  const CalibrationFiles files = FindCalibrationFiles(calibration);
  EarlierFit fit{.stored = ReadCalibration(files.calibration),
                 .earlier = {},
                 .robot = {},
                 .estimate = {},
                 .check = {},
                 .measured = measured};
  const CalibrationEstimate estimate = ReadCalibrationFiles(files);
  project.elasticity = ElasticityOf(fit.stored, project);
  project.calibration.extra = {.automatic = false, .names = project.elasticity.extra};
  const ErrorModel model = MakeProjectModel(project, measured.calibration.trials);
  CheckApplies(fit.stored, project, model);
  fit.earlier = MakeEarlierEstimate(estimate, model, project.calibration, days);

  const Eigen::VectorXd sizes = SizeOfChanges(fit.earlier, model, project.calibration.prior);
  Project open = project;
  open.calibration.earlier = fit.earlier;
  open.calibration.earlier.covariance.diagonal() += sizes.cwiseAbs2();
  fit.robot = MakeRecordedModel(open, seed, fit.measured);
  fit.estimate = Calibrate(fit.robot.model, fit.measured.calibration, fit.robot.base,
                           ModelKinds(fit.robot.model).back(), open.calibration);
  fit.check = FindMovedJoints(fit.estimate, fit.earlier, sizes, options);
  return fit;
}

EarlierEstimate ForgetMoved(const JointCheck& check, const EarlierEstimate& earlier,
                            const ErrorModel& model, const Prior& prior) {
  std::vector<std::string> joints = check.suspects;
  for (const JointSuspect& joint : check.moved) joints.push_back(joint.joint);
  const Eigen::VectorXd sizes = SizeOfChanges(earlier, model, prior);
  EarlierEstimate left = earlier;
  for (std::size_t i = 0; i < earlier.names.size(); ++i) {
    const std::string joint = OwnerName(earlier.names[i]);
    if (std::find(joints.begin(), joints.end(), joint) == joints.end()) continue;
    const auto at = static_cast<Eigen::Index>(i);
    left.covariance(at, at) += sizes[at] * sizes[at];
  }
  return left;
}

std::vector<std::string> DescribeForgotten(const JointCheck& check, const std::string& source) {
  std::vector<std::string> texts;
  for (const JointSuspect& joint : check.moved) {
    texts.push_back(joint.joint + ": has moved since " + source +
                    ", which counts for nothing there");
  }
  if (!check.suspects.empty()) {
    texts.push_back(fmt::format("one of {} has moved since {}, which counts for nothing there",
                                fmt::join(check.suspects, ", "), source));
  }
  return texts;
}

std::vector<std::string> StartFromEarlier(const std::filesystem::path& calibration, double days,
                                          const Measurements& measured,
                                          std::optional<std::uint64_t> seed, Project& project) {
  CheckGauge(calibration, project);
  const EarlierFit fit = FitAfterEarlier(calibration, days, measured, seed, {}, project);
  std::vector<std::string> warnings;
  if (fit.stored.recording == measured.calibration.source) {
    warnings.push_back(fit.stored.source + ": made from the same recording, which counts twice");
  }
  for (std::string& text : DescribeForgotten(fit.check, fit.stored.source)) {
    warnings.push_back(std::move(text));
  }
  project.calibration.earlier =
      ForgetMoved(fit.check, fit.earlier, fit.robot.model, project.calibration.prior);
  return warnings;
}

}  // namespace elastocal
