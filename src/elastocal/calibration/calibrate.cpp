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

std::vector<int> OfKind(const ErrorModel& model, const BaseParameters& base, ModelKind kind) {
  std::vector<int> free;
  for (int i : base.kept) {
    const ParameterKind parameter = model.parameters[i].kind;
    const bool offset = parameter == ParameterKind::kTheta;
    if (IsExternal(parameter) || kind == ModelKind::kGeometric ||
        (offset && kind == ModelKind::kOffsetsOnly)) {
      free.push_back(i);
    }
  }
  return free;
}

std::vector<int> Without(const std::vector<int>& all, const std::vector<int>& removed) {
  std::vector<int> rest;
  std::set_difference(all.begin(), all.end(), removed.begin(), removed.end(),
                      std::back_inserter(rest));
  return rest;
}

ObservationMask WithoutOutliers(const Recording& recording, const std::vector<Outlier>& outliers) {
  ObservationMask mask = SeenMask(recording);
  for (const Outlier& outlier : outliers) mask(outlier.posture, outlier.marker) = false;
  return mask;
}

bool SameObservations(const std::vector<Outlier>& a, const std::vector<Outlier>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Outlier& x, const Outlier& y) {
    return x.posture == y.posture && x.marker == y.marker;
  });
}

void CheckEquations(const Recording& recording, const ObservationMask& mask,
                    const std::vector<int>& free, std::size_t outliers) {
  const auto equations = 3 * mask.count();
  if (equations >= static_cast<Eigen::Index>(free.size())) return;
  const std::string left_out =
      outliers == 0 ? "" : ", " + std::to_string(outliers) + " observations left out as outliers";
  throw InputError(recording.source + ": " + std::to_string(equations) + " equations (" +
                   std::to_string(recording.posture_count()) + " postures, " +
                   std::to_string(recording.marker_count()) + " markers" + left_out + ") for " +
                   std::to_string(free.size()) +
                   " parameters; record more postures or hold parameters");
}

/// Median distance between measured and predicted markers, m.
double TypicalResidual(const ErrorModel& model, const Recording& recording,
                       const ObservationMask& mask, const Eigen::VectorXd& delta) {
  const Eigen::MatrixXd norms = ResidualNorms(model, recording, delta);
  std::vector<double> used;
  for (Eigen::Index i = 0; i < mask.rows(); ++i) {
    for (Eigen::Index m = 0; m < mask.cols(); ++m) {
      if (mask(i, m)) used.push_back(norms(i, m));
    }
  }
  return Median(Eigen::Map<Eigen::VectorXd>(used.data(), static_cast<Eigen::Index>(used.size())));
}

void FillStatus(const BaseParameters& base, const std::vector<int>& free,
                const std::vector<int>& unsupported, CalibrationResult& result) {
  result.status.assign(result.model.parameters.size(), ParameterStatus::kNotInModel);
  for (int i : base.held) result.status[i] = ParameterStatus::kHeld;
  for (int i : base.dropped) result.status[i] = ParameterStatus::kDropped;
  for (int i : free) result.status[i] = ParameterStatus::kEstimated;
  for (int i : unsupported) result.status[i] = ParameterStatus::kUnsupported;
}

