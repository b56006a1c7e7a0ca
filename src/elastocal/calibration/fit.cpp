// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "elastocal/calibration/motion_correlation.hpp"
#include "elastocal/calibration/variances.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/measurement/moments.hpp"
#include "elastocal/optim/bounded_step.hpp"

namespace elastocal {
namespace {

// Tolerances within which a fit has come to rest. Standard deviations are never known to 1 %, and a
// fit that only looks for gross errors needs less.
constexpr double kStepTolerance = 1e-2;  // of an unknown's standard deviation, root mean square
// Relative change of a standard deviation, weighted by its share.
constexpr double kVarianceTolerance = 1e-2;
constexpr double kWeightTolerance = 1e-2;
// Relative change of samples_each, whose sum ends at an uncertain lag.
constexpr double kMotionTolerance = 0.1;
constexpr int kMotionRounds = 5;
constexpr double kRoughly = 10.0;    // factor on these tolerances in a robust fit
constexpr int kRoughIterations = 5;  // iterations of a solve whose weights will change anyway
constexpr int kMaxSolves = 6;        // solves in Polish, where the iterations of one do not suffice
constexpr int kMaxPolishing = 20;
constexpr double kLoadTolerance = 1e-10;  // of parameters, in units of their scale
// Relative to the step before: slower convergence than this needs a new linearisation.
constexpr double kSlow = 0.3;
constexpr double kWorse = 2.0;  // times the least cost: larger costs mean that the steps lead away

/// Whether an elastic parameter is estimated or nonzero; otherwise loads have no effect.
bool IsElasticFit(const ErrorModel& model, const std::vector<int>& free,
                  const Eigen::VectorXd& delta) {
  const auto elastic = [&](int i) { return IsElastic(model.parameters[i].kind); };
  if (std::any_of(free.begin(), free.end(), elastic)) return true;
  for (int i = 0; i < model.parameter_count(); ++i) {
    if (elastic(i) && delta[i] != 0.0) return true;
  }
  return false;
}

void Take(const BodyResiduals& body, const Eigen::VectorXd& x, Fit& fit) {
  fit.delta = body.ToErrors(x);
  fit.placement = body.ToPlacement(x);
}

void SolveOnce(const FitProblem& problem, const Selection& selection, const std::vector<int>& free,
               const LeastSquaresOptions& options, Fit& fit) {
  FitResiduals residuals(problem, selection, free, fit);
  const LeastSquaresResult solved = Solve(residuals.body, residuals.body.Start(), options);
  Take(residuals.body, solved.x, fit);
  fit.termination = solved.termination;
  fit.message = solved.message;
  fit.iterations += solved.iterations;
  fit.initial_cost = solved.initial_cost;
  fit.final_cost = solved.final_cost;
}

/// The largest relative change of a source's standard deviation, weighted by the source's share in
/// its rows.
double NoiseChange(const Noise& before, const Noise& after, const VarianceComponents& components) {
  double change = 0.0;
  for (int g = 0; g < before.group_count(); ++g) {
    for (int s = 0; s < kNoiseSourceCount; ++s) {
      const VarianceComponent& component = components[g][s];
      if (component.rows <= 0.0) continue;
      const double share = component.weight / component.rows;
      change = std::max(change, share * std::abs(std::log(after.sd(g, s) / before.sd(g, s))));
    }
  }
  return change;
}

double ScaleChange(const PriorScale& before, const PriorScale& after) {
  double change = 0.0;
  for (int g = 0; g < kPriorGroupCount; ++g) {
    change = std::max(change, std::abs(std::log(after.factor[g] / before.factor[g])));
  }
  return change;
}

double WeightChange(const RobustWeights& before, const RobustWeights& after) {
  if (before.bodies.size() != after.bodies.size()) return 1.0;
  double change = 0.0;
  for (std::size_t b = 0; b < after.bodies.size(); ++b) {
    change = std::max({change, std::abs(after.bodies[b].shared - before.bodies[b].shared),
                       std::abs(after.bodies[b].own - before.bodies[b].own)});
  }
  for (std::size_t i = 0; i < after.ties.size(); ++i) {
    change = std::max(change, std::abs(after.ties[i] - before.ties[i]));
  }
  return change;
}

/// The largest relative change of `samples_each` over groups.
double MotionChange(const Noise& before, const Noise& after) {
  if (before.motion.size() != after.motion.size()) return 1.0;
  const auto change = [](const Autocorrelation& a, const Autocorrelation& b) {
    return std::abs(std::log(a.samples_each / b.samples_each));
  };
  double largest = 0.0;
  for (std::size_t g = 0; g < after.motion.size(); ++g) {
    largest = std::max({largest, change(after.motion[g].bodies, before.motion[g].bodies),
                        change(after.motion[g].waist, before.motion[g].waist)});
  }
  return largest;
}

/// Makes one Gauss-Newton step and estimates noise, weights and prior scale from the same
/// linearisation, so that they converge together. Returns whether all have come to rest.
/// `explained` (what the fit explains of each row, by residual block) takes most of the time: where
/// it is not empty, the values of the update before are used again.
bool UpdateByStep(const FitProblem& problem, const Selection& selection,
                  const std::vector<int>& free, Robustness robustness, ExplainedRows& explained,
                  Fit& fit) {
  FitResiduals residuals(problem, selection, free, fit);
  BodyResiduals& body = residuals.body;
  const Eigen::VectorXd x = body.Start();
  body.Evaluate(x, true);
  const double cost = CostOf(body);
  const NormalEquations equations(body);
  const bool anew = explained.all.empty();
  if (anew) {
    explained = equations.ExplainedVariances(TakeCovariance(problem, free, equations, fit));
  }
  const Eigen::VectorXd step =
      BoundedStep(equations.information(), equations.gradient(), x(equations.unknowns()),
                  equations.Positions(body.nonnegative));
  const Eigen::VectorXd next = x + equations.Expand(step);
  ++fit.iterations;
  body.Evaluate(next, false);
  const double tolerance = robustness == Robustness::kMedians ? kRoughly : 1.0;
  const double mean_square =  // of the step, in standard deviations
      -equations.gradient().dot(step) / static_cast<double>(step.size());
  const bool small = mean_square < std::pow(tolerance * kStepTolerance, 2);
  if (!small && !(CostOf(body) <= cost)) {  // far from the solution: damped steps
    SolveOnce(problem, selection, free,
              {.max_iterations = kRoughIterations, .function_tolerance = 1e-8}, fit);
    body.Evaluate(x, false);  // noise by the residuals before: it will be found from the next ones
    fit.weights = EstimateWeights(problem, selection, fit.noise, body, robustness);
    return false;
  }
  Take(body, next, fit);
  const VarianceComponents components =
      CollectComponents(problem, selection, fit.noise, body, explained);
  fit.degrees_of_freedom = DegreesOfFreedom(problem.options, components);
  Noise noise = EstimateNoise(problem.options, fit.noise, components, robustness);
  const RobustWeights weights = EstimateWeights(problem, selection, noise, body, robustness);
  PriorScale scale = fit.prior_scale;
  if (anew && problem.options.widen_prior) scale = EstimatePriorScale(problem, fit);
  const bool settled = small &&
                       NoiseChange(fit.noise, noise, components) < tolerance * kVarianceTolerance &&
                       ScaleChange(fit.prior_scale, scale) < tolerance * kVarianceTolerance &&
                       WeightChange(fit.weights, weights) < tolerance * kWeightTolerance;
  fit.noise = noise;
  fit.weights = weights;
  fit.prior_scale = scale;
  return settled;
}

/// Estimates the correlation within motions from the residuals of a settled fit (earlier, noise and
/// correlation would oscillate). Returns whether it has hardly changed.
bool UpdateMotion(const FitProblem& problem, const Selection& selection,
                  const std::vector<int>& free, const ExplainedRows& explained, Fit& fit) {
  if (!HasMotion(problem.recording)) return true;
  FitResiduals residuals(problem, selection, free, fit);
  residuals.body.Evaluate(residuals.body.Start(), false);
  Noise noise = fit.noise;
  noise.motion = FindMotionCorrelation(problem, selection, noise, residuals.body, explained);
  const bool same = MotionChange(fit.noise, noise) < kMotionTolerance;
  fit.noise = noise;
  return same;
}

/// Starting from a solution for fixed loads, makes steps after each of which the loads follow the
/// solution. One linearisation serves all steps, because the information hardly changes, unless the
/// steps shrink slowly. If a step leads away, the solution before it is kept: noise that is
/// estimated far too small makes the information nearly singular.
void FollowLoads(const FitProblem& problem, const Selection& selection,
                 const std::vector<int>& free, Fit& fit) {
  FitResiduals residuals(problem, selection, free, fit);
  BodyResiduals& body = residuals.body;
  Eigen::VectorXd x = body.Start();
  body.Evaluate(x, true);
  std::optional<NormalEquations> equations(std::in_place, body);
  double before = std::numeric_limits<double>::infinity();
  double cost = CostOf(body), least = cost;
  for (int round = 0; round < kMaxPolishing; ++round) {
    const Eigen::VectorXd step =
        BoundedStep(equations->information(), equations->gradient(), x(equations->unknowns()),
                    equations->Positions(body.nonnegative));
    const Eigen::VectorXd next = x + equations->Expand(step);
    ++fit.iterations;
    residuals.loads = ComputeLoads(problem.model, problem.recording, body.ToErrors(next),
                                   body.ToPlacement(next), problem.options.load);
    body.LoadsFollow(next);
    body.Evaluate(next, true);
    const double found = CostOf(body);
    if (!(found < kWorse * least)) break;
    x = next;
    cost = found;
    least = std::min(least, cost);
    const double change = step.cwiseAbs().maxCoeff();
    if (change < kLoadTolerance) break;
    if (change < kSlow * before) {
      equations->UpdateGradient();
    } else {
      equations.emplace(body);
    }
    before = change;
  }
  Take(body, x, fit);
  fit.final_cost = cost;
}

}  // namespace

Prior WidenedPrior(const FitProblem& problem, const Fit& fit) {
  Prior prior = problem.options.prior;
  prior.scale = fit.prior_scale;
  return prior;
}

FitResiduals::FitResiduals(const FitProblem& problem, const Selection& selection,
                           const std::vector<int>& free, const Fit& fit)
    : prior(WidenedPrior(problem, fit)),
      noise(fit.noise),
      weights(fit.weights.bodies.size() == selection.bodies.size() ? fit.weights : RobustWeights()),
      placement(fit.placement),
      loads(IsElasticFit(problem.model, free, fit.delta)
                ? ComputeLoads(problem.model, problem.recording, fit.delta, fit.placement,
                               problem.options.load)
                : std::vector<PostureLoads>()),
      body({problem.model, problem.recording, problem.group, selection, loads, prior, noise,
            weights, problem.options},
           free, fit.delta, placement) {}

Fit StartFit(const FitProblem& problem, const Selection& selection, const Eigen::VectorXd& delta) {
  Fit fit;
  fit.delta = delta;
  fit.placement = RegisterPlacement(problem.model, problem.recording, problem.options.slip);
  const int groups =
      problem.group.empty() ? 1 : 1 + *std::max_element(problem.group.begin(), problem.group.end());
  fit.noise.sd.setOnes(groups, kNoiseSourceCount);
  FitResiduals residuals(problem, selection, {}, fit);
  residuals.body.Evaluate(residuals.body.Start(), false);
  std::vector<std::vector<double>> distances(groups);
  std::vector<char> several(groups, 0);  // whether any body of the group has several markers
  for (int b = 0; b < residuals.body.body_count(); ++b) {
    const BodyObservation& body = selection.bodies[b];
    if (!body.used) continue;
    const Eigen::VectorXd& residual = residuals.body.Residual(b);
    const double norm = (residual.array() * residuals.body.Sds(b).array()).matrix().norm() /
                        std::sqrt(static_cast<double>(body.markers.size()));
    distances[problem.group[body.posture]].push_back(norm);
    if (body.markers.size() > 1) several[problem.group[body.posture]] = 1;
  }
  for (int g = 0; g < groups; ++g) {
    const Eigen::Map<const Eigen::VectorXd> all(distances[g].data(),
                                                static_cast<Eigen::Index>(distances[g].size()));
    const double sd = distances[g].empty() ? 1.0 : std::max(kSmallestMarkerSd, Median(all));
    const bool given = problem.options.marker_sd > 0.0;
    const double shared = several[g] != 0 || given ? sd : 1e-3 * sd;
    fit.noise(g, NoiseSource::kMarker) = given ? problem.options.marker_sd : sd;
    fit.noise(g, NoiseSource::kBodyPosition) = shared;
    fit.noise(g, NoiseSource::kWaistPosition) = fit.noise(g, NoiseSource::kWaistRotation) = sd;
  }
  return fit;
}

void CorrelateMotions(const FitProblem& problem, const Selection& selection,
                      const std::vector<int>& free, Fit& fit) {
  if (!HasMotion(problem.recording)) return;
  FitResiduals residuals(problem, selection, free, fit);
  residuals.body.Evaluate(residuals.body.Start(), true);
  const NormalEquations equations(residuals.body);
  const ExplainedRows explained =
      equations.ExplainedVariances(InverseOfInformation(equations.information()));
  fit.noise.motion =
      FindMotionCorrelation(problem, selection, fit.noise, residuals.body, explained);
}

Fit FitParameters(const FitProblem& problem, const Selection& selection,
                  const std::vector<int>& free, const Fit& start, Robustness robustness,
                  int updates) {
  Fit fit = start;
  ExplainedRows explained;
  bool settled = false;
  int rounds = 0;  // of correlations in motions
  const int most = std::min(updates, problem.options.max_iterations);
  for (int update = 0; update < most && !settled; ++update) {
    // More updates with the same `explained` would make the noise oscillate.
    const bool anew = update % 2 == 0;
    if (anew) explained = {};
    settled = UpdateByStep(problem, selection, free, robustness, explained, fit) &&
              (anew || robustness == Robustness::kMedians);
    if (settled && robustness == Robustness::kMoments && rounds < kMotionRounds) {
      settled = UpdateMotion(problem, selection, free, explained, fit);
      ++rounds;
    }
  }
  if (!settled) fit.settled = fit.settled && updates < kMaxUpdates;
  return fit;
}

void Polish(const FitProblem& problem, const Selection& selection, const std::vector<int>& free,
            Fit& fit) {
  for (int round = 0; round < kMaxSolves; ++round) {
    SolveOnce(problem, selection, free, {.max_iterations = problem.options.max_iterations}, fit);
    const bool goes_on = fit.termination == Termination::kNoConvergence;
    if (!goes_on || !IsElasticFit(problem.model, free, fit.delta)) break;
  }
  if (fit.termination == Termination::kConverged && IsElasticFit(problem.model, free, fit.delta)) {
    FollowLoads(problem, selection, free, fit);
  }
  if (!fit.settled && problem.options.max_iterations < kMaxUpdates &&
      fit.termination == Termination::kConverged) {
    fit.termination = Termination::kNoConvergence;
    fit.message = "the iterations were used up before noise and prior came to rest";
  }
}

}  // namespace elastocal
