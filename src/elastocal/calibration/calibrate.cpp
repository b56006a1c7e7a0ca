#include "elastocal/calibration/calibrate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "elastocal/calibration/fit.hpp"
#include "elastocal/calibration/registration.hpp"
#include "elastocal/calibration/residuals.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr int kMaxVerdicts = 5;
constexpr int kFewUpdates = 2;  // of the noise, for a start

bool IsEstimated(ParameterKind parameter, ModelKind kind) {
  if (IsExternal(parameter)) return true;
  if (IsElastic(parameter)) return kind == ModelKind::kFull;
  return kind == ModelKind::kGeometric || kind == ModelKind::kFull ||
         (kind == ModelKind::kOffsetsOnly && parameter == ParameterKind::kTheta);
}

/// What is estimated. In trials the waist has a pose in each posture instead of T0.
std::vector<int> OfKind(const ErrorModel& model, const BaseParameters& base, ModelKind kind,
                        bool waist_moves) {
  std::vector<int> free;
  for (int i : base.kept) {
    const ParameterKind parameter = model.parameters[i].kind;
    if (waist_moves && parameter == ParameterKind::kWaistPose) continue;
    if (IsEstimated(parameter, kind)) free.push_back(i);
  }
  return free;
}

std::vector<int> Without(const std::vector<int>& all, const std::vector<int>& removed) {
  std::vector<int> rest;
  std::set_difference(all.begin(), all.end(), removed.begin(), removed.end(),
                      std::back_inserter(rest));
  return rest;
}

Selection Without(const Recording& recording, const OutlierVerdict& verdict) {
  Selection selection = SelectAll(recording);
  for (const Outlier& outlier : verdict.markers) {
    selection.markers(outlier.posture, outlier.marker) = false;
  }
  for (const LooseFooting& footing : verdict.footings) selection.tied[footing.posture] = 0;
  return selection;
}

bool Same(const OutlierVerdict& a, const OutlierVerdict& b) {
  return std::equal(a.markers.begin(), a.markers.end(), b.markers.begin(), b.markers.end(),
                    [](const Outlier& x, const Outlier& y) {
                      return x.posture == y.posture && x.marker == y.marker;
                    }) &&
         std::equal(
             a.footings.begin(), a.footings.end(), b.footings.begin(), b.footings.end(),
             [](const LooseFooting& x, const LooseFooting& y) { return x.posture == y.posture; });
}

void CheckEquations(const Recording& recording, const Placement& placement,
                    const Selection& selection, const std::vector<int>& free,
                    std::size_t outliers) {
  auto equations = 3 * selection.markers.count();
  auto unknowns = static_cast<Eigen::Index>(free.size());
  for (int i = 0; i < static_cast<int>(placement.T_ref_waist.size()); ++i) {
    unknowns += 6;
    if (placement.footing[i] >= 0 && selection.tied[i] != 0) equations += 6;
  }
  unknowns += 6 * static_cast<Eigen::Index>(placement.footings.size());
  if (equations >= unknowns) return;
  const std::string left_out =
      outliers == 0 ? "" : ", " + std::to_string(outliers) + " observations left out as outliers";
  throw InputError(recording.source + ": " + std::to_string(equations) + " equations (" +
                   std::to_string(recording.posture_count()) + " postures, " +
                   std::to_string(recording.marker_count()) + " markers" + left_out + ") for " +
                   std::to_string(unknowns) +
                   (placement.empty() ? " parameters" : " parameters and poses of the waist") +
                   "; record more postures or hold parameters");
}

void FillStatus(const BaseParameters& base, const std::vector<int>& free,
                const std::vector<int>& unsupported, CalibrationResult& result) {
  result.status.assign(result.model.parameters.size(), ParameterStatus::kNotInModel);
  for (int i : base.held) result.status[i] = ParameterStatus::kHeld;
  for (int i : base.dropped) result.status[i] = ParameterStatus::kDropped;
  for (int i : free) result.status[i] = ParameterStatus::kEstimated;
  for (int i : unsupported) result.status[i] = ParameterStatus::kUnsupported;
}

