// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// What the model leaves unexplained comes from several sources, and each has its own standard
/// deviation (variance components).
enum class NoiseSource {
  kMarker,         ///< of each marker coordinate by itself: cameras, and rotations of a body; m
  kBodyPosition,   ///< displacement that all markers of a body share in a posture; m
  kWaistPosition,  ///< between the waist as the markers see it and as the elastic leg on its foot
                   ///< gives it (the constraint of eq. 14); m
  kWaistRotation,  ///< likewise; rad
};
inline constexpr int kNoiseSourceCount = 4;

/// marker, body_position, waist_position, waist_rotation
const char* NoiseSourceName(NoiseSource source);

/// How much neighbouring moments of a motion tell.
struct Autocorrelation {
  double lag_one = 0.0;       ///< correlation from one moment to the next
  double samples_each = 1.0;  ///< so many moments tell as much as one posture by itself
};

/// How errors of neighbouring moments are correlated: those that the markers of a body share, and
/// what the constraint of the standing foot (eq. 14) leaves (FindMotionCorrelation).
struct MotionCorrelation {
  Autocorrelation bodies;
  Autocorrelation waist;
};

/// Standard deviations by group of postures and source: chains differ in how well the model fits
/// them, and a badly fitting leg shall not blur an arm. Errors of the model, which all markers of a
/// body share, are told from the noise of the cameras, which averages out: on real robots they are
/// most of what is left, and counting the markers of a body as independent would make standard
/// deviations too small.
struct Noise {
  Eigen::ArrayXXd sd;                          ///< groups x sources
  std::vector<MotionCorrelation> motion = {};  ///< by group; empty: no posture is of a motion

  double& operator()(int group, NoiseSource source) { return sd(group, static_cast<int>(source)); }
  double operator()(int group, NoiseSource source) const {
    return sd(group, static_cast<int>(source));
  }
  double Variance(int group, NoiseSource source) const {
    const double value = (*this)(group, source);
    return value * value;
  }
  int group_count() const { return static_cast<int>(sd.rows()); }
};

/// Group of each posture: trials whose chains share a joint (head and both arms: the trunk's) are
/// one. All 0 for a table of postures.
std::vector<int> NoiseGroups(const ErrorModel& model, const Recording& recording);

}  // namespace elastocal
