#include "elastocal/calibration/calibrate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "elastocal/calibration/registration.hpp"
#include "elastocal/calibration/residuals.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr double kSmallestMarkerSd = 1e-9;  // m: of noise-free data
constexpr double kCauchyScale = 3.0;        // of a residual in standard deviations of the noise
constexpr double kMaxPriorScale = 10.0;
constexpr double kRoughTolerance = 1e-8;  // of the cost, while noise and prior are being found
constexpr double kHyperTolerance = 1e-3;  // of noise and prior scale, relative
constexpr int kMaxNoiseUpdates = 50;
constexpr int kMaxVerdicts = 5;

/// A fit: the errors, the noise that they leave, how far they go beyond the prior, and their
/// uncertainty.
struct Fit {
  Eigen::VectorXd delta;
  double marker_sd;
  PriorScale prior_scale = {};
  Posterior posterior;
};

double Change(double before, double after) { return std::abs(std::log(after / before)); }

/// One estimation, from recording to result; carries what all steps share.
class Estimator {
 public:
  Estimator(const Recording& recording, const CalibrationOptions& options,
            CalibrationResult& result)
      : recording_(recording), options_(options), result_(result) {}

  /// Solves for `free` from `start`. Noise and prior weigh against each other and both follow from
  /// the solution: a fixed-point iteration.
  Fit Solve(const ObservationMask& mask, const std::vector<int>& free, const Fit& start,
            bool robust) {
    Fit fit = start;
    if (options_.marker_sd > 0.0) fit.marker_sd = options_.marker_sd;
    for (int update = 0; update < kMaxNoiseUpdates; ++update) {
      SolveOnce(mask, free, fit, robust, kRoughTolerance);
      UpdatePosterior(mask, free, fit);
      const double marker_sd =
          options_.marker_sd > 0.0 ? options_.marker_sd : EstimateNoise(mask, fit, robust);
      const PriorScale prior_scale =
          options_.widen_prior ? EstimatePriorScale(fit) : PriorScale();
      const double change = std::max({Change(fit.marker_sd, marker_sd),
                                      Change(fit.prior_scale.angles, prior_scale.angles),
                                      Change(fit.prior_scale.lengths, prior_scale.lengths)});
      fit.marker_sd = marker_sd;
      fit.prior_scale = prior_scale;
      if (change < kHyperTolerance) break;
    }
    return fit;
  }

  /// Solves to the last digit with noise and prior as they are.
  void Polish(const ObservationMask& mask, const std::vector<int>& free, Fit& fit) {
    SolveOnce(mask, free, fit, false, LeastSquaresOptions().function_tolerance);
  }

  void UpdatePosterior(const ObservationMask& mask, const std::vector<int>& parameters,
                       Fit& fit) const {
    fit.posterior = ComputePosterior(result_.model, recording_, mask, parameters, fit.delta,
                                     options_.prior.Scaled(fit.prior_scale), fit.marker_sd);
  }

  /// Parameters among the fit's that the data say hardly more about than the prior.
  std::vector<int> Unsupported(const Fit& fit) const {
    const Eigen::VectorXd sd = fit.posterior.StandardDeviations();
    std::vector<int> unsupported;
    for (std::size_t i = 0; i < fit.posterior.parameters.size(); ++i) {
      const Parameter& parameter = result_.model.parameters[fit.posterior.parameters[i]];
      if (IsExternal(parameter.kind)) continue;
      // Without a prior there is nothing to compare with but what would be absurd: 0.1 rad or m.
      const double prior_sd = options_.prior.Scaled(fit.prior_scale)[parameter.kind];
      const double limit = std::isfinite(prior_sd) ? options_.support_threshold * prior_sd : 0.1;
      if (sd[static_cast<Eigen::Index>(i)] > limit) {
        unsupported.push_back(fit.posterior.parameters[i]);
      }
    }
    return unsupported;
  }

