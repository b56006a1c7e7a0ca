// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/observation_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "elastocal/calibration/posterior.hpp"
#include "elastocal/math/dense.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/optim/bounded_step.hpp"
#include "elastocal/optim/normal_equations.hpp"

namespace elastocal {
namespace {

constexpr double kSettled = 1e-4;         // relative change of a standard deviation
constexpr double kRoughlySettled = 1e-2;  // for a fit that only looks for outliers
constexpr double kSlightStep = 1e-9;      // relative to the cost
constexpr double kLeastNoise = 1e-9;      // SI: rounding
constexpr double kLeastOfGuess = 5e-3;    // smallest ratio of an instrument's noise to its guess
constexpr double kHuberShare = 0.99;      // share of observations whose weight is 1
constexpr double kLeastRows = 0.01;       // smallest share of rows that counts as left
// Degrees of freedom of the Student distribution of observations.
constexpr double kGrossFreedom = 4.0;

/// Sums over the rows of one source: squares in units of its standard deviation, number of rows,
/// the share that the fit explains, and the square of each row of an observation.
struct SourceSum {
  double squares = 0.0, rows = 0.0, explained = 0.0;
  double own = 1.0;  // Source::own_weight
  std::vector<double> of_observations;
};

std::vector<SourceSum> SumBySource(const ObservationResiduals& residuals,
                                   const ObservedRobot& model, const Observations& observations,
                                   const std::vector<Eigen::VectorXd>& explained) {
  std::vector<SourceSum> sums(model.setup.sources.size());
  for (std::size_t s = 0; s < sums.size(); ++s) sums[s].own = model.setup.sources[s].own_weight;
  for (std::size_t b = 0; b < residuals.residual_blocks.size(); ++b) {
    if (!residuals.residual_blocks[b].active) continue;
    const int block = static_cast<int>(b);
    const std::vector<int>& sources = residuals.Sources(block);
    for (std::size_t row = 0; row < sources.size(); ++row) {
      const auto r = static_cast<Eigen::Index>(row);
      SourceSum& sum = sums[sources[row]];
      const double square = residuals.Residual(block)[r] * residuals.Residual(block)[r];
      sum.squares += square;
      sum.rows += 1.0;
      sum.explained += explained[b][r];
      if (block < observations.count()) sum.of_observations.push_back(square);
    }
  }
  return sums;
}

/// Number of numbers from which a standard deviation is estimated.
double FreedomOf(const SourceSum& sum) {
  return std::max(kLeastRows * sum.rows, sum.rows - sum.explained) + sum.own;
}

std::vector<double> FreedomBySource(const std::vector<SourceSum>& sums,
                                    const std::vector<Source>& sources) {
  std::vector<double> freedom(sums.size(), std::numeric_limits<double>::infinity());
  for (std::size_t s = 0; s < sums.size(); ++s) {
    if (sources[s].role != Source::Role::kFixed) freedom[s] = FreedomOf(sums[s]);
  }
  return freedom;
}

/// The first guess of a source's variance. The zero offsets of legs, trunk and limbs share one
/// guess, which all of them show together, because one maker sets all encoders.
double FirstGuess(const std::vector<SourceSum>& sums, const std::vector<Source>& sources,
                  const Spread& spread, std::size_t source) {
  const double own = sources[source].sd * sources[source].sd;
  if (source < kLegOffset || source > kLimbOffset) return own;
  double squares = own, freedom = 1.0;
  for (int s = kLegOffset; s <= kLimbOffset; ++s) {
    const SourceSum& sum = sums[static_cast<std::size_t>(s)];
    squares += spread[s] * spread[s] * sum.squares;
    freedom += FreedomOf(sum) - sum.own;
  }
  return squares / freedom;
}

/// The variance of an instrument's noise by its sum of squares (SI) and a guess with the weight
/// `own`, which is part of `freedom`. Instruments are often much better than guessed. The guess
/// therefore counts as at most twice the standard deviation that the squares alone give (with few
/// numbers: as at most what these leave possible), because it would otherwise dominate. Rows that
/// unknowns explain one by one leave no squares, whatever the noise is.
double NoiseVariance(double squares, double guess, double freedom, double own) {
  constexpr double kFarGuess = 2.0;
  constexpr double kPossible = 0.025;  // probability of fewer squares
  const double numbers = freedom - own;
  double counted = guess;
  if (numbers > 1.0) {
    const double most =
        std::max(kFarGuess * kFarGuess, numbers / ChiSquareQuantile(kPossible, numbers));
    counted = std::min(guess, most * squares / numbers);
  }
  return std::max((squares + own * counted) / freedom, kLeastOfGuess * kLeastOfGuess * guess);
}

/// Updates the standard deviations and returns their largest relative change.
double UpdateSpread(const std::vector<SourceSum>& sums, const std::vector<Source>& sources,
                    bool robust, Spread& spread) {
  double change = 0.0;
  const Spread was = spread;
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const SourceSum& sum = sums[s];
    if (sum.rows <= 0.0 || sources[s].role == Source::Role::kFixed) continue;
    const bool noise = sources[s].role == Source::Role::kNoise;
    double squares = sum.squares;
    if (robust && noise) {
      const Eigen::Map<const Eigen::VectorXd> all(
          sum.of_observations.data(), static_cast<Eigen::Index>(sum.of_observations.size()));
      squares = sum.rows * Median(all) / ChiSquareQuantile(0.5, 1.0);
    }
    const double before = spread[static_cast<int>(s)];
    const double guess = FirstGuess(sums, sources, was, s), freedom = FreedomOf(sum);
    squares *= before * before;
    const double variance = noise ? NoiseVariance(squares, guess, freedom, sum.own)
                                  : (squares + sum.own * guess) / freedom;
    spread[static_cast<int>(s)] = std::max(kLeastNoise, std::sqrt(variance));
    change = std::max(change, std::abs(std::log(spread[static_cast<int>(s)] / before)));
  }
  return change;
}

/// Squared distance of an observation in units of its noise.
double SquaredDistance(const Instrument& instrument, const Eigen::VectorXd& left,
                       const Spread& spread) {
  return (instrument.Weights(spread) * left).squaredNorm();
}

/// Updates Huber's weights by the distance of each observation; weights of 0 stay. Returns the
/// largest change.
double UpdateWeights(const ObservationResiduals& residuals, const ObservedRobot& model,
                     const Observations& observations, const Spread& spread,
                     std::vector<double>& weights) {
  double change = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] <= 0.0) continue;
    const Instrument& instrument = model.instrument(observations.all[i].instrument);
    const double weight = HuberWeight(instrument, residuals.Left(static_cast<int>(i)), spread);
    change = std::max(change, std::abs(weight - weights[i]));
    weights[i] = weight;
  }
  return change;
}

