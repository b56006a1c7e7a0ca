#pragma once

#include <functional>
#include <vector>

#include "elastocal/simulation/true_motion.hpp"

namespace elastocal {

/// How far the waist is from where rigid kinematics has it: the largest displacement [m] and
/// rotation [rad] in a trial.
struct WaistGive {
  double translation = 0.0, rotation = 0.0;
};

/// Frames at the end of each rest of a motion that was played.
std::vector<Eigen::Index> RestFrames(const Motion& motion, const TrueMotion& played);

/// The largest over `frames`, from the true pose of the first foot on the floor. `T_foot_waist`
/// gives the rigid robot's waist for encoder positions by coordinate.
WaistGive LargestWaistGive(
    const TrueMotion& played, const std::vector<Eigen::Index>& frames,
    const std::function<Transform(const Eigen::VectorXd& encoders)>& T_foot_waist);

}  // namespace elastocal
