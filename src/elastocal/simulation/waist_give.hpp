// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "elastocal/simulation/true_motion.hpp"

namespace elastocal {

/// Deflection of the waist from rigid kinematics: the largest displacement [m] and rotation [rad]
/// in a trial.
struct WaistGive {
  double translation = 0.0, rotation = 0.0;
};

/// The last frame of each rest of a motion that was played.
std::vector<Eigen::Index> RestFrames(const Motion& motion, const TrueMotion& played);

/// The largest deflection over `frames`, relative to the true pose of the first foot on the floor.
/// `T_foot_waist` gives the waist of the rigid robot for encoder positions by coordinate.
WaistGive LargestWaistGive(
    const TrueMotion& played, const std::vector<Eigen::Index>& frames,
    const std::function<Transform(const Eigen::VectorXd& encoders)>& T_foot_waist);

}  // namespace elastocal
