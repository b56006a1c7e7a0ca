#pragma once

#include <vector>

#include "elastocal/calibration/fit.hpp"

namespace elastocal {

/// Residuals that share a standard deviation, in units of it.
struct VarianceComponent {
  std::vector<double> squares;  ///< of each three: a marker, a position, a rotation
  double rows = 0.0;
  double explained = 0.0;  ///< how many of the rows the fit explains

  /// By how much the standard deviation has to be multiplied; by the median where outliers may be
  /// among the residuals.
  double Factor(bool robust) const;
};

inline constexpr double kSmallestMarkerSd = 1e-9;  ///< m: of noise-free data

/// Components of each group of postures: its markers, the positions that its support constraints
/// leave, and the rotations.
enum class VariancePart { kMarkers, kPositions, kRotations };
inline constexpr int kVarianceParts = 3;
inline int ComponentIndex(int group, VariancePart part) {
  return kVarianceParts * group + static_cast<int>(part);
}

/// By residual block, the component of each of its rows; -1 of priors.
std::vector<std::vector<int>> RowComponents(const BodyResiduals& residuals,
                                            const std::vector<int>& group);

/// Components by their index, as the residuals of the fit have them; what the fit explains of them
/// is left open.
std::vector<VarianceComponent> ComponentsOf(const FitProblem& problem, const Selection& selection,
                                            const Fit& fit);

/// The noise that components leave, which were found with the noise `before`. What the options give
/// stays as given.
Noise EstimateNoise(const CalibrationOptions& options, const Noise& before,
                    const std::vector<VarianceComponent>& components, bool robust);

/// How far the joints' angles and lengths go beyond the prior, by the fit's estimates and their
/// posterior covariance (MacKay's update). Never narrower than the prior that was given.
PriorScale EstimatePriorScale(const FitProblem& problem, const Fit& fit);

/// The largest relative change of any standard deviation from one to the other.
double LargestChange(const Noise& before, const PriorScale& scale_before, const Noise& after,
                     const PriorScale& scale_after);

}  // namespace elastocal
