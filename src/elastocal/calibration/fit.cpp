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
constexpr double kLeastTieShare = 0.1;      // of the marker noise [m, rad]: no constraint is better
constexpr double kCauchyScale = 3.0;        // of a residual in standard deviations of the noise
constexpr double kAbsurdSd = 0.1;           // rad or m
constexpr double kRoughTolerance = 1e-8;    // of the cost, while noise and prior are being found
constexpr double kHyperTolerance = 1e-3;    // of noise and prior scale, relative ...
constexpr double kTrialTolerance = 1e-2;    // ... and of trials, whose constraints take longer
constexpr int kTrialIterations = 3;         // of a solve whose weights will change anyway
constexpr int kMaxPolishing = 6;
constexpr double kLoadTolerance = 1e-10;  // of parameters in units of their scale

Prior WidenedPrior(const FitProblem& problem, const Fit& fit) {
  return problem.options.prior.Scaled(fit.prior_scale);
}

/// Whether any elastic parameter is estimated or known: else loads do not matter.
bool IsElasticFit(const ErrorModel& model, const std::vector<int>& free,
                  const Eigen::VectorXd& delta) {
  const auto elastic = [&](int i) { return IsElastic(model.parameters[i].kind); };
  if (std::any_of(free.begin(), free.end(), elastic)) return true;
  for (int i = 0; i < model.parameter_count(); ++i) {
    if (elastic(i) && delta[i] != 0.0) return true;
  }
  return false;
}

/// The residuals of a fit as it stands, with all that they refer to.
struct Residuals {
  Residuals(const FitProblem& problem, const Selection& selection, const std::vector<int>& free,
            const Fit& fit)
      : prior(WidenedPrior(problem, fit)),
        noise(fit.noise),
        placement(fit.placement),
        loads(IsElasticFit(problem.model, free, fit.delta)
                  ? ComputeLoads(problem.model, problem.recording, fit.delta, fit.placement,
                                 problem.options.load)
                  : std::vector<PostureLoads>()),
        body({problem.model, problem.recording, problem.group, selection.markers, selection.tied,
              loads, prior, noise, problem.options.support_form},
             free, fit.delta, placement) {}
  Residuals(const Residuals&) = delete;
  Residuals& operator=(const Residuals&) = delete;

  Prior prior;
  Noise noise;
  Placement placement;
  std::vector<PostureLoads> loads;
  BodyResiduals body;
};

