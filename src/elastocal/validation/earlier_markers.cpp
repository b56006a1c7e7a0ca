// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/earlier_markers.hpp"

#include <stdexcept>

#include "elastocal/calibration/posterior.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/validation/data_information.hpp"
#include "elastocal/validation/paired_estimates.hpp"

namespace elastocal {
namespace {

/// Estimate from the data and the prior of a new robot, without the earlier calibration.
CalibrationEstimate EstimateOfData(const CalibrationResult& estimate,
                                   const EarlierEstimate& fitted_with) {
  const ErrorModel& model = estimate.model;
  const DataInformation data = InformationOfData(estimate, fitted_with);
  const Eigen::VectorXd precision =
      data.unit.cwiseQuotient(estimate.prior_sd(data.parameters)).cwiseAbs2();
  const Eigen::MatrixXd covariance =
      InverseOfInformation(data.information + Eigen::MatrixXd(precision.asDiagonal()));
  const Eigen::VectorXd value = data.unit.cwiseProduct(covariance * data.vector);
  CalibrationEstimate alone;
  alone.interval_factor = estimate.interval_factor;
  for (std::size_t i = 0; i < data.parameters.size(); ++i) {
    const Parameter& parameter = model.parameters[Size(data.parameters[i])];
    alone.parameters.push_back({.name = parameter.name,
                                .unit = UnitName(parameter.unit),
                                .external = IsExternal(parameter.kind),
                                .value = value[static_cast<Eigen::Index>(i)]});
    alone.covariance_names.push_back(parameter.name);
  }
  alone.covariance = data.unit.asDiagonal() * covariance * data.unit.asDiagonal();
  alone.markers = PlacesOfMarkers(model);
  return alone;
}

}  // namespace

std::vector<MarkerPlace> PlacesOfMarkers(const ErrorModel& model) {
  std::vector<MarkerPlace> places;
  for (const Marker& marker : model.markers) {
    places.push_back({marker.name, model.tree.links[Size(marker.link)].name, marker.p_link_marker});
  }
  return places;
}

std::vector<LinkMarkers> FindMarkersThatStayed(const CalibrationEstimate& earlier,
                                               const CalibrationResult& estimate,
                                               const EarlierEstimate& fitted_with, double level) {
  if (!earlier.has_covariance()) return {};
  PairedEstimates pair =
      PairEstimates(earlier, EstimateOfData(estimate, fitted_with), {}, true, true);
  try {
    FindUnmovedMarkers(pair.differences, pair.markers, level, pair.links);
  } catch (const std::invalid_argument&) {
    throw InputError(earlier.source + ": its covariance is not positive definite");
  }
  return pair.links;
}

}  // namespace elastocal
