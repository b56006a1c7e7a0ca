// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/earlier_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "elastocal/io/fingerprint.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/choose_causes.hpp"
#include "elastocal/robot/zero_offset.hpp"
#include "elastocal/validation/data_information.hpp"
#include "elastocal/validation/earlier_markers.hpp"
#include "elastocal/validation/transfer.hpp"

namespace elastocal {
namespace {

/// Drift of parameters that are no zeros, relative to zeros. Zeros change where encoders are homed
/// anew; links and springs only by an accident.
constexpr double kDriftOfOthers = 0.25;

/// Refuses a calibration with another gauge, whose errors are other quantities.
void CheckGauge(const std::filesystem::path& calibration, const Project& project) {
  const CalibrationEstimate earlier = ReadEstimate(FindCalibrationFiles(calibration).calibration);
  const std::string wanted = GaugeText(project.calibration.gauge);
  if (earlier.gauge == wanted) return;
  throw InputError(earlier.source + ": has the gauge '" + earlier.gauge +
                   "', and calibration.gauge of the project is '" + wanted +
                   "'; the gauge of the earlier calibration was expected");
}

/// Nominal position of markers now minus that in the calibration, m, by the names of their
/// parameters; only for links that are `same`.
std::map<std::string, double> NominalShifts(const CalibrationEstimate& calibration,
                                            const ErrorModel& model,
                                            const std::vector<LinkMarkers>& markers) {
  std::map<std::string, double> shifts;
  for (const LinkMarkers& link : markers) {
    if (!link.same) continue;
    for (const std::string& name : link.markers) {
      const auto before = std::ranges::find(calibration.markers, name, &MarkerPlace::name);
      const auto now = std::ranges::find(model.markers, name, &Marker::name);
      for (int axis = 0; axis < 3; ++axis) {
        shifts["marker." + name + "." + "xyz"[axis]] =
            now->p_link_marker[axis] - before->nominal[axis];
      }
    }
  }
  return shifts;
}

/// The same list, where the markers on `links` are no longer `same`.
std::vector<LinkMarkers> LeftOpen(std::vector<LinkMarkers> markers,
                                  const std::vector<std::string>& links) {
  for (LinkMarkers& one : markers) one.same = one.same && !std::ranges::count(links, one.link);
  return markers;
}

/// Raises the cluster factor to that of the earlier calibration's many postures. A few postures
/// with every joint free to have moved do not tell how much the model errs from one to the next.
void ScatterAsBefore(const StoredCalibration& earlier, CalibrationResult& estimate) {
  if (!(estimate.marker_sd > 0.0)) return;
  const double variances = std::pow(earlier.scatter_sd / estimate.marker_sd, 2);
  if (!(variances > estimate.posterior.cluster_factor)) return;
  estimate.posterior.cluster_factor = variances;
}

/// Finds the joints that have moved (`find`), under the condition that markers on links marked
/// `same` have not. The condition is then left out for one link after another, because its markers
/// may have moved as one piece. If nothing has changed without it, the link is added to
/// `or_markers` of the one accused joint; where several joints are accused, the cluster is taken to
/// have moved instead.
JointCheck CheckBesideMarkers(
    const std::vector<LinkMarkers>& markers,
    const std::function<JointCheck(const std::vector<LinkMarkers>&)>& find) {
  JointCheck check = find(markers);
  check.markers = markers;
  for (std::size_t k = 0; k < markers.size() && check.changed(); ++k) {
    if (!markers[k].same) continue;
    std::vector<LinkMarkers> links = LeftOpen(markers, {markers[k].link});
    JointCheck open = find(links);
    if (open.changed()) continue;
    if (check.moved.size() == 1 && check.suspects.empty()) {
      check.or_markers.push_back(links[k].link);
      continue;
    }
    links[k].as_one_piece = true;
    open.markers = std::move(links);
    return open;
  }
  return check;
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
                                    const CalibrationOptions& options, double days,
                                    const std::vector<LinkMarkers>& markers) {
  if (!calibration.has_covariance()) {
    throw InputError(calibration.source +
                     ": no covariance.csv beside it, which says how certain it is");
  }
  std::map<std::string, const Parameter*> of_model;
  for (const Parameter& parameter : model.parameters) of_model[parameter.name] = &parameter;
  std::map<std::string, const ParameterEstimate*> estimates;
  for (const ParameterEstimate& one : calibration.parameters) estimates[one.name] = &one;
  const std::map<std::string, double> stayed = NominalShifts(calibration, model, markers);
  EarlierEstimate earlier;
  std::vector<int> rows;
  std::vector<double> mean, added;
  for (std::size_t row = 0; row < calibration.covariance_names.size(); ++row) {
    const std::string& name = calibration.covariance_names[row];
    const auto estimate = estimates.find(name);
    const auto found = of_model.find(name);
    if (estimate == estimates.end() || found == of_model.end()) continue;
    const Parameter& parameter = *found->second;
    const auto marker = stayed.find(name);
    if (marker != stayed.end()) {
      mean.push_back(estimate->second->value - marker->second);
      added.push_back(kMarkerReturns * kMarkerReturns);
    } else if (IsExternal(parameter.kind) || parameter.kind == ParameterKind::kTorqueBias) {
      continue;
    } else {
      const double part = IsZeroOffset(parameter, model.tree) ? 1.0 : kDriftOfOthers;
      const double drift = part * options.drift * options.prior.Of(model.tree, parameter);
      mean.push_back(estimate->second->value);
      added.push_back(days * drift * drift);
    }
    earlier.names.push_back(name);
    rows.push_back(static_cast<int>(row));
  }
  const auto count = static_cast<Eigen::Index>(rows.size());
  earlier.mean = Eigen::Map<const Eigen::VectorXd>(mean.data(), count);
  earlier.covariance = calibration.covariance(rows, rows);
  earlier.covariance.diagonal() += Eigen::Map<const Eigen::VectorXd>(added.data(), count);
  return earlier;
}

EarlierFit FitAfterEarlier(const std::filesystem::path& calibration, double days,
                           const Measurements& measured, std::optional<std::uint64_t> seed,
                           const JointCheckOptions& options, Project& project) {
  const CalibrationFiles files = FindCalibrationFiles(calibration);
  EarlierFit fit{.stored = ReadCalibration(files.calibration),
                 .calibration = ReadCalibrationFiles(files),
                 .robot = {},
                 .fitted_with = {},
                 .estimate = {},
                 .check = {},
                 .measured = measured};
  project.elasticity = ElasticityOf(fit.stored, project);
  project.calibration.extra = {.automatic = false, .names = project.elasticity.extra};
  const ErrorModel model = MakeProjectModel(project, measured.calibration.trials);
  CheckApplies(fit.stored, project, model);

  fit.fitted_with = MakeEarlierEstimate(fit.calibration, model, project.calibration, days);
  fit.fitted_with.covariance.diagonal() +=
      SizeOfChanges(fit.fitted_with, model, project.calibration.prior).cwiseAbs2();
  Project open = project;
  open.calibration.earlier = fit.fitted_with;
  fit.robot = MakeRecordedModel(open, seed, fit.measured);
  fit.estimate = Calibrate(fit.robot.model, fit.measured.calibration, fit.robot.base,
                           ModelKinds(fit.robot.model).back(), open.calibration);
  ScatterAsBefore(fit.stored, fit.estimate);

  std::vector<LinkMarkers> links;
  if (!options.new_markers) {
    links = FindMarkersThatStayed(fit.calibration, fit.estimate, fit.fitted_with, options.level);
  }
  fit.check = CheckBesideMarkers(links, [&](const std::vector<LinkMarkers>& markers) {
    const EarlierEstimate earlier =
        MakeEarlierEstimate(fit.calibration, fit.robot.model, project.calibration, days, markers);
    return FindMovedJoints(fit.estimate, fit.fitted_with, earlier,
                           SizeOfChanges(earlier, fit.robot.model, project.calibration.prior),
                           options);
  });
  return fit;
}

EarlierEstimate ForgetMoved(const JointCheck& check, const EarlierEstimate& earlier,
                            const ErrorModel& model, const Prior& prior) {
  std::vector<std::string> joints = check.suspects;
  for (const JointSuspect& joint : check.moved) joints.push_back(joint.joint);
  const Eigen::VectorXd sizes = SizeOfChanges(earlier, model, prior);
  EarlierEstimate left = earlier;
  left.covariance *= check.widened;
  for (std::size_t i = 0; i < earlier.names.size(); ++i) {
    const std::string joint = OwnerName(earlier.names[i]);
    if (std::find(joints.begin(), joints.end(), joint) == joints.end()) continue;
    const auto at = static_cast<Eigen::Index>(i);
    left.covariance(at, at) += sizes[at] * sizes[at];
  }
  return left;
}

std::string AskWhereMostMoved(std::size_t moved, std::size_t joints) {
  constexpr std::size_t kFewest = 3;
  return moved >= kFewest && 2 * moved > joints ? ": another robot, or joints that were homed anew?"
                                                : "";
}

std::vector<std::string> DescribeForgotten(const JointCheck& check, const std::string& source) {
  std::vector<std::string> texts;
  std::set<std::string> joints;
  for (const auto* suspects : {&check.joints, &check.moved}) {
    for (const JointSuspect& joint : *suspects) joints.insert(joint.joint);
  }
  const std::string question = AskWhereMostMoved(check.moved.size(), joints.size());
  if (!question.empty()) {
    texts.push_back(fmt::format(
        "{} of {} joints have moved since {}{} The calibration of another robot is no prior of "
        "this one: leave out --prior",
        check.moved.size(), joints.size(), source, question));
  }
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

std::vector<std::string> DescribeWidened(const JointCheck& check, const std::string& source) {
  constexpr double kTold = 4.0;  // a smaller factor may be chance
  if (check.widened < kTold) return {};
  return {
      fmt::format("{}: errs by {:.2g} times its standard deviations in these postures (errors "
                  "that its model lacks), which are taken to be so much larger",
                  source, std::sqrt(check.widened))};
}

EarlierEstimate MostProbable(const JointCheck& check, const CalibrationResult& estimate,
                             const EarlierEstimate& fitted_with, double days,
                             const std::function<EarlierEstimate(double)>& after,
                             const Prior& prior) {
  const DataInformation data = InformationOfData(estimate, fitted_with);
  EarlierEstimate best;
  double most = 0.0;  // evidence of `best`; NaN with an infinite prior, which then keeps all days
  for (const double share : {1.0, 0.25, 1.0 / 16.0, 1.0 / 64.0, 0.0}) {
    EarlierEstimate known = ForgetMoved(check, after(share * days), estimate.model, prior);
    const double evidence = LogEvidence(data, MeanBefore(estimate, data, known),
                                        CovarianceBefore(estimate, data, known));
    if (!best.empty() && !(evidence > most)) continue;
    most = evidence;
    best = std::move(known);
  }
  return best;
}

EarlierEstimate KnownAfter(const EarlierFit& fit, double days, const CalibrationOptions& options) {
  const std::vector<LinkMarkers> stayed = LeftOpen(fit.check.markers, fit.check.or_markers);
  return MostProbable(
      fit.check, fit.estimate, fit.fitted_with, days,
      [&](double drifting) {
        return MakeEarlierEstimate(fit.calibration, fit.robot.model, options, drifting, stayed);
      },
      options.prior);
}

std::string DescribeWorseUpdate(const std::filesystem::path& calibration,
                                const RecordedModel& robot, const Recording& recording,
                                CalibrationOptions options, const Eigen::MatrixXd& updated) {
  constexpr double kClearly = 1.1;
  options.earlier = {};
  // Markers and waist are fitted to all postures with the earlier calibration, but to those of
  // other folds with the update.
  const auto fitted = static_cast<double>(std::ranges::count_if(
      robot.model.parameters, [](const Parameter& one) { return IsExternal(one.kind); }));
  const auto rows = static_cast<double>(3 * SeenMask(recording).count());
  if (fitted >= rows) return "";
  const double by_fit = std::sqrt((1.0 + fitted / rows) / (1.0 - fitted / rows));
  const StoredCalibration stored = ReadCalibration(FindCalibrationFiles(calibration).calibration);
  const CalibrationResult refit =
      RefitTo(robot.model, recording, robot.base, options, stored.joint_errors).result;
  const Eigen::MatrixXd distances = Predict(refit.model, refit.delta, recording, options).distances;
  if (distances.cols() != updated.cols()) return "";  // clusters that were knocked are split
  const ObservationMask judged = updated.array().isFinite();
  const double before = ComputeMetrics(distances, judged).rmse_3d;
  const double after = ComputeMetrics(updated, judged).rmse_3d;
  if (!(after > kClearly * by_fit * before)) return "";
  return fmt::format(
      "{}: errs by {:.3g} mm on these postures, and the update by {:.3g} mm on those that were "
      "left "
      "out: they are too few or too near to each other to improve on it",
      stored.source, 1e3 * before, 1e3 * after);
}

std::string CountsTwice(const std::string& source) {
  return source + ": made from the same recording, which counts twice";
}

std::vector<std::string> StartFromEarlier(const std::filesystem::path& calibration, double days,
                                          const Measurements& measured,
                                          std::optional<std::uint64_t> seed, Project& project) {
  CheckGauge(calibration, project);
  const EarlierFit fit = FitAfterEarlier(calibration, days, measured, seed, {}, project);
  std::vector<std::string> warnings;
  for (std::string& text : DescribeForgotten(fit.check, fit.stored.source)) {
    warnings.push_back(std::move(text));
  }
  for (std::string& text : DescribeWidened(fit.check, fit.stored.source)) {
    warnings.push_back(std::move(text));
  }
  project.calibration.earlier = KnownAfter(fit, days, project.calibration);
  return warnings;
}

}  // namespace elastocal
