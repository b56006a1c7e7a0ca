// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/nominal_places.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "elastocal/calibration/placing_markers.hpp"
#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/math/transform.hpp"

namespace elastocal {
namespace {

constexpr double kEnoughDirections = 20.0;        // gives `sd` to one sixth
constexpr double kLeastSd = 1e-6, kMostSd = 1.0;  // m
// With this, three markers place a link as well as the priors do.
constexpr double kHelpful = 0.01;
constexpr double kFarLess = 3.0;
constexpr int kSearchSteps = 60;

/// Rows of the covariance that hold the coordinates of a body's markers, and the nominal positions
/// of these.
struct BodyMarkers {
  std::vector<int> rows;
  std::vector<Eigen::Vector3d> coordinate_axes, at;  ///< in the body's frame, by row
};

std::map<int, BodyMarkers> MarkersByBody(const CalibrationResult& result) {
  std::map<int, BodyMarkers> bodies;
  for (std::size_t row = 0; row < result.posterior.parameters.size(); ++row) {
    const Parameter& parameter = result.model.parameters[Size(result.posterior.parameters[row])];
    if (parameter.kind != ParameterKind::kMarker) continue;
    const Marker& marker = result.model.markers[Size(parameter.marker)];
    const Link& link = result.model.tree.links[Size(marker.link)];
    BodyMarkers& body = bodies[link.body];
    body.rows.push_back(static_cast<int>(row));
    body.coordinate_axes.emplace_back(link.T_body_link.linear().col(parameter.name.back() - 'x'));
    body.at.emplace_back(link.T_body_link * marker.p_link_marker);
  }
  return bodies;
}

/// Orthonormal basis of the changes of coordinates by a rigid displacement or rotation of all
/// markers.
Eigen::MatrixXd RigidMotions(const BodyMarkers& body) {
  const auto rows = static_cast<Eigen::Index>(body.rows.size());
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& at : body.at) centre += at / static_cast<double>(rows);
  Eigen::MatrixXd motions(rows, 6);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Eigen::Vector3d& axis = body.coordinate_axes[Size(static_cast<int>(i))];
    const Eigen::Vector3d arm = body.at[Size(static_cast<int>(i))] - centre;
    motions.row(i) << axis.transpose(), arm.cross(axis).transpose();
  }
  return ThinOrthogonalFactor(motions);
}

/// Minus twice the log likelihood of independent deviations whose variances are `variances` plus
/// sd^2.
double Unlikeliness(double sd, const Eigen::VectorXd& deviations,
                    const Eigen::VectorXd& variances) {
  const Eigen::ArrayXd all = variances.array() + sd * sd;
  return (all.log() + deviations.array().square() / all).sum();
}

double LikeliestSd(const Eigen::VectorXd& deviations, const Eigen::VectorXd& variances) {
  double best = kLeastSd, least = INFINITY;
  for (int i = 0; i <= kSearchSteps; ++i) {
    const double sd =
        kLeastSd * std::pow(kMostSd / kLeastSd, static_cast<double>(i) / kSearchSteps);
    const double value = Unlikeliness(sd, deviations, variances);
    if (value < least) {
      least = value;
      best = sd;
    }
  }
  const double step = std::pow(kMostSd / kLeastSd, 1.0 / kSearchSteps);
  double low = best / step, high = best * step;
  for (int i = 0; i < kSearchSteps; ++i) {  // ternary search
    const double left = low + (high - low) / 3.0, right = high - (high - low) / 3.0;
    const bool lower =
        Unlikeliness(left, deviations, variances) < Unlikeliness(right, deviations, variances);
    (lower ? high : low) = lower ? right : left;
  }
  return 0.5 * (low + high);
}

}  // namespace

bool NominalPlaces::told() const { return directions >= kEnoughDirections; }

bool NominalPlaces::worth_telling() const {
  return told() && sd < kHelpful && prior_sd > kFarLess * sd;
}

NominalPlaces AssessNominalPlaces(const CalibrationResult& result) {
  const std::map<int, BodyMarkers> bodies = MarkersByBody(result);
  const Eigen::MatrixXd& covariance = result.posterior.covariance;
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(covariance.rows(), 0);
  for (const auto& [number, body] : bodies) {
    if (!TellPose(MarkersOnBody(result.model, number))) continue;
    const Eigen::MatrixXd own = RigidMotions(body);
    const Eigen::Index first = motions.cols();
    motions.conservativeResize(Eigen::NoChange, first + own.cols());
    motions.rightCols(own.cols()).setZero();
    for (std::size_t i = 0; i < body.rows.size(); ++i) {
      motions.row(body.rows[i]).tail(own.cols()) = own.row(static_cast<Eigen::Index>(i));
    }
  }
  if (motions.cols() == 0) return {};
  const Eigen::VectorXd estimates = result.delta(result.posterior.parameters);
  const SymmetricDecomposition apart =
      DecomposeSymmetric(motions.transpose() * covariance * motions);
  const Eigen::VectorXd deviations = apart.vectors.transpose() * (motions.transpose() * estimates);
  const Eigen::VectorXd variances = apart.values.cwiseMax(0.0);
  const double sd = LikeliestSd(deviations, variances);
  // Each direction counts by the square of its share in the variance.
  const Eigen::ArrayXd shares = sd * sd / (variances.array() + sd * sd);
  std::vector<double> priors;
  for (int i : result.posterior.parameters) {
    const bool marker = result.model.parameters[Size(i)].kind == ParameterKind::kMarker;
    if (marker && i < result.prior_sd.size()) priors.push_back(result.prior_sd[i]);
  }
  return {sd, shares.square().sum(), priors.empty() ? 0.0 : Median(priors)};
}

}  // namespace elastocal
