#include "elastocal/calibration/outliers.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include "elastocal/math/statistics.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

/// Squared Mahalanobis distance, with variances no smaller than a part of the noise: an observation
/// that alone determines a parameter has a residual of zero and a variance of zero.
double SquaredDistance(const Eigen::Vector3d& residual, const Eigen::Matrix3d& covariance,
                       double marker_sd) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
  const Eigen::Array3d variances = eigen.eigenvalues().array().max(0.05 * marker_sd * marker_sd);
  return ((eigen.eigenvectors().transpose() * residual).array().square() / variances).sum();
}

/// Of the squared distance of an observation that the noise was estimated from, among others.
double UsedThreshold(double level, double freedom) {
  if (std::isinf(freedom)) return ChiSquareQuantile(level, 3.0);
  return freedom > 3.0 ? freedom * BetaQuantile(level, 1.5, 0.5 * (freedom - 3.0))
                       : std::numeric_limits<double>::infinity();
}

double UnusedThreshold(double level, double freedom) {
  return std::isinf(freedom) ? ChiSquareQuantile(level, 3.0)
                             : 3.0 * FisherQuantile(level, 3.0, freedom);
}

}  // namespace

Eigen::MatrixXd ResidualNorms(const ErrorModel& model, const Recording& recording,
                              const Eigen::VectorXd& delta) {
  const Geometry geometry = ApplyErrors(model, delta);
  Eigen::MatrixXd norms(recording.posture_count(), recording.marker_count());
  for (int i = 0; i < norms.rows(); ++i) {
    const Eigen::Matrix3Xd predicted =
        MarkerPositions(model, geometry, recording.q.row(i).transpose());
    for (int m = 0; m < norms.cols(); ++m) {
      norms(i, m) = (MarkerPosition(recording, i, m) - predicted.col(m)).norm();
    }
  }
  return norms;
}

std::vector<Outlier> FindOutliers(const ErrorModel& model, const Recording& recording,
                                  const ObservationMask& used, const Eigen::VectorXd& delta,
                                  const Posterior& posterior, const NoiseLevel& noise,
                                  double probability) {
  const ObservationMask seen = SeenMask(recording);
  const double level = 1.0 - probability / std::max<double>(1.0, seen.count());
  const double threshold_used = UsedThreshold(level, noise.degrees_of_freedom);
  const double threshold_unused = UnusedThreshold(level, noise.degrees_of_freedom);
  const double marker_sd = noise.marker_sd;
  // Covariance over all parameters, zero for those that are not estimated.
  Eigen::MatrixXd covariance =
      Eigen::MatrixXd::Zero(model.parameter_count(), model.parameter_count());
  covariance(posterior.parameters, posterior.parameters) = posterior.covariance;

  GeneralizedJacobian jacobian(model);
  const Geometry geometry = ApplyErrors(model, delta);
  std::vector<Eigen::MatrixXd> by_marker;
  for (int m = 0; m < model.marker_count(); ++m) {
    by_marker.emplace_back(covariance(jacobian.Columns(m), jacobian.Columns(m)));
  }
  std::vector<Outlier> outliers;
  for (int i = 0; i < seen.rows(); ++i) {
    jacobian.Evaluate(geometry, recording.q.row(i).transpose());
    for (int m = 0; m < seen.cols(); ++m) {
      if (!seen(i, m)) continue;
      const auto J = jacobian.Block(m);
      const Eigen::Vector3d residual = MarkerPosition(recording, i, m) - jacobian.Position(m);
      // Within three standard deviations of noise nothing can be an outlier: spare the algebra.
      if (residual.norm() < 3.0 * marker_sd * std::sqrt(0.05)) continue;
      const Eigen::Matrix3d explained = J * by_marker[m] * J.transpose();
      const Eigen::Matrix3d white = marker_sd * marker_sd * Eigen::Matrix3d::Identity();
      const double distance = SquaredDistance(
          residual, used(i, m) ? Eigen::Matrix3d(white - explained) : white + explained, marker_sd);
      if (distance > (used(i, m) ? threshold_used : threshold_unused)) {
        outliers.push_back({i, m, residual.norm(), std::sqrt(distance)});
      }
    }
  }
  return outliers;
}

}  // namespace elastocal
