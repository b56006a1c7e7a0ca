// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/runtime/compensator.hpp"

namespace elastocal {

/// The worst value over a motion, and where it occurs.
struct MotionExtreme {
  double value = 0.0;
  double time_s = 0.0;
  std::string where = {};  ///< a joint or a pair of parts
};

/// Deviation of the end of a limb from its place in a motion, due to limits. It is a distance, to
/// which an angle adds the displacement that it causes at `arm_m`.
struct LeftAtLimb {
  std::string limb;  ///< a chain of the project
  MotionExtreme most;
  MotionExtreme most_turned;  ///< the angle by itself, rad
  int samples = 0;            ///< number of samples with a larger deviation than kLeftOver_m
  /// The limb has fewer than six joints and shares some with a limb of at least six, whose end has
  /// priority: for example a head on a trunk that carries arms.
  bool yields = false;
  double arm_m = 0.0;  ///< ec_tip::arm
  /// The limb has too few joints for place and attitude, and its angles count a tenth.
  bool place_first = false;
};

inline constexpr double kLeftOver_m = 2e-4;

/// Takes over a value that is larger than that of the extreme.
void KeepLarger(double value, double time_s, const std::string& where, MotionExtreme& extreme);

/// An entry without deviation for each tip of the model.
std::vector<LeftAtLimb> NothingLeft(const RuntimeModel& model);

/// Examines a sample after its Command. `left` is by tip of the model.
void LookAtLimbs(const Compensator& compensator, double time_s, std::vector<LeftAtLimb>& left);

/// A sentence for each bound that a limb exceeds: its deviation `most_left_m`, and its angle
/// `most_turned_rad` where the place comes first.
std::vector<std::string> Exceeded(const LeftAtLimb& one, double most_left_m,
                                  double most_turned_rad);

}  // namespace elastocal
