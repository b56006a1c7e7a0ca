// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "elastocal/math/transform.hpp"
#include "elastocal/robot/leg_load.hpp"

namespace elastocal {

/// Inputs of the constraint of eq. 14 for one posture. The support foot stands still: its constant
/// pose and the elastic leg (eq. 6) give the pose of the waist, and the markers give it as well.
struct SupportTie {
  Transform T_ref_waist;           ///< waist by the markers
  Transform T_ref_foot_predicted;  ///< foot, computed from there by the rigid leg
  Transform T_ref_foot;            ///< constant pose of the foot
  /// Deflection of the waist under its load: translation of its origin [m] and rotation vector
  /// [rad], in the axes of the foot.
  Vector6d deflection = Vector6d::Zero();
};

/// Residual of the constraint: difference of the two poses of the waist, as translation of its
/// origin [m] and rotation vector [rad] in the axes of the foot; zero where the constraint holds.
/// With derivatives.
struct TieResidual {
  Vector6d residual;
  /// By a screw [a; m] (velocity field a x p + m in the reference frame) of ...
  Matrix6d by_waist;  ///< ... the waist with all that it carries, the predicted foot included
  Matrix6d by_leg;    ///< ... the predicted foot alone: an error of the leg
  /// By displacement and rotation vector of the constant foot, in its own axes.
  Matrix6d by_foot;
  Matrix6d by_deflection;
};

TieResidual EvaluateTie(const SupportTie& tie);

}  // namespace elastocal
