// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// How stiff a leg is all together: what a wrench on the waist would find (LumpedCompliance).
struct LegStiffness {
  std::string leg;
  Eigen::VectorXd q;  ///< mean of the postures in which it stood alone, by coordinate
  std::vector<std::pair<std::string, double>> posture;  ///< the same by joint of the leg, rad or m
  /// Along x, y, z of the foot [N/m] and about them [N.m/rad]: a force (moment) over the
  /// displacement (rotation) along the same axis; infinite for a rigid leg.
  Vector6d stiffness = Vector6d::Zero();
  /// The loads' own uncertainty, as share: how far torque sensors and statics disagree
  /// (TorqueDisagreement); without sensors, that of the masses of a robot description (5 %).
  double load_share = 0.0;
  /// Its 95 % interval, from the covariance of all compliances of the leg and from `load_share`;
  /// the upper end may be infinite.
  Vector6d low = Vector6d::Zero(), high = Vector6d::Zero();

  /// Whether the data tell the stiffness along an axis: its compliance differs from zero at 95 %.
  bool known(int axis) const { return std::isfinite(high[axis]); }
};

/// One entry a leg of the model that stood alone.
std::vector<LegStiffness> AssessLegs(const CalibrationResult& result, const Recording& recording);

}  // namespace elastocal