/// Root mean square of the groups' over the observations.
double PooledMarkerSd(const ObservationMask& used, const std::vector<int>& group,
                      const Noise& noise) {
  double squares = 0.0;
  double count = 0.0;
  for (Eigen::Index i = 0; i < used.rows(); ++i) {
    const double sd = noise.marker_sd[group[static_cast<std::size_t>(i)]];
    const auto seen = static_cast<double>(used.row(i).count());
    squares += seen * sd * sd;
    count += seen;
  }
  return std::sqrt(squares / std::max(1.0, count));
}

void FillResult(const BaseParameters& base, const std::vector<int>& free,
                const std::vector<int>& unsupported, const CalibrationOptions& options, Fit fit,
                CalibrationResult& result) {
  result.equations = static_cast<int>(3 * result.used.count());
  result.marker_sd = PooledMarkerSd(result.used, result.group, fit.noise);
  result.noise = fit.noise;
  result.placement = fit.placement;
  result.prior_scale = fit.prior_scale;
  result.interval_factor = StudentQuantile(0.975, fit.degrees_of_freedom);
  result.correlations = StrongCorrelations(fit.posterior, options.correlation_threshold);
  result.sd.setConstant(result.model.parameter_count(), std::numeric_limits<double>::quiet_NaN());
  result.sd(fit.posterior.parameters) = fit.posterior.StandardDeviations();
  result.settled = fit.settled;
  result.termination = fit.termination;
  result.message = fit.message;
  result.iterations = fit.iterations;
  result.initial_cost = fit.initial_cost;
  result.final_cost = fit.final_cost;
  result.delta = std::move(fit.delta);
  result.posterior = std::move(fit.posterior);
  FillStatus(base, free, unsupported, result);
}

/// Step 4: the fit without parameters that the data do not support; their uncertainty stays in it.
std::vector<int> HoldUnsupported(const FitProblem& problem, const Selection& selection,
                                 const std::vector<int>& free, Fit& fit) {
  const std::vector<int> unsupported = UnsupportedParameters(problem, fit);
  if (!unsupported.empty()) {
    for (int i : unsupported) fit.delta[i] = 0.0;
    fit = FitParameters(problem, selection, Without(free, unsupported), fit, false);
  }
  UpdatePosterior(problem, selection, free, fit);
  return unsupported;
}

/// Steps 2 to 4 of Calibrate: from a fit of the externals to the result.
void EstimateAll(const FitProblem& problem, const BaseParameters& base,
                 const std::vector<int>& free, const Selection* fixed, Fit fit,
                 CalibrationResult& result) {
  const Recording& recording = problem.recording;
  const double probability = problem.options.outlier_probability;
  Selection selection = fixed != nullptr ? *fixed : SelectAll(recording);
  OutlierVerdict verdict;
  CheckEquations(recording, fit.placement, selection, free, 0);
  if (fixed == nullptr) {
    fit = FitParameters(problem, selection, free, fit, true);
    verdict = FindOutliers(fit, problem.group, selection, probability);
    selection = Without(recording, verdict);
  }
  std::vector<int> unsupported;
  for (int round = 1;; ++round) {
    CheckEquations(recording, fit.placement, selection, free, verdict.markers.size());
    fit = FitParameters(problem, selection, free, fit, false);
    unsupported = HoldUnsupported(problem, selection, free, fit);
    if (fixed != nullptr) break;
    OutlierVerdict next = FindOutliers(fit, problem.group, selection, probability);
    const bool stands = Same(next, verdict);
    if (!stands && round == kMaxVerdicts) {  // keeps the verdict that the fit was made with
      fit.settled = false;
      break;
    }
    verdict = std::move(next);
    if (stands) break;
    selection = Without(recording, verdict);
  }
  Polish(problem, selection, Without(free, unsupported), fit);
  UpdatePosterior(problem, selection, free, fit);
  result.outliers = std::move(verdict.markers);
  result.loose_footings = std::move(verdict.footings);
  result.used = std::move(selection.markers);
  result.tied = std::move(selection.tied);
  if (!fit.placement.empty() && result.kind == ModelKind::kFull) {
    ComputeLoads(problem.model, recording, fit.delta, fit.placement, problem.options.load,
                 &result.loads);
  }
  FillResult(base, free, unsupported, problem.options, std::move(fit), result);
}