void FillResult(const BaseParameters& base, const std::vector<int>& free,
                const std::vector<int>& unsupported, const CalibrationOptions& options, Fit fit,
                CalibrationResult& result) {
  result.equations = static_cast<int>(3 * result.used.count());
  result.marker_sd = fit.marker_sd;
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
std::vector<int> HoldUnsupported(const FitProblem& problem, const ObservationMask& mask,
                                 const std::vector<int>& free, Fit& fit) {
  const std::vector<int> unsupported = UnsupportedParameters(problem, fit);
  if (!unsupported.empty()) {
    for (int i : unsupported) fit.delta[i] = 0.0;
    fit = FitParameters(problem, mask, Without(free, unsupported), fit, false);
  }
  Polish(problem, mask, Without(free, unsupported), fit);
  UpdatePosterior(problem, mask, free, fit);
  return unsupported;
}

/// Steps 2 to 4 of Calibrate: from a fit of the externals to the result.
void EstimateAll(const Recording& recording, const BaseParameters& base,
                 const std::vector<int>& free, const CalibrationOptions& options,
                 const ObservationMask* fixed_mask, Fit fit, CalibrationResult& result) {
  const FitProblem problem{result.model, recording, options};
  const auto verdict = [&](const ObservationMask& mask) {
    return FindOutliers(result.model, recording, mask, fit.delta, fit.posterior,
                        {fit.marker_sd, fit.degrees_of_freedom}, options.outlier_probability);
  };
  result.used = fixed_mask != nullptr ? *fixed_mask : SeenMask(recording);
  CheckEquations(recording, result.used, free, 0);
  if (fixed_mask == nullptr) {
    fit = FitParameters(problem, result.used, free, fit, true);
    result.outliers = verdict(result.used);
    result.used = WithoutOutliers(recording, result.outliers);
  }
  std::vector<int> unsupported;
  for (int round = 1;; ++round) {
    CheckEquations(recording, result.used, free, result.outliers.size());
    fit = FitParameters(problem, result.used, free, fit, false);
    unsupported = HoldUnsupported(problem, result.used, free, fit);
    if (fixed_mask != nullptr) break;
    std::vector<Outlier> outliers = verdict(result.used);
    const bool stands = SameObservations(outliers, result.outliers);
    if (!stands && round == kMaxVerdicts) {  // keeps the verdict that the fit was made with
      fit.settled = false;
      break;
    }
    result.outliers = std::move(outliers);
    if (stands) break;
    result.used = WithoutOutliers(recording, result.outliers);
  }
  FillResult(base, free, unsupported, options, std::move(fit), result);
}

/// Step 1: the nominal waist pose such that T0 starts at zero, and the fit of the externals.
Fit FitExternals(const ErrorModel& model, const Recording& recording, const BaseParameters& base,
                 const CalibrationOptions& options, const ObservationMask* fixed_mask,
                 const Eigen::VectorXd& delta, CalibrationResult& result) {
  result.model = model;
  result.model.T_ref_waist = RegisterWaist(model, recording);
  const ObservationMask mask = fixed_mask != nullptr ? *fixed_mask : SeenMask(recording);
  const std::vector<int> externals = OfKind(model, base, ModelKind::kUncalibrated);
  CheckEquations(recording, mask, externals, 0);
  Fit start;
  start.delta = delta;
  start.marker_sd = TypicalResidual(result.model, recording, mask, delta);
  return FitParameters({result.model, recording, options}, mask, externals, start,
                       fixed_mask == nullptr);
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
    default:
      return "geometric";
  }
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
                            const CalibrationOptions& options, const ObservationMask* fixed_mask) {
  return Timed(kind, [&](CalibrationResult& result) {
    const Eigen::VectorXd nominal = Eigen::VectorXd::Zero(model.parameter_count());
    const Fit externals =
        FitExternals(model, recording, base, options, fixed_mask, nominal, result);
    EstimateAll(recording, base, OfKind(model, base, kind), options, fixed_mask, externals, result);
  });
}

CalibrationResult RefitExternals(const ErrorModel& model, const Recording& recording,
                                 const BaseParameters& base, const CalibrationOptions& options,
                                 const std::map<std::string, double>& joint_errors,
                                 const ObservationMask* fixed_mask) {
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Parameter& parameter = model.parameters[i];
    const auto error = joint_errors.find(parameter.name);
    if (!IsExternal(parameter.kind) && error != joint_errors.end()) delta[i] = error->second;
  }
  return Timed(ModelKind::kUncalibrated, [&](CalibrationResult& result) {
    const Fit externals = FitExternals(model, recording, base, options, fixed_mask, delta, result);
    EstimateAll(recording, base, OfKind(model, base, ModelKind::kUncalibrated), options, fixed_mask,
                externals, result);
  });
}

bool Significant(const CalibrationResult& result, int parameter) {
  return result.status[parameter] == ParameterStatus::kEstimated &&
         std::abs(result.delta[parameter]) > result.interval_factor * result.sd[parameter];
}

}  // namespace elastocal
