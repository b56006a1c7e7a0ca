// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/observation/instrument.hpp"

namespace elastocal {

/// Face of a flat plate in the frame of its link: a point of the face, and axes whose z is the
/// normal of the face. The normal points out of the table on which the plate lies.
struct PlateFace {
  Eigen::Vector3d p_link_face = Eigen::Vector3d::Zero();  ///< m
  Eigen::Matrix3d R_link_face = Eigen::Matrix3d::Identity();
};

/// A plate that lies flush on a table. The height of the plate's point above the table [m] and the
/// angles of the plate to the table about its own x and y [rad] are zero. It shows no number.
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
  /// Sets the table's pivot to the mean of the points where the nominal robot touches it.
  void Begin(const std::vector<Sight>& sights, const std::vector<Eigen::VectorXd>& measured,
             std::vector<QuantityValue*>& values) const override;
};

}  // namespace elastocal
