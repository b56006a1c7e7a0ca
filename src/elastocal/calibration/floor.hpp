// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/placement.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

// Feet stand flat on one level floor. This tells the attitude and the height of the soles in their
// links. The markers of the feet cannot tell them, because their own positions are unknown. (The
// place of a sole within the floor's plane and its heading remain unknown.)

using Matrix3x6d = Eigen::Matrix<double, 3, 6>;

/// Deviation of a footing from the floor: the tilt of its sole about two horizontal directions
/// [rad], and its height above the sole of the first footing [m]. All are zero where both soles are
/// flat on one level floor.
struct FloorResidual {
  Eigen::Vector3d residual;
  Matrix3x6d by_foot;  ///< by the foot's displacement and rotation in its own axes
  /// Last row, by displacement and rotation of the first footing.
  Eigen::Matrix<double, 1, 6> height_by_first;
};

/// `up` is the direction of the floor's normal in the reference frame, `up_foot` that of the sole
/// in the foot's frame, both of unit length.
FloorResidual EvaluateFloor(const Transform& T_ref_foot, const Transform& T_ref_first,
                            const Eigen::Vector3d& up, const Eigen::Vector3d& up_foot);

/// Which rows of a FloorResidual are used for a footing as it was first placed. `tilt`: the sole
/// leans by at most 8 degrees. `height`: it is at most 20 mm above or below the first. Larger
/// deviations are no errors of a robot but a ramp, a step, or a wrong `up`.
struct FloorUse {
  bool tilt = false, height = false;
};
FloorUse UseOfFloor(const FloorResidual& placed);

/// The footings on legs. Heights refer to the first of them.
std::vector<int> FloorFootings(const Placement& placement);

/// Direction in the frame of a leg's foot that points up while the sole is flat: vertical in the
/// zero posture with the root link upright.
Eigen::Vector3d UpOfFoot(const ErrorModel& model, int leg);

}  // namespace elastocal