  std::vector<Outlier> Outliers(const ObservationMask& mask, const Fit& fit) const {
    return FindOutliers(result_.model, recording_, mask, fit.delta, fit.posterior, fit.marker_sd,
                        options_.outlier_probability);
  }

 private:
  void SolveOnce(const ObservationMask& mask, const std::vector<int>& free, Fit& fit, bool robust,
                 double tolerance) {
    MarkerResiduals problem(result_.model, recording_, mask, free, fit.delta,
                            options_.prior.Scaled(fit.prior_scale), fit.marker_sd);
    LeastSquaresOptions solver;
    solver.function_tolerance = tolerance;
    solver.cauchy_scale = robust ? kCauchyScale : 0.0;
    solver.max_iterations = options_.max_iterations;
    const LeastSquaresResult solved =
        elastocal::Solve(problem, problem.FromErrors(fit.delta), solver);
    fit.delta = problem.ToErrors(solved.x);
    result_.termination = solved.termination;
    result_.message = solved.message;
    result_.iterations += solved.iterations;
    result_.initial_cost = solved.initial_cost;
    result_.final_cost = solved.final_cost;
  }

  /// Standard deviation of a marker coordinate; by the median where outliers may be among them.
  double EstimateNoise(const ObservationMask& mask, const Fit& fit, bool robust) const {
    const Eigen::MatrixXd norms = ResidualNorms(result_.model, recording_, fit.delta);
    std::vector<double> squares;
    for (int i = 0; i < mask.rows(); ++i) {
      for (int m = 0; m < mask.cols(); ++m) {
        if (mask(i, m)) squares.push_back(norms(i, m) * norms(i, m));
      }
    }
    const Eigen::Map<const Eigen::VectorXd> s(squares.data(),
                                              static_cast<Eigen::Index>(squares.size()));
    const double equations = 3.0 * static_cast<double>(squares.size());
    const double freedom = std::max(1.0, equations - fit.posterior.effective_parameters);
    const double total = robust ? equations * Median(s) / ChiSquareQuantile(0.5, 3.0) : s.sum();
    return std::max(kSmallestMarkerSd, std::sqrt(total / freedom));
  }

  /// MacKay's update: mean square of the deviations in units of the prior, over as many parameters
  /// as the data determine; never narrower than the prior that was given.
  PriorScale EstimatePriorScale(const Fit& fit) const {
    const auto widened = [&](double scale, bool angles) {
      return std::clamp(scale * RelativeDeviation(fit, angles), 1.0, kMaxPriorScale);
    };
    return {widened(fit.prior_scale.angles, true), widened(fit.prior_scale.lengths, false)};
  }

  /// Root mean square of the joints' angles or lengths in units of the prior as it is now; 1 where
  /// the data determine less than one of them.
  double RelativeDeviation(const Fit& fit, bool angles) const {
    const Prior prior = options_.prior.Scaled(fit.prior_scale);
    double square_sum = 0.0;
    double determined = 0.0;
    for (std::size_t i = 0; i < fit.posterior.parameters.size(); ++i) {
      const int index = fit.posterior.parameters[i];
      const ParameterKind kind = result_.model.parameters[index].kind;
      if (IsExternal(kind) || IsAngle(kind) != angles || !std::isfinite(prior[kind])) continue;
      const auto diagonal = static_cast<Eigen::Index>(i);
      const double variance = prior[kind] * prior[kind];
      square_sum += fit.delta[index] * fit.delta[index] / variance;
      determined += 1.0 - fit.posterior.covariance(diagonal, diagonal) / variance;
    }
    return determined < 1.0 ? 1.0 : std::sqrt(square_sum / determined);
  }

  const Recording& recording_;
  const CalibrationOptions& options_;
  CalibrationResult& result_;
};

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
                    const std::vector<int>& free) {
  const auto equations = 3 * mask.count();
  if (equations >= static_cast<Eigen::Index>(free.size())) return;
  throw InputError(recording.source + ": " + std::to_string(equations) + " equations (" +
                   std::to_string(recording.posture_count()) + " postures, " +
                   std::to_string(recording.marker_count()) + " markers) for " +
                   std::to_string(free.size()) +
                   " parameters; record more postures or hold parameters");
}

