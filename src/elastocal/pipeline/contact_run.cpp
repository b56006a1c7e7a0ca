#include "elastocal/pipeline/contact_run.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "elastocal/io/touch_table.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/tables/read_file.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr int kUsualFolds = 10;
constexpr int kFewestTouches = 8;       // tables and plates alone have 5 unknowns each
constexpr double kPlainGain = 2.0;      // standard deviations: better by no chance
constexpr double kLittleBetter = 0.95;  // of the error before: hardly anything was gained
constexpr double kMostLeftOut = 0.25;   // share of touches
constexpr double kDegreeHere = 180.0 / M_PI;
constexpr double kTiedVariance = 1e-6;  // relative, see TakePosterior

std::string JoinNames(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

ContactOutcome Estimate(const ContactModel& model, const Touches& touches, bool robot,
                        const ContactRunOptions& options, int folds) {
  const ContactFreedom freedom{.robot = robot};
  ContactOutcome outcome;
  outcome.estimate = EstimateContacts(model, touches, freedom);
  outcome.in_sample =
      MakeFigures(model, touches, LeftOfTouches(model, touches, outcome.estimate.fit.values));
  if (folds > 0) {
    outcome.held_out = CrossValidateTouches(model, touches, freedom, folds, options.threads,
                                            robot ? options.progress : Progress());
  }
  return outcome;
}

/// The same model without compliances; nothing where none is elastic.
std::optional<ContactModel> WithoutCompliances(const ContactModel& model, const Touches& touches,
                                               const Project& project) {
  const auto elastic = [](const Parameter& parameter) { return IsCompliance(parameter.kind); };
  const std::vector<Parameter>& parameters = model.robot.parameters;
  if (std::none_of(parameters.begin(), parameters.end(), elastic)) return std::nullopt;
  ContactSetup setup = model.setup;
  setup.hold.push_back("*.compliance_*");
  const Elasticity& elasticity = model.robot.elasticity;
  ContactModel rigid = MakeContactModel(project.tree, project.placement, setup, elasticity.torsion,
                                        elasticity.bending);
  KeepTouchedUnknowns(touches, rigid);
  return rigid;
}

/// Standard deviations of the priors, by parameter; NaN for those that are not estimated.
Eigen::VectorXd PriorSds(const ContactModel& model, const ContactSpread& spread) {
  const std::vector<SourceOfParameter> sources = SourcesOfParameters(model);
  Eigen::VectorXd sds = Eigen::VectorXd::Constant(model.robot.parameter_count(),
                                                  std::numeric_limits<double>::quiet_NaN());
  for (int i = 0; i < model.robot.parameter_count(); ++i) {
    if (model.unknown[i] >= 0) sds[i] = spread[sources[i].source] * sources[i].unit;
  }
  return sds;
}

/// Covariance of the parameters. Those that have one value in common would make it singular, so
/// that nothing could be tested with it: each keeps a millionth of its variance to itself.
void TakePosterior(const ContactModel& model, const ContactFit& fit, CalibrationResult& result) {
  std::vector<int> entries;
  for (int i = 0; i < model.robot.parameter_count(); ++i) {
    if (model.unknown[i] < 0) continue;
    result.posterior.parameters.push_back(i);
    entries.push_back(fit.entry_of_unknown[model.unknown[i]]);
  }
  result.posterior.covariance = fit.covariance(entries, entries);
  result.posterior.covariance.diagonal() *= 1.0 + kTiedVariance;
  result.posterior.effective_parameters = fit.effective_parameters;
}

CalibrationResult ResultOf(const ContactModel& model, const ContactFit& fit, int equations) {
  CalibrationResult result;
  const auto elastic = [](const Parameter& parameter) { return IsElastic(parameter.kind); };
  result.kind = std::any_of(model.robot.parameters.begin(), model.robot.parameters.end(), elastic)
                    ? ModelKind::kFull
                    : ModelKind::kGeometric;
  result.model = model.robot;
  result.delta = fit.values.robot;
  result.prior_sd = PriorSds(model, fit.spread);
  result.sd = result.prior_sd;
  TakePosterior(model, fit, result);
  const Eigen::VectorXd sds = result.posterior.StandardDeviations();
  const CalibrationOptions usual;
  result.status.assign(model.unknown.size(), ParameterStatus::kHeld);
  for (std::size_t k = 0; k < result.posterior.parameters.size(); ++k) {
    const int i = result.posterior.parameters[k];
    result.sd[i] = sds[static_cast<Eigen::Index>(k)];
    result.status[i] = result.sd[i] < usual.support_threshold * result.prior_sd[i]
                           ? ParameterStatus::kEstimated
                           : ParameterStatus::kUnsupported;
  }
  result.interval_factor =
      std::clamp(StudentQuantile(0.975, fit.degrees_of_freedom), 1.959964, 12.7);
  result.equations = equations;
  result.termination = fit.termination;
  result.settled = fit.settled;
  result.iterations = fit.iterations;
  return result;
}

void JudgeContacts(ContactRun& run) {
  Verdict& verdict = run.verdict;
  const TouchErrors& before = ContactRun::Judged(run.uncalibrated).all;
  const TouchErrors& after = ContactRun::Judged(run.calibrated).all;
  const bool held_out = run.calibrated.held_out.folds > 0;
  const std::string on = held_out ? "on touches that were left out" : "on the touches of the fit";
  if (run.calibrated.estimate.fit.termination != Termination::kConverged) {
    verdict.objections.push_back("the estimate has not converged: variances did not come to rest");
  }
  const auto left_out = static_cast<double>(run.calibrated.estimate.outliers.size());
  if (left_out > kMostLeftOut * run.touches.count()) {
    verdict.objections.push_back(
        fmt::format("{:.0f} of {} touches are outliers", left_out, run.touches.count()));
  }
  const bool better = after.height < before.height || after.tilt() < before.tilt();
  if (!better || run.gain_in_sds < -kPlainGain) {
    verdict.objections.push_back("the calibrated robot is no better than the uncalibrated one " +
                                 on);
  } else if (run.gain_in_sds < kPlainGain || (after.height > kLittleBetter * before.height &&
                                              after.tilt() > kLittleBetter * before.tilt())) {
    verdict.remarks.push_back("the calibrated robot is hardly better than the uncalibrated one " +
                              on);
  }
  if (!held_out) {
    verdict.remarks.push_back("no touch was left out (--kfold 0): nothing was validated");
  }
  if (run.geometric) {
    const TouchErrors& urdf = ContactRun::Judged(*run.geometric).all;
    verdict.remarks.push_back(fmt::format(
        "these figures hold with compensation of elasticity; the URDF alone leaves {:.2f} mm and "
        "{:.2f} degrees {}",
        1e3 * urdf.height, kDegreeHere * urdf.tilt(), on));
  }
  if (run.calibrated.held_out.unsettled > 0) {
    verdict.remarks.push_back(fmt::format("{} of {} folds have not converged",
                                          run.calibrated.held_out.unsettled,
                                          run.calibrated.held_out.folds));
  }
  verdict.remarks.push_back(DescribeClosure(run.closure));
}

}  // namespace