void TakeCovariance(const ObservedRobot& model, const Observations& observations,
                    const ObservationResiduals& residuals, const Eigen::MatrixXd& covariance,
                    ObservationFit& fit) {
  fit.covariance = residuals.scale().asDiagonal() * covariance * residuals.scale().asDiagonal();
  fit.entry_of_unknown.clear();
  for (int u = 0; u < model.unknown_count; ++u) {
    fit.entry_of_unknown.push_back(residuals.RobotEntry(u));
  }
  fit.entry_of_quantity.clear();
  for (int q = 0; q < static_cast<int>(model.setup.quantities.size()); ++q) {
    fit.entry_of_quantity.push_back(residuals.QuantityEntry(q));
  }
  fit.entry_of_effect.clear();
  for (int e = 0; e < static_cast<int>(observations.effects.size()); ++e) {
    fit.entry_of_effect.push_back(residuals.EffectEntry(e));
  }
}

/// Number of numbers, beside the data's, from which the noise was known before.
double KnownOfNoise(const ObservedRobot& model, const Observations& observations) {
  std::set<int> seen;
  for (const Observation& of : observations.all) {
    const std::vector<int>& noise = model.instrument(of.instrument).noise;
    seen.insert(noise.begin(), noise.end());
  }
  double known = 0.0;
  for (const int source : seen) {
    known += model.setup.sources[static_cast<std::size_t>(source)].own_weight - 1.0;
  }
  return known;
}

/// Counts the numbers of the observations that the unknowns explain, and those that are left.
void TakeCounts(const ObservedRobot& model, const Observations& observations,
                const std::vector<Eigen::VectorXd>& explained, ObservationFit& fit) {
  fit.effective_parameters = 0.0;
  double rows = 0.0;
  for (std::size_t i = 0; i < fit.weights.size(); ++i) {
    if (fit.weights[i] <= 0.0) continue;
    fit.effective_parameters += explained[i].sum();
    rows += static_cast<double>(explained[i].size());
  }
  fit.degrees_of_freedom =
      std::max(1.0, rows - fit.effective_parameters) + KnownOfNoise(model, observations);
}

