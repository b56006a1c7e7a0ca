// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/observation/instrument.hpp"

namespace elastocal {

/// A flat plate that touches a table, in the frame of the link that carries it: a point of its
/// face, and axes whose z is the normal of the face, out of the table that it lies on.
struct PlateFace {
  Eigen::Vector3d p_link_face = Eigen::Vector3d::Zero();  ///< m
  Eigen::Matrix3d R_link_face = Eigen::Matrix3d::Identity();
};

/// A plate that lies flush on a table: the height of the plate's point over the table [m] and the
/// angles of the plate against the table about its own x and y [rad] are zero. It shows no number.
///
/// Quantities: errors of the face's tilt about its own x, then y [rad]; the plane of the table.
class FlushContact : public Instrument {
 public:
  PlateFace face;

  const char* kind() const override { return "flush contact"; }
  std::vector<RowMeaning> rows() const override;
  int measured_size() const override { return 0; }
  ObservationResidual Evaluate(const Sight& sight, const Eigen::VectorXd& measured) const override;
  Eigen::VectorXd Predict(const Sight&) const override { return {}; }
  /// The table's pivot is the mean of where the nominal robot touches it.
  void Begin(const std::vector<Sight>& sights, const std::vector<Eigen::VectorXd>& measured,
             std::vector<QuantityValue*>& values) const override;
};

}  // namespace elastocal
