// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "elastocal/math/transform.hpp"
#include "elastocal/robot/leg_load.hpp"

namespace elastocal {

/// The constraint of eq. 14 for one posture, as a residual: the support foot stands still, so that
/// its constant pose and the elastic leg (eq. 6) give the pose of the waist, and the markers give
/// it as well.
struct SupportTie {
  Transform T_ref_waist;           ///< as the markers see it
  Transform T_ref_foot_predicted;  ///< from there by the rigid leg
  Transform T_ref_foot;            ///< constant
  /// How the waist gives way under its load: translation of its origin [m] and rotation vector
  /// [rad], in the axes of the foot.
  Vector6d deflection = Vector6d::Zero();
};

/// Translation of the waist's origin [m] and rotation vector [rad] that are left between the two,
/// in the axes of the foot; zero where the constraint holds. With derivatives.
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
