// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/marker_places.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr const char* kMarkerPrefix = "marker.";

std::string CoordinateOf(const std::string& marker, int axis) {
  return kMarkerPrefix + marker + "." + "xyz"[axis];
}

/// Measured place minus nominal position.
Eigen::Vector3d DeviationOf(const MarkerMeasurement& place, const ErrorModel& model) {
  const auto found = std::ranges::find(model.markers, place.marker, &Marker::name);
  return place.p_link_marker - found->p_link_marker;
}

bool HasMarker(const ErrorModel& model, const std::string& name) {
  return std::ranges::find(model.markers, name, &Marker::name) != model.markers.end();
}

/// Adds a quantity of which nothing was known.
void Add(const std::string& name, double value, double variance, EarlierEstimate& known) {
  const Eigen::Index row = known.mean.size();
  known.names.push_back(name);
  known.mean.conservativeResize(row + 1);
  known.mean[row] = value;
  known.covariance.conservativeResize(row + 1, row + 1);
  known.covariance.row(row).setZero();
  known.covariance.col(row).setZero();
  known.covariance(row, row) = variance;
}

/// Adds a measurement of a known quantity (Kalman's update).
void Measure(Eigen::Index row, double value, double variance, EarlierEstimate& known) {
  const Eigen::VectorXd column = known.covariance.col(row);
  const double total = column[row] + variance;
  known.mean += column * ((value - known.mean[row]) / total);
  known.covariance -= column * column.transpose() / total;
}

}  // namespace

double PlaceResidual::in_sds() const { return std::sqrt(squares / 3.0); }

std::vector<PlaceResidual> PlaceResiduals(const std::vector<MarkerMeasurement>& places,
                                          const CalibrationResult& result) {
  // Where the place alone determines a direction, the residual must be zero, and rounding is no
  // evidence. The cluster factor in the covariance comes from the scatter of postures, not from the
  // places, and is taken out.
  constexpr double kLeastShare = 0.05;
  std::vector<PlaceResidual> left;
  for (const MarkerMeasurement& place : places) {
    std::array<int, 3> rows{};
    bool fitted = HasMarker(result.model, place.marker);
    Eigen::Vector3d estimate = Eigen::Vector3d::Zero();
    for (int axis = 0; axis < 3 && fitted; ++axis) {
      const int parameter =
          FindParameter(result.model.parameters, CoordinateOf(place.marker, axis));
      const auto at = std::ranges::find(result.posterior.parameters, parameter);
      fitted = parameter >= 0 && at != result.posterior.parameters.end();
      if (!fitted) break;
      rows[static_cast<std::size_t>(axis)] =
          static_cast<int>(at - result.posterior.parameters.begin());
      estimate[axis] = result.delta[parameter];
    }
    if (!fitted) continue;
    const Eigen::Vector3d off = DeviationOf(place, result.model) - estimate;
    const double variance = place.sd * place.sd;
    const Eigen::Matrix3d own = variance * (1.0 + kLeastShare) * Eigen::Matrix3d::Identity() -
                                Eigen::Matrix3d(result.posterior.covariance(rows, rows)) /
                                    std::max(1.0, result.posterior.cluster_factor);
    const SymmetricDecomposition axes = DecomposeSymmetric(own);
    const Eigen::Vector3d along = axes.vectors.transpose() * off;
    const Eigen::Vector3d least = axes.values.cwiseMax(kLeastShare * variance);
    left.push_back({place.marker, off.norm(), along.cwiseAbs2().cwiseQuotient(least).sum()});
  }
  return left;
}

void KnowMarkers(const std::vector<MarkerMeasurement>& places, const ErrorModel& model,
                 EarlierEstimate& known) {
  for (const MarkerMeasurement& place : places) {
    if (!HasMarker(model, place.marker)) continue;
    const Eigen::Vector3d deviation = DeviationOf(place, model);
    for (int axis = 0; axis < 3; ++axis) {
      const std::string name = CoordinateOf(place.marker, axis);
      const auto at = std::ranges::find(known.names, name);
      const double variance = place.sd * place.sd;
      if (at == known.names.end()) {
        Add(name, deviation[axis], variance, known);
      } else {
        Measure(at - known.names.begin(), deviation[axis], variance, known);
      }
    }
  }
}

PlaceAgreement JudgeMarkers(const std::vector<MarkerMeasurement>& places,
                            const CalibrationResult& result, double probability) {
  PlaceAgreement agreement;
  std::vector<PlaceResidual> left = PlaceResiduals(places, result);
  if (left.empty()) return agreement;
  std::ranges::sort(left, std::greater<>(), &PlaceResidual::squares);
  const double median = left[left.size() / 2].squares;
  agreement.factor = std::sqrt(std::max(1.0, median / ChiSquareQuantile(0.5, 3.0)));
  const double most = agreement.factor * agreement.factor *
                      ChiSquareQuantile(1.0 - probability / static_cast<double>(left.size()), 3.0);
  for (const PlaceResidual& one : left) {
    if (one.squares > most) agreement.contradictory.push_back({one.marker, one.distance});
  }
  return agreement;
}

bool KnowsRobot(const EarlierEstimate& known) {
  return std::ranges::any_of(
      known.names, [](const std::string& name) { return !name.starts_with(kMarkerPrefix); });
}

}  // namespace elastocal
