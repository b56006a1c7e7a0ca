// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// Stiffness of a whole leg, as a wrench on the waist would find it (LumpedCompliance).
struct LegStiffness {
  std::string leg;
  Eigen::VectorXd q;  ///< mean of the postures in which the leg stood alone, by coordinate
  std::vector<std::pair<std::string, double>> posture;  ///< the same by joint of the leg, rad or m
  /// Along x, y, z of the foot [N/m] and about them [N.m/rad]: a force (moment) over the
  /// displacement (rotation) along the same axis; infinite for a rigid leg.
  Vector6d stiffness = Vector6d::Zero();
  /// Relative uncertainty of the loads: how far torque sensors and statics disagree
  /// (TorqueDisagreement); without sensors that of the masses in a robot description (5 %).
  double load_share = 0.0;
  /// 95 % interval of `stiffness`, from the covariance of all compliances of the leg and from
  /// `load_share`. The upper end may be infinite.
  Vector6d low = Vector6d::Zero(), high = Vector6d::Zero();

  /// Whether the data determine the stiffness along an axis: its compliance differs from zero at 95
  /// %.
  bool known(int axis) const { return std::isfinite(high[axis]); }
};

/// One entry for each leg of the model that stood alone. Empty where the legs are not elastic.
std::vector<LegStiffness> AssessLegs(const CalibrationResult& result, const Recording& recording);

}  // namespace elastocal
