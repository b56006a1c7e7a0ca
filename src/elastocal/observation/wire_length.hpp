// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/observation/instrument.hpp"

namespace elastocal {

/// A draw wire. It measures the distance of a point of a link to a fixed point, m, from an unknown
/// zero.
///
/// Quantities: 4 numbers, the fixed point as displacement from the origin on the floor [m] and the
/// zero that is added to the distance [m]; the position of the point on its link, as displacement
/// from the origin [m].
class WireLength : public Instrument {
 public:
  const char* kind() const override { return "wire"; }
  std::vector<RowMeaning> rows() const override { return {{"length", SourceUnit::kMetre}}; }
  int measured_size() const override { return 1; }
  ObservationResidual Evaluate(const Sight& sight, const Eigen::VectorXd& measured) const override;
  Eigen::VectorXd Predict(const Sight& sight) const override;
};

}  // namespace elastocal