/// Degrees of freedom of the variance of each entry of x (Satterthwaite 1946). Each source
/// contributes a part of that variance and is known by its number of numbers: priors by their own
/// rows, an earlier calibration exactly; the rest is due to the noise.
Eigen::VectorXd FreedomOfEntries(const ObservationResiduals& residuals, int observations,
                                 const Eigen::MatrixXd& covariance, const ObservationFit& fit) {
  std::vector<Eigen::Index> first = {0};
  for (int size : residuals.parameter_blocks) first.push_back(first.back() + size);
  Eigen::MatrixXd parts = Eigen::MatrixXd::Zero(
      covariance.rows(), static_cast<Eigen::Index>(fit.spread_freedom.size()));
  Eigen::VectorXd known = Eigen::VectorXd::Zero(covariance.rows());
  const int blocks = static_cast<int>(residuals.residual_blocks.size());
  for (int block = observations; block < blocks; ++block) {
    const std::vector<int>& sources = residuals.Sources(block);
    const auto& J = residuals.Jacobian(block);
    const int of = residuals.residual_blocks[block].parameter_blocks.front();
    if (sources.empty()) {
      known += (covariance.middleCols(first[of], J.cols()) * J.transpose()).rowwise().squaredNorm();
      continue;
    }
    for (std::size_t row = 0; row < sources.size(); ++row) {
      parts.col(sources[row]) += (covariance.middleCols(first[of], J.cols()) *
                                  J.row(static_cast<Eigen::Index>(row)).transpose())
                                     .cwiseAbs2();
    }
  }
  const Eigen::VectorXd variances = covariance.diagonal();
  const Eigen::VectorXd noise = (variances - parts.rowwise().sum() - known).cwiseMax(0.0);
  Eigen::VectorXd doubt = noise.cwiseAbs2() / fit.degrees_of_freedom;
  for (Eigen::Index s = 0; s < parts.cols(); ++s) {
    doubt += parts.col(s).cwiseAbs2() / fit.spread_freedom[static_cast<std::size_t>(s)];
  }
  return variances.cwiseAbs2().cwiseQuotient(doubt);
}

/// Widens standard deviations whose variance is not well known.
void WidenByDoubt(const Eigen::VectorXd& freedom, double usual, Eigen::MatrixXd& covariance) {
  constexpr double kInterval = 0.975;
  const double least = StudentQuantile(kInterval, usual);
  const Eigen::VectorXd factors = freedom.unaryExpr([&](double own) {
    return std::max(1.0, StudentQuantile(kInterval, std::max(1.0, std::min(own, usual))) / least);
  });
  covariance = (factors.asDiagonal() * covariance * factors.asDiagonal()).eval();
}

/// Makes one step, and all that follows from its linearisation. Returns whether all came to rest.
/// The covariance is that of the last step, before its standard deviations were updated.
bool UpdateFit(const ObservedRobot& model, const Observations& observations,
               const ObservationFitOptions& options, bool last, ObservationFit& fit) {
  if (options.freedom.robot) fit.loads = ObservedLoads(model, observations, fit.values.robot);
  ObservationResiduals residuals(model, observations, fit.loads, fit.spread, fit.weights,
                                 options.freedom, fit.values);
  const Eigen::VectorXd x = residuals.Start();
  residuals.Evaluate(x, true);
  const double cost = CostOf(residuals);
  const NormalEquations equations(residuals);
  Eigen::MatrixXd covariance = InverseOfInformation(equations.information());
  const std::vector<Eigen::VectorXd> explained = equations.ExplainedVariances(covariance).all;
  const Eigen::VectorXd step =
      BoundedStep(equations.information(), equations.gradient(), x, residuals.nonnegative);
  const bool small = -equations.gradient().dot(step) < kSlightStep * (1.0 + cost);
  Eigen::VectorXd next = x + step;
  residuals.Evaluate(next, false);
  ++fit.iterations;
  if (!small && !(CostOf(residuals) <= cost)) {  // far from the solution: damped steps
    next = Solve(residuals, x).x;
    residuals.Evaluate(next, false);
  }
  fit.values = residuals.ToValues(next);
  TakeCounts(model, observations, explained, fit);
  double change = 0.0;
  if (options.estimate_spread) {
    const std::vector<SourceSum> sums = SumBySource(residuals, model, observations, explained);
    fit.spread_freedom = FreedomBySource(sums, model.setup.sources);
    change = UpdateSpread(sums, model.setup.sources, options.robust, fit.spread);
  }
  change = std::max(change, UpdateWeights(residuals, model, observations, fit.spread, fit.weights));
  const bool settled = options.robust ? change < kRoughlySettled : change < kSettled && small;
  if (settled || last) {
    if (options.estimate_spread) {
      WidenByDoubt(FreedomOfEntries(residuals, observations.count(), covariance, fit),
                   fit.degrees_of_freedom, covariance);
    }
    TakeCovariance(model, observations, residuals, covariance, fit);
  }
  return settled;
}

}  // namespace

