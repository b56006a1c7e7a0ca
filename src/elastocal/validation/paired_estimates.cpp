// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/paired_estimates.hpp"

#include <cmath>
#include <map>
#include <string>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

double DegreesOfFreedom(const CalibrationEstimate& estimate) {
  return StudentDegreesOfFreedom(0.975, estimate.interval_factor);
}

/// Covariance of some parameters of an estimate: from its file, or else diagonal with their
/// variances.
Eigen::MatrixXd CovarianceOf(const CalibrationEstimate& estimate, bool from_file,
                             const std::vector<int>& parameters) {
  if (!from_file) {
    Eigen::VectorXd variances(static_cast<Eigen::Index>(parameters.size()));
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      variances[static_cast<Eigen::Index>(i)] = std::pow(estimate.parameters[parameters[i]].sd, 2);
    }
    return variances.asDiagonal();
  }
  std::map<std::string, int> row;
  for (const std::string& name : estimate.covariance_names) {
    row.emplace(name, static_cast<int>(row.size()));
  }
  std::vector<int> rows;
  for (int parameter : parameters) {
    const auto at = row.find(estimate.parameters[parameter].name);
    if (at == row.end()) {
      throw InputError(estimate.source + ": its covariance has no parameter '" +
                       estimate.parameters[parameter].name + "'");
    }
    rows.push_back(at->second);
  }
  return estimate.covariance(rows, rows);
}

}  // namespace

PairedEstimates PairEstimates(const CalibrationEstimate& a, const CalibrationEstimate& b,
                              const std::vector<CommonParameter>& common, bool with_covariance,
                              bool with_markers) {
  PairedEstimates pair;
  std::vector<int> in_a, in_b;
  std::vector<double> values;
  const auto add = [&](int at_a, int at_b, double nominal_difference) {
    in_a.push_back(at_a);
    in_b.push_back(at_b);
    values.push_back(b.parameters[Size(at_b)].value - a.parameters[Size(at_a)].value +
                     nominal_difference);
    return static_cast<int>(values.size()) - 1;
  };
  for (const CommonParameter& one : common) pair.robot.push_back(add(one.in_a, one.in_b, 0.0));
  for (const LinkMarkers& link :
       with_markers ? FindCommonMarkers(a.markers, b.markers) : std::vector<LinkMarkers>()) {
    const std::vector<MarkerCoordinate> coordinates = CoordinatesOf(link, a, b);
    if (coordinates.empty()) continue;
    pair.links.push_back(link);
    pair.markers.emplace_back();
    for (const MarkerCoordinate& one : coordinates) {
      pair.markers.back().push_back(add(one.in_a, one.in_b, one.nominal_difference));
    }
  }
  pair.differences = {.values = Eigen::VectorXd::Map(values.data(), std::ssize(values)),
                      .covariance_a = CovarianceOf(a, with_covariance, in_a),
                      .covariance_b = CovarianceOf(b, with_covariance, in_b),
                      .freedom_a = DegreesOfFreedom(a),
                      .freedom_b = DegreesOfFreedom(b)};
  constexpr double kReturnsEach = 0.5 * kMarkerReturns * kMarkerReturns;
  for (const std::vector<int>& link : pair.markers) {
    pair.differences.covariance_a.diagonal()(link).array() += kReturnsEach;
    pair.differences.covariance_b.diagonal()(link).array() += kReturnsEach;
  }
  return pair;
}

}  // namespace elastocal