/// Step 1, and the others: with the joints' errors as in `delta` where they are not estimated.
void Estimate(const ErrorModel& model, const Recording& recording, const BaseParameters& base,
              const CalibrationOptions& options, const Selection* fixed,
              const Eigen::VectorXd& delta, CalibrationResult& result) {
  result.model = model;
  const bool waist_moves = !recording.trials.empty();
  // T0 starts at zero.
  if (!waist_moves) result.model.T_ref_waist = RegisterWaist(model, recording);
  result.group = NoiseGroups(model, recording);
  const FitProblem problem{result.model, recording, options, result.group};
  const Selection selection = fixed != nullptr ? *fixed : SelectAll(recording);
  const std::vector<int> externals = OfKind(model, base, ModelKind::kUncalibrated, waist_moves);
  const Fit start = StartFit(problem, selection, delta);
  if (waist_moves) FindFootings(model, recording, options.slip, &result.slips);
  CheckEquations(recording, start.placement, selection, externals, 0);
  const Fit fit =
      FitParameters(problem, selection, externals, start, fixed == nullptr, kFewUpdates);
  EstimateAll(problem, base, OfKind(model, base, result.kind, waist_moves), fixed, fit, result);
}

template <typename Work>
CalibrationResult Timed(ModelKind kind, Work work) {
  CalibrationResult result;
  result.kind = kind;
  const auto start = std::chrono::steady_clock::now();
  work(result);
  result.solve_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace

const char* ModelKindName(ModelKind kind) {
  switch (kind) {
    case ModelKind::kUncalibrated:
      return "uncalibrated";
    case ModelKind::kOffsetsOnly:
      return "offsets_only";
    case ModelKind::kGeometric:
      return "geometric";
    default:
      return "full";
  }
}

std::vector<ModelKind> ModelKinds(const ErrorModel& model) {
  std::vector<ModelKind> kinds = {ModelKind::kUncalibrated, ModelKind::kOffsetsOnly,
                                  ModelKind::kGeometric};
  const auto elastic = [](const Parameter& parameter) { return IsElastic(parameter.kind); };
  if (std::any_of(model.parameters.begin(), model.parameters.end(), elastic)) {
    kinds.push_back(ModelKind::kFull);
  }
  return kinds;
}

const char* StatusName(ParameterStatus status) {
  switch (status) {
    case ParameterStatus::kEstimated:
      return "estimated";
    case ParameterStatus::kUnsupported:
      return "unsupported";
    case ParameterStatus::kDropped:
      return "dropped";
    case ParameterStatus::kHeld:
      return "held";
    default:
      return "not_in_model";
  }
}

CalibrationResult Calibrate(const ErrorModel& model, const Recording& recording,
                            const BaseParameters& base, ModelKind kind,
                            const CalibrationOptions& options, const Selection* fixed) {
  return Timed(kind, [&](CalibrationResult& result) {
    const Eigen::VectorXd nominal = Eigen::VectorXd::Zero(model.parameter_count());
    Estimate(model, recording, base, options, fixed, nominal, result);
  });
}

CalibrationResult RefitExternals(const ErrorModel& model, const Recording& recording,
                                 const BaseParameters& base, const CalibrationOptions& options,
                                 const std::map<std::string, double>& joint_errors,
                                 const Selection* fixed) {
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Parameter& parameter = model.parameters[i];
    const auto error = joint_errors.find(parameter.name);
    if (!IsExternal(parameter.kind) && error != joint_errors.end()) delta[i] = error->second;
  }
  return Timed(ModelKind::kUncalibrated, [&](CalibrationResult& result) {
    Estimate(model, recording, base, options, fixed, delta, result);
  });
}

bool Significant(const CalibrationResult& result, int parameter) {
  return result.status[parameter] == ParameterStatus::kEstimated &&
         std::abs(result.delta[parameter]) > result.interval_factor * result.sd[parameter];
}

}  // namespace elastocal
