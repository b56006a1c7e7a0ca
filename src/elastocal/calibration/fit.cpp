#include "elastocal/calibration/fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastocal/calibration/fit_residuals.hpp"
#include "elastocal/calibration/outliers.hpp"
#include "elastocal/calibration/variances.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/optim/normal_equations.hpp"

namespace elastocal {
namespace {

constexpr double kCauchyScale = 3.0;      // of a residual in standard deviations of the noise
constexpr double kAbsurdSd = 0.1;         // rad or m
constexpr double kRoughTolerance = 1e-8;  // of the cost, while noise and prior are being found
constexpr double kSlightDecrease = 1e-6;  // likewise, of a step ...
constexpr double kRobustDecrease = 1e-3;  // ... and of the robust fit to trials
constexpr double kHyperTolerance = 1e-3;  // of noise and prior scale, relative ...
constexpr double kTrialTolerance = 1e-2;  // ... and of trials, whose constraints take longer
constexpr int kTrialIterations = 3;       // of a solve whose weights will change anyway
constexpr int kMaxPolishing = 6;
constexpr double kLoadTolerance = 1e-10;  // of parameters in units of their scale

void SolveOnce(const FitProblem& problem, const Selection& selection, const std::vector<int>& free,
               bool robust, double tolerance, Fit& fit) {
  FitResiduals residuals(problem, selection, free, fit);
  LeastSquaresOptions solver;
  solver.function_tolerance = tolerance;
  solver.cauchy_scale = robust ? kCauchyScale : 0.0;
  solver.max_iterations = problem.options.max_iterations;
  const bool rough = tolerance > LeastSquaresOptions().function_tolerance;
  if (rough && !fit.placement.empty()) {
    solver.max_iterations = std::min(solver.max_iterations, kTrialIterations);
  }
  const LeastSquaresResult solved = Solve(residuals.body, residuals.body.Start(), solver);
  fit.delta = residuals.body.ToErrors(solved.x);
  fit.placement = residuals.body.ToPlacement(solved.x);
  fit.termination = solved.termination;
  fit.message = solved.message;
  fit.iterations += solved.iterations;
  fit.initial_cost = solved.initial_cost;
  fit.final_cost = solved.final_cost;
}

/// At which change noise and prior have come to rest. The robust fit to trials, which costs most,
/// only has to find what lies far off.
double Tolerance(const Fit& fit, bool robust) {
  if (fit.placement.empty()) return kHyperTolerance;
  return robust ? 10.0 * kTrialTolerance : kTrialTolerance;
}

/// The residuals as last evaluated; gives the number of those that take part.
double TakeResiduals(const BodyResiduals& body, Fit& fit) {
  fit.meanings = body.meanings();
  fit.residuals.clear();
  double rows = 0.0;
  for (std::size_t block = 0; block < fit.meanings.size(); ++block) {
    const auto& shape = body.residual_blocks[block];
    Eigen::VectorXd& residual = fit.residuals.emplace_back(shape.size);
    body.Residual(static_cast<int>(block),
                  Eigen::Map<Eigen::VectorXd>(residual.data(), residual.size()));
    if (shape.active) rows += shape.size;
  }
  return rows;
}

void UpdateResiduals(const FitProblem& problem, const Selection& selection,
                     const std::vector<int>& free, Fit& fit) {
  FitResiduals residuals(problem, selection, free, fit);
  residuals.body.Evaluate(residuals.body.Start(), false);
  TakeResiduals(residuals.body, fit);
}

void TakeFreedom(const FitProblem& problem, double rows_left, Fit& fit) {
  fit.degrees_of_freedom = problem.options.marker_sd > 0.0 ? std::numeric_limits<double>::infinity()
                                                           : std::max(1.0, rows_left);
}

/// Takes noise and, if asked to, prior scale from the residuals and the posterior of the fit.
/// Whether they have come to rest.
bool UpdateVariances(const FitProblem& problem, const std::vector<VarianceComponent>& components,
                     bool robust, Fit& fit) {
  const Noise noise = EstimateNoise(problem.options, fit.noise, components, robust);
  const PriorScale scale =
      problem.options.widen_prior ? EstimatePriorScale(problem, fit) : PriorScale();
  const double change = LargestChange(fit.noise, fit.prior_scale, noise, scale);
  fit.noise = noise;
  fit.prior_scale = scale;
  return change < Tolerance(fit, robust);
}

/// One Gauss-Newton step and, from the same linearisation, noise and prior scale: they converge
/// together, instead of the one waiting for the other. Whether they have.
bool UpdateByStep(const FitProblem& problem, const Selection& selection,
                  const std::vector<int>& free, bool robust, Fit& fit) {
  const double cauchy_scale = robust ? kCauchyScale : 0.0;
  FitResiduals residuals(problem, selection, free, fit);
  BodyResiduals& body = residuals.body;
  const Eigen::VectorXd x = body.Start();
  const NormalEquations equations(body, x, body.WaistBlocks(), RowComponents(body, problem.group),
                                  cauchy_scale);
  const Eigen::MatrixXd information =
      WithVaguePrior(problem.model, free, residuals.prior, equations.information());
  const Eigen::MatrixXd covariance =
      TakeCovariance(problem.model, free, residuals.prior, information, fit.posterior);
  const Eigen::VectorXd step =
      BoundedStep(information, equations.gradient(), x(equations.unknowns()), body.nonnegative);
  const Eigen::VectorXd next = x + equations.Expand(step);
  ++fit.iterations;
  body.Evaluate(next, false);
  const double slight = robust && !fit.placement.empty() ? kRobustDecrease : kSlightDecrease;
  const bool small = -equations.gradient().dot(step) < slight * (1.0 + equations.cost());
  if (!small &&
      !(CostOf(body, cauchy_scale) <= equations.cost())) {  // far from the solution: damped steps
    SolveOnce(problem, selection, free, robust, kRoughTolerance, fit);
    UpdateResiduals(problem, selection, free, fit);
  } else {
    fit.delta = body.ToErrors(next);
    fit.placement = body.ToPlacement(next);
    TakeResiduals(body, fit);
  }
  std::vector<VarianceComponent> components = ComponentsOf(problem, selection, fit);
  const Eigen::VectorXd explained = equations.Explained(covariance);
  double rows = 0.0;
  for (Eigen::Index k = 0; k < explained.size(); ++k) {
    components[k].explained = explained[k];
    rows += components[k].rows;
  }
  TakeFreedom(problem, rows - explained.sum(), fit);
  return UpdateVariances(problem, components, robust, fit) && small;
}

}  // namespace

Selection SelectAll(const Recording& recording) {
  return {SeenMask(recording), std::vector<char>(recording.posture_count(), 1)};
}

Fit StartFit(const FitProblem& problem, const Selection& selection, const Eigen::VectorXd& delta) {
  Fit fit;
  fit.delta = delta;
  fit.placement = RegisterPlacement(problem.model, problem.recording, problem.options.slip);
  const int groups =
      problem.group.empty() ? 1 : 1 + *std::max_element(problem.group.begin(), problem.group.end());
  fit.noise.marker_sd.setOnes(groups);
  fit.noise.waist_position_sd.setOnes(groups);
  fit.noise.waist_rotation_sd.setOnes(groups);
  FitResiduals residuals(problem, selection, {}, fit);
  residuals.body.Evaluate(residuals.body.Start(), false);
  std::vector<std::vector<double>> norms(groups);
  for (std::size_t block = 0; block < residuals.body.meanings().size(); ++block) {
    const auto [posture, marker] = residuals.body.meanings()[block];
    if (marker < 0 || !selection.markers(posture, marker)) continue;
    Eigen::Vector3d residual;
    residuals.body.Residual(static_cast<int>(block),
                            Eigen::Map<Eigen::VectorXd>(residual.data(), 3));
    norms[problem.group[posture]].push_back(residual.norm());
  }
  for (int g = 0; g < groups; ++g) {
    const Eigen::Map<const Eigen::VectorXd> all(norms[g].data(),
                                                static_cast<Eigen::Index>(norms[g].size()));
    const double sd = norms[g].empty() ? 1.0 : std::max(kSmallestMarkerSd, Median(all));
    fit.noise.marker_sd[g] = problem.options.marker_sd > 0.0 ? problem.options.marker_sd : sd;
    fit.noise.waist_position_sd[g] = fit.noise.waist_rotation_sd[g] = sd;
  }
  return fit;
}

Fit FitParameters(const FitProblem& problem, const Selection& selection,
                  const std::vector<int>& free, const Fit& start, bool robust, int updates) {
  Fit fit = start;
  bool settled = false;
  const int most = std::min(updates, problem.options.max_iterations);
  for (int update = 0; update < most && !settled; ++update) {
    settled = UpdateByStep(problem, selection, free, robust, fit);
  }
  if (!settled) fit.settled = fit.settled && updates < kMaxUpdates;
  if (robust) UpdatePosterior(problem, selection, free, fit);
  return fit;
}

void Polish(const FitProblem& problem, const Selection& selection, const std::vector<int>& free,
            Fit& fit) {
  Eigen::VectorXd scale(problem.model.parameter_count());
  for (int i = 0; i < scale.size(); ++i) {
    scale[i] = ParameterScale(problem.model.parameters[i], problem.options.prior);
  }
  for (int round = 0; round < kMaxPolishing; ++round) {
    const Eigen::VectorXd before = fit.delta;
    SolveOnce(problem, selection, free, false, LeastSquaresOptions().function_tolerance, fit);
    const double change = (fit.delta - before).cwiseQuotient(scale).cwiseAbs().maxCoeff();
    if (!IsElasticFit(problem.model, free, fit.delta) || change < kLoadTolerance) break;
  }
  if (!fit.settled && problem.options.max_iterations < kMaxUpdates &&
      fit.termination == Termination::kConverged) {
    fit.termination = Termination::kNoConvergence;
    fit.message = "the iterations were used up before noise and prior came to rest";
  }
}

void UpdatePosterior(const FitProblem& problem, const Selection& selection,
                     const std::vector<int>& parameters, Fit& fit) {
  FitResiduals residuals(problem, selection, parameters, fit);
  fit.posterior = ComputePosterior(problem.model, residuals.body, parameters,
                                   residuals.body.Start(), residuals.prior);
  const double rows = TakeResiduals(residuals.body, fit);
  TakeFreedom(problem, rows - fit.posterior.effective_parameters, fit);
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
