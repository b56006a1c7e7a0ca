#include "elastocal/calibration/variances.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/calibration/fit_residuals.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr double kLeastTieShare = 0.1;  // of the marker noise [m, rad]: no constraint is better

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

double Change(double before, double after) { return std::abs(std::log(after / before)); }

double Change(const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
  return (after.array() / before.array()).log().abs().maxCoeff();
}

}  // namespace

double VarianceComponent::Factor(bool robust) const {
  const Eigen::Map<const Eigen::VectorXd> s(squares.data(),
                                            static_cast<Eigen::Index>(squares.size()));
  const double total = robust ? rows * Median(s) / ChiSquareQuantile(0.5, 3.0) : s.sum();
  // The share that is left over is positive; a hundredth of the rows where it is all but zero.
  return std::sqrt(total / std::max({1.0, 0.01 * rows, rows - explained}));
}

std::vector<std::vector<int>> RowComponents(const BodyResiduals& residuals,
                                            const std::vector<int>& group) {
  std::vector<std::vector<int>> components;
  for (const auto& [posture, marker] : residuals.meanings()) {
    const int g = group[posture];
    if (marker >= 0) {
      components.emplace_back(3, ComponentIndex(g, VariancePart::kMarkers));
      continue;
    }
    std::vector<int>& rows =
        components.emplace_back(6, ComponentIndex(g, VariancePart::kPositions));
    std::fill(rows.begin() + 3, rows.end(), ComponentIndex(g, VariancePart::kRotations));
  }
  components.resize(residuals.residual_blocks.size(), std::vector<int>{-1});
  return components;
}

std::vector<VarianceComponent> ComponentsOf(const FitProblem& problem, const Selection& selection,
                                            const Fit& fit) {
  std::vector<VarianceComponent> components(kVarianceParts * fit.noise.group_count());
  const auto add = [&](int group, VariancePart part, std::size_t block, int first) {
    VarianceComponent& component = components[ComponentIndex(group, part)];
    component.squares.push_back(fit.residuals[block].segment<3>(first).squaredNorm());
    component.rows += 3.0;
  };
  for (std::size_t block = 0; block < fit.meanings.size(); ++block) {
    const auto [posture, marker] = fit.meanings[block];
    const int group = problem.group[posture];
    if (marker >= 0) {
      if (selection.markers(posture, marker)) add(group, VariancePart::kMarkers, block, 0);
    } else if (selection.tied[posture] != 0) {
      add(group, VariancePart::kPositions, block, 0);
      add(group, VariancePart::kRotations, block, 3);
    }
  }
  return components;
}

Noise EstimateNoise(const CalibrationOptions& options, const Noise& before,
                    const std::vector<VarianceComponent>& components, bool robust) {
  Noise noise = before;
  const auto of = [&](int group, VariancePart part) -> const VarianceComponent& {
    return components[ComponentIndex(group, part)];
  };
  for (int g = 0; g < noise.group_count(); ++g) {
    const VarianceComponent& markers = of(g, VariancePart::kMarkers);
    if (options.marker_sd > 0.0) {
      noise.marker_sd[g] = options.marker_sd;
    } else if (!markers.squares.empty()) {
      noise.marker_sd[g] = std::max(kSmallestMarkerSd, noise.marker_sd[g] * markers.Factor(robust));
    }
    const VarianceComponent& positions = of(g, VariancePart::kPositions);
    if (positions.squares.empty() || options.support_form == SupportForm::kFootRooted) continue;
    const double least = kLeastTieShare * noise.marker_sd[g];
    noise.waist_position_sd[g] =
        std::max(least, noise.waist_position_sd[g] * positions.Factor(robust));
    noise.waist_rotation_sd[g] = std::max(
        least, noise.waist_rotation_sd[g] * of(g, VariancePart::kRotations).Factor(robust));
  }
  return noise;
}

PriorScale EstimatePriorScale(const FitProblem& problem, const Fit& fit) {
  const auto widened = [&](double scale, bool angles) {
    return std::clamp(scale * RelativeDeviation(problem, fit, angles), 1.0, kMaxPriorScale);
  };
  return {widened(fit.prior_scale.angles, true), widened(fit.prior_scale.lengths, false)};
}

double LargestChange(const Noise& before, const PriorScale& scale_before, const Noise& after,
                     const PriorScale& scale_after) {
  return std::max({Change(before.marker_sd, after.marker_sd),
                   Change(before.waist_position_sd, after.waist_position_sd),
                   Change(before.waist_rotation_sd, after.waist_rotation_sd),
                   Change(scale_before.angles, scale_after.angles),
                   Change(scale_before.lengths, scale_after.lengths)});
}

}  // namespace elastocal
