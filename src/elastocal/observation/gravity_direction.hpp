// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/observation/instrument.hpp"

namespace elastocal {

/// An inertial unit at rest that is fixed to a link. It measures the mean of its accelerometer, x,
/// y, z in m/s^2, which is 9.81 upwards, and so tells roll and pitch of the link.
///
/// Quantity (7 numbers): rotation of the unit's axes in those of the link, as rotation vector
/// [rad]; bias of the accelerometer [m/s^2]; relative error of its scale.
/// [rad]; bias of the accelerometer [m/s^2]; relative error of its scale.
class GravityDirection : public Instrument {
 public:
  const char* kind() const override { return "gravity"; }
  std::vector<RowMeaning> rows() const override {
    return std::vector<RowMeaning>(3, {"acceleration", SourceUnit::kAcceleration});
  }
  int measured_size() const override { return 3; }
  ObservationResidual Evaluate(const Sight& sight, const Eigen::VectorXd& measured) const override;
  Eigen::VectorXd Predict(const Sight& sight) const override;
  /// Turns the unit's axes to the direction of gravity according to the nominal robot. About an
  /// axis that the attitudes do not determine they keep their orientation.
  void Begin(const std::vector<Sight>& sights, const std::vector<Eigen::VectorXd>& measured,
             std::vector<QuantityValue*>& values) const override;
};

}  // namespace elastocal
