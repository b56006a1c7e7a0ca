// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// Sources of what the model leaves unexplained. Each has its own standard deviation (variance
/// components).
enum class NoiseSource {
  /// Independent for each marker coordinate: noise of the cameras, and rotations of a body; m.
  kMarker,
  kBodyPosition,  ///< displacement that all markers of a body share in a posture; m
  /// Difference between the waist's position by its markers and by the elastic leg on its foot (the
  /// constraint of eq. 14); m.
  kWaistPosition,
  kWaistRotation,  ///< the same difference of rotations; rad
};
inline constexpr int kNoiseSourceCount = 4;

/// marker, body_position, waist_position, waist_rotation
const char* NoiseSourceName(NoiseSource source);

/// Correlation of neighbouring moments of a motion.
struct Autocorrelation {
  double lag_one = 0.0;       ///< correlation from one moment to the next
  double samples_each = 1.0;  ///< number of moments that tell as much as one independent posture
};

/// Correlation of errors between moments of a motion: of the displacement that the markers of a
/// body share, and of the residual of the standing foot's constraint (eq. 14). See
/// FindMotionCorrelation.
struct MotionCorrelation {
  Autocorrelation bodies;
  Autocorrelation waist;
};

/// Standard deviations by group of postures and by source. Groups are separate because chains
/// differ in how well the model fits them: a badly fitting leg must not blur an arm. Errors of the
/// model, which all markers of a body share, are separated from the noise of the cameras, which
/// averages out. On real robots they are most of the residual, and treating the markers of a body
/// as independent would make standard deviations too small.
struct Noise {
  Eigen::ArrayXXd sd;  ///< groups x sources
  /// By group; empty where no posture belongs to a motion.
  std::vector<MotionCorrelation> motion = {};

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

/// Group of each posture. Trials whose chains share a joint form one group (head and both arms
/// share the trunk). All 0 for a posture table.
std::vector<int> NoiseGroups(const ErrorModel& model, const Recording& recording);

}  // namespace elastocal
