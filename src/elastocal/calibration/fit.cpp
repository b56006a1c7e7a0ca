#include "elastocal/calibration/fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastocal/calibration/outliers.hpp"
#include "elastocal/calibration/residuals.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr double kSmallestMarkerSd = 1e-9;  // m: of noise-free data
constexpr double kCauchyScale = 3.0;        // of a residual in standard deviations of the noise
constexpr double kAbsurdSd = 0.1;           // rad or m
constexpr double kRoughTolerance = 1e-8;    // of the cost, while noise and prior are being found
constexpr double kHyperTolerance = 1e-3;    // of noise and prior scale, relative
constexpr int kMaxUpdates = 50;

Prior WidenedPrior(const FitProblem& problem, const Fit& fit) {
  return problem.options.prior.Scaled(fit.prior_scale);
}

void SolveOnce(const FitProblem& problem, const ObservationMask& mask, const std::vector<int>& free,
               bool robust, double tolerance, Fit& fit) {
  MarkerResiduals residuals(problem.model, problem.recording, mask, free, fit.delta,
                            WidenedPrior(problem, fit), fit.marker_sd);
  LeastSquaresOptions solver;
  solver.function_tolerance = tolerance;
  solver.cauchy_scale = robust ? kCauchyScale : 0.0;
  solver.max_iterations = problem.options.max_iterations;
  const LeastSquaresResult solved = Solve(residuals, residuals.FromErrors(fit.delta), solver);
  fit.delta = residuals.ToErrors(solved.x);
  fit.termination = solved.termination;
  fit.message = solved.message;
  fit.iterations += solved.iterations;
  fit.initial_cost = solved.initial_cost;
  fit.final_cost = solved.final_cost;
}

/// Standard deviation of a marker coordinate; by the median where outliers may be among them.
double EstimateNoise(const FitProblem& problem, const ObservationMask& mask, const Fit& fit,
                     bool robust) {
  const Eigen::MatrixXd norms = ResidualNorms(problem.model, problem.recording, fit.delta);
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

/// Root mean square of the joints' angles or lengths in units of the prior as it is now, over as
/// many as the data determine (MacKay's update); 1 where that is less than one.
double RelativeDeviation(const FitProblem& problem, const Fit& fit, bool angles) {
  const Prior prior = WidenedPrior(problem, fit);
  double square_sum = 0.0;
  double determined = 0.0;
  for (std::size_t i = 0; i < fit.posterior.parameters.size(); ++i) {
    const int index = fit.posterior.parameters[i];
    const ParameterKind kind = problem.model.parameters[index].kind;
    if (IsExternal(kind) || IsAngle(kind) != angles || !std::isfinite(prior[kind])) continue;
    const auto diagonal = static_cast<Eigen::Index>(i);
    const double variance = prior[kind] * prior[kind];
    square_sum += fit.delta[index] * fit.delta[index] / variance;
    determined += 1.0 - fit.posterior.covariance(diagonal, diagonal) / variance;
  }
  return determined < 1.0 ? 1.0 : std::sqrt(square_sum / determined);
}

/// Never narrower than the prior that was given.
PriorScale EstimatePriorScale(const FitProblem& problem, const Fit& fit) {
  const auto widened = [&](double scale, bool angles) {
    return std::clamp(scale * RelativeDeviation(problem, fit, angles), 1.0, kMaxPriorScale);
  };
  return {widened(fit.prior_scale.angles, true), widened(fit.prior_scale.lengths, false)};
}

double Change(double before, double after) { return std::abs(std::log(after / before)); }

}  // namespace

Fit FitParameters(const FitProblem& problem, const ObservationMask& mask,
                  const std::vector<int>& free, const Fit& start, bool robust) {
  const CalibrationOptions& options = problem.options;
  Fit fit = start;
  fit.marker_sd = std::max(kSmallestMarkerSd, fit.marker_sd);
  if (options.marker_sd > 0.0) fit.marker_sd = options.marker_sd;
  for (int update = 0; update < kMaxUpdates; ++update) {
    SolveOnce(problem, mask, free, robust, kRoughTolerance, fit);
    UpdatePosterior(problem, mask, free, fit);
    const double marker_sd =
        options.marker_sd > 0.0 ? options.marker_sd : EstimateNoise(problem, mask, fit, robust);
    const PriorScale scale = options.widen_prior ? EstimatePriorScale(problem, fit) : PriorScale();
    const double change =
        std::max({Change(fit.marker_sd, marker_sd), Change(fit.prior_scale.angles, scale.angles),
                  Change(fit.prior_scale.lengths, scale.lengths)});
    fit.marker_sd = marker_sd;
    fit.prior_scale = scale;
    if (change < kHyperTolerance) return fit;
  }
  fit.settled = false;
  return fit;
}

void Polish(const FitProblem& problem, const ObservationMask& mask, const std::vector<int>& free,
            Fit& fit) {
  SolveOnce(problem, mask, free, false, LeastSquaresOptions().function_tolerance, fit);
}

void UpdatePosterior(const FitProblem& problem, const ObservationMask& mask,
                     const std::vector<int>& parameters, Fit& fit) {
  fit.posterior = ComputePosterior(problem.model, problem.recording, mask, parameters, fit.delta,
                                   WidenedPrior(problem, fit), fit.marker_sd);
  fit.degrees_of_freedom = problem.options.marker_sd > 0.0
                               ? std::numeric_limits<double>::infinity()
                               : std::max(1.0, 3.0 * static_cast<double>(mask.count()) -
                                                   fit.posterior.effective_parameters);
}

std::vector<int> UnsupportedParameters(const FitProblem& problem, const Fit& fit) {
  const Prior prior = WidenedPrior(problem, fit);
  const std::vector<int>& parameters = fit.posterior.parameters;
  Eigen::VectorXd limits(static_cast<Eigen::Index>(parameters.size()));
  for (Eigen::Index i = 0; i < limits.size(); ++i) {
    const ParameterKind kind = problem.model.parameters[parameters[i]].kind;
    limits[i] = IsExternal(kind)             ? std::numeric_limits<double>::infinity()
                : std::isfinite(prior[kind]) ? problem.options.support_threshold * prior[kind]
                                             : kAbsurdSd;
  }
  std::vector<int> unsupported;
  Eigen::MatrixXd covariance = fit.posterior.covariance;
  while (limits.size() > 0) {
    Eigen::Index worst = 0;
    const double ratio =
        (covariance.diagonal().cwiseMax(0.0).cwiseSqrt().array() / limits.array()).maxCoeff(&worst);
    if (!(ratio > 1.0)) break;
    unsupported.push_back(parameters[worst]);
    // Conditional covariance of the others once it is held.
    const Eigen::VectorXd column = covariance.col(worst);
    covariance -= column * column.transpose() / column[worst];
    covariance.row(worst).setZero();
    covariance.col(worst).setZero();
  }
  std::sort(unsupported.begin(), unsupported.end());
  return unsupported;
}

}  // namespace elastocal
