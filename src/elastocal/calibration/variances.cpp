// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/variances.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr double kLeastTieShare = 0.1;  // of the marker noise [m, rad]: no constraint is more exact
constexpr double kLeastRowsLeft = 0.01;  // smallest share of the rows that counts as left
// quantile of a body's distance up to which its weight is 1
constexpr double kHuberQuantile = 0.99;
constexpr double kLeastSharedSd = 1e-3;  // of the marker noise [m, rad]: counts as none

/// `counts`: number of postures for which each row counts; `left`: what the fit leaves of its
/// variance.
void Add(const Eigen::ArrayXd& shares, const Eigen::VectorXd& residual,
         const Eigen::ArrayXd& counts, const Eigen::ArrayXd& left, VarianceComponent& component) {
  const double rows = (counts * shares).sum();
  if (rows <= 0.0) return;
  const double squares = (shares * residual.array().square()).sum();
  component.squares += squares;
  component.rows += rows;
  component.explained += (shares * (counts - left)).sum();
  component.weight += (counts * shares.square()).sum();
  component.means.push_back(squares / rows);
}

/// Share of the variance of a block's rows that the fit leaves.
Eigen::ArrayXd LeftOfBlock(const ExplainedRows& explained, int block,
                           const Eigen::ArrayXd& counts) {
  return LeftByPose(explained, block, counts) -
         (explained.all[block] - explained.by_nuisance[block]).array();
}

/// Huber's weights. Keeps the quantiles, because most bodies have the same number of rows.
class HuberWeight {
 public:
  double operator()(double square, Eigen::Index rows) {
    if (rows == 0) return 1.0;
    const auto [limit, added] = limits_.try_emplace(rows);
    if (added) limit->second = ChiSquareQuantile(kHuberQuantile, static_cast<double>(rows));
    return square <= limit->second ? 1.0 : std::sqrt(limit->second / square);
  }

 private:
  std::map<Eigen::Index, double> limits_;
};

}  // namespace

double VarianceComponent::Factor(Robustness robustness) const {
  if (means.empty()) return 1.0;
  const double left = std::max({kLeastRowsLeft * rows, rows - explained, 1e-6});
  double total = squares;
  if (robustness == Robustness::kMedians) {
    const Eigen::Map<const Eigen::VectorXd> all(means.data(),
                                                static_cast<Eigen::Index>(means.size()));
    total = rows * Median(all) * 3.0 / ChiSquareQuantile(0.5, 3.0);
  }
  return std::sqrt(total / left);
}

Eigen::ArrayXd LeftByPose(const ExplainedRows& explained, int block, const Eigen::ArrayXd& counts) {
  const Eigen::ArrayXd pose = explained.by_nuisance[block].array();
  return (1.0 - pose) * (counts + (1.0 - counts) * pose);
}

VarianceComponents CollectComponents(const FitProblem& problem, const Selection& selection,
                                     const Noise& noise, const BodyResiduals& residuals,
                                     const ExplainedRows& explained) {
  VarianceComponents components(noise.group_count());
  for (int b = 0; b < residuals.body_count(); ++b) {
    const BodyObservation& body = selection.bodies[b];
    if (!body.used) continue;
    const int group = problem.group[body.posture];
    const Eigen::ArrayXd counts = residuals.Counts(b);
    const Eigen::ArrayXd left = LeftOfBlock(explained, b, counts);
    for (NoiseSource source : {NoiseSource::kMarker, NoiseSource::kBodyPosition}) {
      Add(body.Shares(noise, group, source), residuals.Residual(b), counts, left,
          components[group][static_cast<int>(source)]);
    }
  }
  for (std::size_t t = 0; t < residuals.tied_postures().size(); ++t) {
    const int posture = residuals.tied_postures()[t];
    if (selection.tied[posture] == 0) continue;
    const int block = residuals.TieBlock(static_cast<int>(t));
    const Eigen::ArrayXd counts = residuals.Counts(block);
    const Eigen::ArrayXd left = LeftOfBlock(explained, block, counts);
    auto& of_group = components[problem.group[posture]];
    for (NoiseSource source : {NoiseSource::kWaistPosition, NoiseSource::kWaistRotation}) {
      Eigen::ArrayXd shares = Eigen::ArrayXd::Zero(6);
      shares.segment<3>(source == NoiseSource::kWaistPosition ? 0 : 3).setOnes();
      Add(shares, residuals.Residual(block), counts, left, of_group[static_cast<int>(source)]);
    }
  }
  return components;
}

