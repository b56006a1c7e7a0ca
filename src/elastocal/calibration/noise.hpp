#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Standard deviations of what the model leaves unexplained, by group of postures: chains differ in
/// how well the model fits them, and a badly fitting leg shall not blur an arm.
struct Noise {
  Eigen::VectorXd marker_sd;  ///< of a marker coordinate, m
  /// Between the waist as the markers see it and as the elastic leg on its foot gives it (the
  /// constraint of eq. 14), m and rad.
  Eigen::VectorXd waist_position_sd, waist_rotation_sd;

  int group_count() const { return static_cast<int>(marker_sd.size()); }
};

/// Group of each posture: trials whose chains share a joint (head and both arms: the trunk's) are
/// one. All 0 for a table of postures.
std::vector<int> NoiseGroups(const ErrorModel& model, const Recording& recording);

}  // namespace elastocal
