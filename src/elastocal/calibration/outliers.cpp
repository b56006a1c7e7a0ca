#include "elastocal/calibration/outliers.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include "elastocal/math/statistics.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr double kLeastVariance = 0.05;

/// Squared Mahalanobis distance, with variances no smaller than a part of the noise: an observation
/// that alone determines a parameter has a residual of zero and a variance of zero. All in units of
/// the noise.
double SquaredDistance(const Eigen::VectorXd& residual, const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  const Eigen::ArrayXd variances = eigen.eigenvalues().array().max(kLeastVariance);
  return ((eigen.eigenvectors().transpose() * residual).array().square() / variances).sum();
}

/// Of the squared distance of an observation of `size` numbers that the noise was estimated from,
/// among others.
double UsedThreshold(double level, double size, double freedom) {
  if (std::isinf(freedom)) return ChiSquareQuantile(level, size);
  return freedom > size ? freedom * BetaQuantile(level, 0.5 * size, 0.5 * (freedom - size))
                        : std::numeric_limits<double>::infinity();
}

double UnusedThreshold(double level, double size, double freedom) {
  return std::isinf(freedom) ? ChiSquareQuantile(level, size)
                             : size * FisherQuantile(level, size, freedom);
}

}  // namespace

Eigen::MatrixXd PredictedPositions(const ErrorModel& model, const Recording& recording,
                                   const Eigen::VectorXd& delta,
                                   const CalibrationOptions& options) {
  const Geometry geometry = ApplyErrors(model, delta);
  const std::vector<PostureLoads> loads = ComputeLoads(model, recording, delta, {}, options.load);
  Eigen::MatrixXd positions(recording.posture_count(), recording.markers.cols());
  for (int i = 0; i < positions.rows(); ++i) {
    positions.row(i) =
        MarkerPositions(model, geometry, recording.q.row(i).transpose(), loads[i].joints)
            .reshaped()
            .transpose();
  }
  return positions;
}

Eigen::MatrixXd MarkerDistances(const Recording& recording, const Eigen::MatrixXd& positions) {
  Eigen::MatrixXd distances(recording.posture_count(), recording.marker_count());
  for (int m = 0; m < distances.cols(); ++m) {
    distances.col(m) = (recording.markers - positions).middleCols<3>(3 * m).rowwise().norm();
  }
  return distances;
}

Eigen::MatrixXd ResidualNorms(const ErrorModel& model, const Recording& recording,
                              const Eigen::VectorXd& delta, const CalibrationOptions& options) {
  return MarkerDistances(recording, PredictedPositions(model, recording, delta, options));
}

OutlierVerdict FindOutliers(const Fit& fit, const std::vector<int>& group, const Selection& used,
                            double probability) {
  const double level =
      1.0 - probability / std::max<double>(1.0, static_cast<double>(fit.meanings.size()));
  // Quantiles of three (markers) and six numbers (constraints), not used and used.
  double thresholds[2][2];
  for (int tie = 0; tie < 2; ++tie) {
    const double size = tie == 0 ? 3.0 : 6.0;
    thresholds[tie][0] = UnusedThreshold(level, size, fit.degrees_of_freedom);
    thresholds[tie][1] = UsedThreshold(level, size, fit.degrees_of_freedom);
  }
  OutlierVerdict verdict;
  for (std::size_t block = 0; block < fit.meanings.size(); ++block) {
    const auto [posture, marker] = fit.meanings[block];
    const Eigen::VectorXd& residual = fit.residuals[block];
    // Within three standard deviations of noise nothing can be an outlier: spare the algebra.
    if (residual.squaredNorm() < 9.0 * kLeastVariance) continue;
    const bool tie = marker < 0;
    const bool in_use = tie ? used.tied[posture] != 0 : used.markers(posture, marker);
    const Eigen::MatrixXd white = Eigen::MatrixXd::Identity(residual.size(), residual.size());
    const Eigen::MatrixXd& explained = fit.posterior.explained[block];
    const double distance = SquaredDistance(residual, white + (in_use ? -1.0 : 1.0) * explained);
    if (!(distance > thresholds[tie ? 1 : 0][in_use ? 1 : 0])) continue;
    if (tie) {
      verdict.footings.push_back(
          {posture, residual.head<3>().norm() * fit.noise.waist_position_sd[group[posture]],
           std::sqrt(distance)});
    } else {
      verdict.markers.push_back({posture, marker,
                                 residual.norm() * fit.noise.marker_sd[group[posture]],
                                 std::sqrt(distance)});
    }
  }
  return verdict;
}

}  // namespace elastocal
