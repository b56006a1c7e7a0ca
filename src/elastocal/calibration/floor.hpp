// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/placement.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

// Feet stand flat on one level floor. That tells how the soles lie in their links, which the
// markers of the feet cannot: their own positions are unknown. (The place of a sole within the
// floor's plane and its heading remain unknown.)

using Matrix3x6d = Eigen::Matrix<double, 3, 6>;

/// A footing against the floor: how far its sole leans, along two horizontal directions [rad], and
/// how far it is above the sole of the first footing [m]; zero where both are flat on one level
/// floor.
struct FloorResidual {
  Eigen::Vector3d residual;
  Matrix3x6d by_foot;                           ///< by displacement and rotation in its own axes
  Eigen::Matrix<double, 1, 6> height_by_first;  ///< of the last row, by those of the first footing
};

/// `up` is the direction of the floor's normal in the reference frame, `up_foot` that of the sole
/// in the foot's frame, both of unit length.
FloorResidual EvaluateFloor(const Transform& T_ref_foot, const Transform& T_ref_first,
                            const Eigen::Vector3d& up, const Eigen::Vector3d& up_foot);

/// Whether a footing, as it was placed, may be flat on one floor with the first one: it leans by no
/// more than 8 degrees, and is no more than 20 mm higher or lower. What is beyond cannot be errors
/// of a robot: it is a ramp, a step, or a wrong `up`.
struct FloorUse {
  bool tilt = false, height = false;
};
FloorUse UseOfFloor(const FloorResidual& placed);

/// The footings on legs, the first of which the heights of all others refer to.
std::vector<int> FloorFootings(const Placement& placement);

/// Direction in the frame of a leg's foot that is up while the sole is flat: that of the zero
/// posture with the root link upright.
Eigen::Vector3d UpOfFoot(const ErrorModel& model, int leg);

}  // namespace elastocal