void FillStatus(const BaseParameters& base, const std::vector<int>& free,
                const std::vector<int>& unsupported, CalibrationResult& result) {
  result.status.assign(result.model.parameters.size(), ParameterStatus::kNotInModel);
  for (int i : base.held) result.status[i] = ParameterStatus::kHeld;
  for (int i : base.dropped) result.status[i] = ParameterStatus::kDropped;
  for (int i : free) result.status[i] = ParameterStatus::kEstimated;
  for (int i : unsupported) result.status[i] = ParameterStatus::kUnsupported;
}

/// Steps 2 to 4 of Calibrate: from a fit of the externals to the result.
void EstimateAll(const Recording& recording, const BaseParameters& base,
                 const std::vector<int>& free, const CalibrationOptions& options,
                 const ObservationMask* fixed_mask, Fit fit, CalibrationResult& result) {
  Estimator estimator(recording, options, result);
  ObservationMask mask = fixed_mask != nullptr ? *fixed_mask : SeenMask(recording);
  if (fixed_mask == nullptr) {
    fit = estimator.Solve(mask, free, fit, true);
    result.outliers = estimator.Outliers(mask, fit);
    mask = WithoutOutliers(recording, result.outliers);
  }

  std::vector<int> unsupported;
  for (int verdict = 0; verdict < kMaxVerdicts; ++verdict) {
    CheckEquations(recording, mask, free);
    fit = estimator.Solve(mask, free, fit, false);
    unsupported = estimator.Unsupported(fit);
    for (int i : unsupported) fit.delta[i] = 0.0;
    estimator.Polish(mask, Without(free, unsupported), fit);
    estimator.UpdatePosterior(mask, free, fit);
    if (fixed_mask != nullptr) break;
    std::vector<Outlier> outliers = estimator.Outliers(mask, fit);
    const bool stands = SameObservations(outliers, result.outliers);
    result.outliers = std::move(outliers);
    if (stands) break;
    mask = WithoutOutliers(recording, result.outliers);
  }

  result.used = mask;
  result.equations = static_cast<int>(3 * mask.count());
  result.delta = fit.delta;
  result.marker_sd = fit.marker_sd;
  result.prior_scale = fit.prior_scale;
  result.posterior = fit.posterior;
  result.interval_factor =
      StudentQuantile(0.975, std::max(1.0, result.equations - fit.posterior.effective_parameters));
  result.correlations = StrongCorrelations(fit.posterior, options.correlation_threshold);
  FillStatus(base, free, unsupported, result);
  result.sd.setConstant(result.model.parameter_count(), std::numeric_limits<double>::quiet_NaN());
  result.sd(fit.posterior.parameters) = fit.posterior.StandardDeviations();
}

/// Step 1: the nominal waist pose such that T0 starts at zero, and the fit of the externals.
Fit FitExternals(const ErrorModel& model, const Recording& recording, const BaseParameters& base,
                 const CalibrationOptions& options, const ObservationMask* fixed_mask,
                 const Eigen::VectorXd& delta, CalibrationResult& result) {
  result.model = model;
  result.model.T_ref_waist = RegisterWaist(model, recording);
  const ObservationMask mask = fixed_mask != nullptr ? *fixed_mask : SeenMask(recording);
  const std::vector<int> externals = OfKind(model, base, ModelKind::kUncalibrated);
  CheckEquations(recording, mask, externals);
  Estimator estimator(recording, options, result);
  const double rough_sd = std::max(
      kSmallestMarkerSd,
      Median(ResidualNorms(result.model, recording, delta).reshaped().unaryExpr([](double v) {
        return std::isnan(v) ? 0.0 : v;
      })));
  return estimator.Solve(mask, externals, {delta, rough_sd, {}, {}}, fixed_mask == nullptr);
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