ContactRun CalibrateContacts(const Project& project,
                             const std::vector<std::filesystem::path>& recordings,
                             const ContactRunOptions& options) {
  TouchTables tables = ReadTouchTables(recordings, project);
  ContactRun run;
  run.warnings = std::move(tables.warnings);
  run.touches = std::move(tables.touches);
  run.recording = JoinNames(run.touches.files);
  run.zero_offsets = options.zero_offsets;
  if (run.touches.count() < kFewestTouches) {
    throw InputError(run.recording + ": " + std::to_string(run.touches.count()) +
                     " touches; at least " + std::to_string(kFewestTouches) + " were expected");
  }
  tables.setup.hold = project.identifiability.hold;
  tables.setup.outlier_probability = project.calibration.outlier_probability;
  const auto joints = [&](const std::optional<std::vector<std::string>>& patterns) {
    return patterns ? MatchingJoints(project.tree, *patterns) : std::vector<int>();
  };
  try {
    run.model =
        MakeContactModel(project.tree, project.placement, tables.setup,
                         joints(project.elasticity.torsion), joints(project.elasticity.bending));
  } catch (const InputError& error) {
    throw InputError(project.file.string() +
                     ": contact.common or identifiability.hold: " + error.what());
  }
  KeepTouchedUnknowns(run.touches, run.model);
  run.closure = CheckClosure(run.model, run.touches);
  const int folds = options.folds.value_or(std::min(kUsualFolds, run.touches.count()));
  run.uncalibrated = Estimate(run.model, run.touches, false, options, folds);
  run.calibrated = Estimate(run.model, run.touches, true, options, folds);
  const ContactFit& fit = run.calibrated.estimate.fit;
  const auto left = [&](const ContactOutcome& outcome) {
    return folds > 0 ? outcome.held_out.left
                     : LeftOfTouches(run.model, run.touches, outcome.estimate.fit.values);
  };
  run.gain_in_sds = GainInSds(left(run.uncalibrated), left(run.calibrated), fit.spread);
  const int equations = 3 * run.touches.count();
  const auto rigid = WithoutCompliances(run.model, run.touches, project);
  if (rigid) {  // a figure beside the result: ten folds will do
    run.geometric = Estimate(*rigid, run.touches, true, options, std::min(kUsualFolds, folds));
  }
  run.result = ResultOf(run.model, fit, equations);
  JudgeContacts(run);
  if (run.deployable()) {
    const CalibrationResult in_urdf =
        rigid ? ResultOf(*rigid, run.geometric->estimate.fit, equations) : run.result;
    run.urdf = MakeCalibratedUrdf(ReadFile(project.urdf), project.urdf.string(), in_urdf,
                                  options.zero_offsets);
    run.warnings.insert(run.warnings.end(), run.urdf->warnings.begin(), run.urdf->warnings.end());
  }
  for (std::string& outlier : DescribeOutliers(run)) run.warnings.push_back(std::move(outlier));
  return run;
}

std::vector<std::string> DescribeOutliers(const ContactRun& run) {
  std::vector<std::string> texts;
  for (const TouchOutlier& outlier : run.calibrated.estimate.outliers) {
    const Touch& touch = run.touches.touches[outlier.touch];
    texts.push_back(Place(run.touches.files[touch.file], touch.line) +
                    fmt::format("the touch of plate '{}' contradicts the others and is left out: "
                                "off by {:.1f} mm, {:.2f} and {:.2f} degrees; was there contact?",
                                run.model.setup.plates[touch.plate].name, 1e3 * outlier.left[0],
                                kDegreeHere * outlier.left[1], kDegreeHere * outlier.left[2]));
  }
  return texts;
}

}  // namespace elastocal