Noise EstimateNoise(const CalibrationOptions& options, const Noise& before,
                    const VarianceComponents& components, Robustness robustness) {
  Noise noise = before;
  for (int g = 0; g < noise.group_count(); ++g) {
    const auto of = [&](NoiseSource source) -> const VarianceComponent& {
      return components[g][static_cast<int>(source)];
    };
    const auto scale = [&](NoiseSource source, double least) {
      if (of(source).means.empty()) return;
      noise(g, source) = std::max(least, noise(g, source) * of(source).Factor(robustness));
    };
    if (options.marker_sd > 0.0) {
      noise(g, NoiseSource::kMarker) = options.marker_sd;
    } else {
      scale(NoiseSource::kMarker, kSmallestMarkerSd);
    }
    const double marker_sd = noise(g, NoiseSource::kMarker);
    scale(NoiseSource::kBodyPosition, kLeastSharedSd * marker_sd);
    if (options.support_form == SupportForm::kFootRooted) continue;
    scale(NoiseSource::kWaistPosition, kLeastTieShare * marker_sd);
    scale(NoiseSource::kWaistRotation, kLeastTieShare * marker_sd);
  }
  return noise;
}

RobustWeights EstimateWeights(const FitProblem& problem, const Selection& selection,
                              const Noise& noise, const BodyResiduals& residuals,
                              Robustness robustness) {
  HuberWeight huber;
  RobustWeights weights;
  weights.bodies.resize(selection.bodies.size());
  weights.ties.assign(static_cast<std::size_t>(problem.recording.posture_count()), 1.0);
  for (int b = 0; b < residuals.body_count(); ++b) {
    const BodyObservation& body = selection.bodies[b];
    if (!body.used) continue;
    // In units of the noise alone, without the weights.
    const Eigen::ArrayXd squares =
        (residuals.Residual(b).array() * residuals.Sds(b).array()).square() /
        body.Variances(noise, problem.group[body.posture]);
    const Eigen::Index shared = body.shared_rows();
    weights.bodies[b].shared = huber(squares.head(shared).sum(), shared);
    if (robustness == Robustness::kMedians) {
      const Eigen::Index own = squares.size() - shared;
      weights.bodies[b].own = huber(squares.tail(own).sum(), own);
    }
  }
  for (std::size_t t = 0; t < residuals.tied_postures().size(); ++t) {
    const int posture = residuals.tied_postures()[t];
    if (selection.tied[posture] == 0 || problem.options.support_form == SupportForm::kFootRooted) {
      continue;
    }
    const int block = residuals.TieBlock(static_cast<int>(t));
    const int group = problem.group[posture];
    Eigen::ArrayXd sds(6);
    sds.head<3>().setConstant(noise(group, NoiseSource::kWaistPosition));
    sds.tail<3>().setConstant(noise(group, NoiseSource::kWaistRotation));
    weights.ties[posture] = huber(
        (residuals.Residual(block).array() * residuals.Sds(block).array() / sds).square().sum(), 6);
  }
  return weights;
}

PriorScale EstimatePriorScale(const FitProblem& problem, const Fit& fit) {
  const Prior prior = WidenedPrior(problem, fit);
  const EarlierPart earlier =
      PartOf(problem.options.earlier, problem.model, fit.posterior.parameters);
  std::array<double, kPriorGroupCount> squares{}, determined{};
  for (std::size_t i = 0; i < fit.posterior.parameters.size(); ++i) {
    const int index = fit.posterior.parameters[i];
    const ParameterKind kind = problem.model.parameters[index].kind;
    if (IsExternal(kind)) continue;
    if (std::binary_search(earlier.positions.begin(), earlier.positions.end(),
                           static_cast<int>(i))) {
      continue;
    }
    const auto diagonal = static_cast<Eigen::Index>(i);
    const double sd = prior.Of(problem.model.tree, problem.model.parameters[index]);
    const double variance = sd * sd;
    const auto group = static_cast<std::size_t>(GroupOf(kind));
    squares[group] += fit.delta[index] * fit.delta[index] / variance;
    determined[group] += 1.0 - fit.posterior.covariance(diagonal, diagonal) / variance;
  }
  PriorScale scale = fit.prior_scale;
  for (int g = 0; g < kPriorGroupCount; ++g) {
    if (determined[g] < 1.0) continue;
    scale.factor[g] = std::clamp(scale.factor[g] * std::sqrt(squares[g] / determined[g]), 1.0,
                                 MostWidening(static_cast<PriorGroup>(g)));
  }
  return scale;
}

double DegreesOfFreedom(const CalibrationOptions& options, const VarianceComponents& components) {
  double total = 0.0;
  double spread = 0.0;
  for (const auto& group : components) {
    for (int s = 0; s < kNoiseSourceCount; ++s) {
      const VarianceComponent& component = group[s];
      total += component.explained;
      const bool given =
          static_cast<NoiseSource>(s) == NoiseSource::kMarker && options.marker_sd > 0.0;
      if (given || component.rows <= 0.0) continue;
      // Of the rows that are left, each counts by the source's share in it.
      const double left =
          component.weight * std::max(kLeastRowsLeft, 1.0 - component.explained / component.rows);
      spread += component.explained * component.explained / std::max(1e-9, left);
    }
  }
  if (spread <= 0.0) return std::numeric_limits<double>::infinity();
  return std::max(1.0, total * total / spread);
}

}  // namespace elastocal
