// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/observation/instrument.hpp"

namespace elastocal {

/// A point of a link at a known distance [m] from a fixed plane: a tip that touches a table or a
/// wall (distance 0), or a height gauge, which shows one coordinate.
///
/// Quantities: the plane; the position of the point on its link, as displacement from the origin
/// [m].
class PlaneDistance : public Instrument {
 public:
  const char* kind() const override { return "plane distance"; }
  std::vector<RowMeaning> rows() const override { return {{"height", SourceUnit::kMetre}}; }
  int measured_size() const override { return 1; }
  ObservationResidual Evaluate(const Sight& sight, const Eigen::VectorXd& measured) const override;
  Eigen::VectorXd Predict(const Sight& sight) const override;
  /// Sets the plane's pivot to the mean of the nominal positions of the point, minus the distances.
  void Begin(const std::vector<Sight>& sights, const std::vector<Eigen::VectorXd>& measured,
             std::vector<QuantityValue*>& values) const override;
};

}  // namespace elastocal