void SolveOnce(const FitProblem& problem, const Selection& selection, const std::vector<int>& free,
               bool robust, double tolerance, Fit& fit) {
  Residuals residuals(problem, selection, free, fit);
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

/// Sum of squares of residuals that share a standard deviation, in units of it, and what of their
/// number the fit explains.
class VarianceComponent {
 public:
  void Add(const Eigen::Ref<const Eigen::VectorXd>& residual, double explained) {
    squares_.push_back(residual.squaredNorm());
    rows_ += static_cast<double>(residual.size());
    explained_ += explained;
    size_ = static_cast<double>(residual.size());
  }
  bool empty() const { return squares_.empty(); }

  /// By how much the standard deviation has to be multiplied; by the median where outliers may be
  /// among the residuals.
  double Factor(bool robust) const {
    const Eigen::Map<const Eigen::VectorXd> s(squares_.data(),
                                              static_cast<Eigen::Index>(squares_.size()));
    const double total = robust ? rows_ * Median(s) / ChiSquareQuantile(0.5, size_) : s.sum();
    // The share that is left over is positive; a hundredth of the rows where it is all but zero.
    return std::sqrt(total / std::max({1.0, 0.01 * rows_, rows_ - explained_}));
  }

 private:
  std::vector<double> squares_;
  double rows_ = 0.0, explained_ = 0.0, size_ = 3.0;
};

/// The noise as the residuals of the last posterior have it.
Noise EstimateNoise(const FitProblem& problem, const Selection& selection, const Fit& fit,
                    bool robust) {
  const int groups = fit.noise.group_count();
  std::vector<VarianceComponent> markers(groups), positions(groups), rotations(groups);
  const auto by_rows = [&](std::size_t block, int first) {
    return fit.posterior.explained[block].diagonal().segment<3>(first).sum();
  };
  for (std::size_t block = 0; block < fit.meanings.size(); ++block) {
    const auto [posture, marker] = fit.meanings[block];
    const int group = problem.group[posture];
    const Eigen::VectorXd& residual = fit.residuals[block];
    if (marker >= 0) {
      if (selection.markers(posture, marker)) markers[group].Add(residual, by_rows(block, 0));
    } else if (selection.tied[posture] != 0) {
      positions[group].Add(residual.head<3>(), by_rows(block, 0));
      rotations[group].Add(residual.tail<3>(), by_rows(block, 3));
    }
  }
  Noise noise = fit.noise;
  for (int g = 0; g < groups; ++g) {
    if (problem.options.marker_sd > 0.0) {
      noise.marker_sd[g] = problem.options.marker_sd;
    } else if (!markers[g].empty()) {
      noise.marker_sd[g] =
          std::max(kSmallestMarkerSd, noise.marker_sd[g] * markers[g].Factor(robust));
    }
    if (positions[g].empty() || problem.options.support_form == SupportForm::kFootRooted) continue;
    const double least = kLeastTieShare * noise.marker_sd[g];
    noise.waist_position_sd[g] =
        std::max(least, noise.waist_position_sd[g] * positions[g].Factor(robust));
    noise.waist_rotation_sd[g] =
        std::max(least, noise.waist_rotation_sd[g] * rotations[g].Factor(robust));
  }
  return noise;
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
    if (IsExternal(kind) || IsElastic(kind) || IsAngle(kind) != angles ||
        !std::isfinite(prior[kind])) {
      continue;
    }
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

/// Largest relative change from one entry to the other.
double Change(const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
  return (after.array() / before.array()).log().abs().maxCoeff();
}

/// At which change noise and prior have come to rest. The robust fit to trials, which costs most,
/// only has to find what lies far off.
double Tolerance(const Fit& fit, bool robust) {
  if (fit.placement.empty()) return kHyperTolerance;
  return robust ? 10.0 * kTrialTolerance : kTrialTolerance;
}

double Change(double before, double after) { return std::abs(std::log(after / before)); }

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
  Residuals residuals(problem, selection, free, fit);
  residuals.body.Evaluate(residuals.body.Start(), false);
  TakeResiduals(residuals.body, fit);
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
  Residuals residuals(problem, selection, {}, fit);
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
  for (int update = 0; update < updates; ++update) {
    SolveOnce(problem, selection, free, robust, kRoughTolerance, fit);
    // Of the robust fit to trials only the residuals are new from step to step: what of them the
    // fit explains hardly changes, and takes longest.
    const bool same = robust && !fit.placement.empty() && update > 1;
    if (same) {
      UpdateResiduals(problem, selection, free, fit);
    } else {
      UpdatePosterior(problem, selection, free, fit);
    }
    const Noise noise = EstimateNoise(problem, selection, fit, robust);
    const PriorScale scale =
        problem.options.widen_prior ? EstimatePriorScale(problem, fit) : PriorScale();
    const double change = std::max({Change(fit.noise.marker_sd, noise.marker_sd),
                                    Change(fit.noise.waist_position_sd, noise.waist_position_sd),
                                    Change(fit.noise.waist_rotation_sd, noise.waist_rotation_sd),
                                    Change(fit.prior_scale.angles, scale.angles),
                                    Change(fit.prior_scale.lengths, scale.lengths)});
    fit.noise = noise;
    fit.prior_scale = scale;
    if (change < Tolerance(fit, robust)) {
      if (same) UpdatePosterior(problem, selection, free, fit);
      return fit;
    }
  }
  fit.settled = fit.settled && updates < kMaxUpdates;
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
    if (!IsElasticFit(problem.model, free, fit.delta) || change < kLoadTolerance) return;
  }
}

void UpdatePosterior(const FitProblem& problem, const Selection& selection,
                     const std::vector<int>& parameters, Fit& fit) {
  Residuals residuals(problem, selection, parameters, fit);
  fit.posterior = ComputePosterior(problem.model, residuals.body, parameters,
                                   residuals.body.Start(), residuals.prior);
  const double rows = TakeResiduals(residuals.body, fit);
  fit.degrees_of_freedom = problem.options.marker_sd > 0.0
                               ? std::numeric_limits<double>::infinity()
                               : std::max(1.0, rows - fit.posterior.effective_parameters);
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
