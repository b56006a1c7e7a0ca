// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/observation/instrument.hpp"

namespace elastocal {

/// An inertial unit that is fixed to a link and at rest: measured is the mean of its accelerometer,
/// x, y, z in m/s^2, which is 9.81 upwards. It tells roll and pitch of the link.
///
/// Quantity (7 numbers): the rotation of the unit's axes in those of the link, as rotation vector
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
  /// The unit's axes are turned to where the nominal robot sees gravity; about an axis of which its
  /// attitudes tell nothing they stay as they are.
  void Begin(const std::vector<Sight>& sights, const std::vector<Eigen::VectorXd>& measured,
             std::vector<QuantityValue*>& values) const override;
};

}  // namespace elastocal