ObservationFit StartFit(const ObservedRobot& model, const Observations& observations) {
  ObservationFit fit;
  fit.values = NominalValues(model, observations);
  fit.spread = FirstSpread(model.setup.sources);
  fit.weights.assign(observations.all.size(), 1.0);
  fit.loads = ObservedLoads(model, observations, fit.values.robot);
  return fit;
}

ObservationFit FitObservations(const ObservedRobot& model, const Observations& observations,
                               const ObservationFit& start, const ObservationFitOptions& options) {
  ObservationFit fit = start;
  fit.settled = false;
  for (int update = 0; update < options.max_updates && !fit.settled; ++update) {
    const bool last = update + 1 == options.max_updates;
    fit.settled = UpdateFit(model, observations, options, last, fit);
  }
  fit.termination = fit.settled ? Termination::kConverged : Termination::kNoConvergence;
  return fit;
}

double HuberWeight(const Instrument& instrument, const Eigen::VectorXd& left,
                   const Spread& spread) {
  const double limit = ChiSquareQuantile(kHuberShare, instrument.size());
  const double square = SquaredDistance(instrument, left, spread);
  return square <= limit ? 1.0 : std::sqrt(limit / square);
}

ObservedEstimate EstimateObserved(const ObservedRobot& model, const Observations& observations,
                                  const ObservationFreedom& freedom) {
  ObservedEstimate estimate;
  ObservationFit start = StartFit(model, observations);
  const ObservationFit robust = FitObservations(
      model, observations, start, {.freedom = freedom, .robust = true, .max_updates = 60});
  const double probability = model.setup.outlier_probability / std::max(1, observations.count());
  const std::vector<Eigen::VectorXd> left = LeftOf(model, observations, robust.values);
  for (std::size_t i = 0; i < left.size(); ++i) {
    const Instrument& instrument = model.instrument(observations.all[i].instrument);
    const double rows = instrument.size();
    const double limit = rows * FisherQuantile(1.0 - probability, rows, kGrossFreedom);
    if (SquaredDistance(instrument, left[i], robust.spread) <= limit) continue;
    estimate.outliers.push_back({static_cast<int>(i), left[i]});
    start.weights[i] = 0.0;
  }
  start.values = robust.values;
  start.spread = robust.spread;
  estimate.fit = FitObservations(model, observations, start, {.freedom = freedom});
  return estimate;
}

Eigen::MatrixXd RobotInformation(const ObservedRobot& model, const Observations& observations,
                                 const ObservationFit& fit) {
  ObservationResiduals residuals(model, observations, fit.loads, fit.spread, fit.weights, {},
                                 fit.values);
  residuals.Evaluate(residuals.Start(), true);
  const Eigen::MatrixXd all = NormalEquations(residuals).information();
  const Eigen::Index robot = model.unknown_count, others = all.rows() - robot;
  Eigen::MatrixXd data = all.topLeftCorner(robot, robot);
  if (others > 0) {
    const Eigen::MatrixXd across = all.bottomLeftCorner(others, robot);
    const Eigen::MatrixXd own = all.bottomRightCorner(others, others);
    data -= across.transpose() * SolvePositive(own, across);
  }
  data -= residuals.RobotPriorInformation();
  std::vector<int> entries;
  for (int u = 0; u < model.unknown_count; ++u) entries.push_back(residuals.RobotEntry(u));
  const Eigen::VectorXd per_unit = residuals.scale()(entries).cwiseInverse();
  return per_unit.asDiagonal() * data(entries, entries) * per_unit.asDiagonal();
}

}  // namespace elastocal
