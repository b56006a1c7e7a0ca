// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "elastocal/project/project.hpp"
#include "elastocal/recorded/measurements.hpp"

namespace elastocal {

/// An up direction with which the deflection of a robot under gravity explains a recording, while
/// it does not with the stated one.
struct UpByLoads {
  std::string axis;  ///< axis of the markers' frame that points up: "y", "-x"
  /// Rms distance of the markers from a robot with elastic joints, with the stated axis up, m.
  double stated = 0.0;
  double found = 0.0;  ///< the same with `axis` up, m
};

/// Tries each axis of the markers' frame as the up axis, for a robot whose root link is held (for a
/// robot on its feet: FindWrongUp) and whose joints' loads follow from statics. An axis is returned
/// if the error of a fit falls to less than 0.6 of that with the stated axis. It is also returned
/// if the error falls below that of a rigid robot and of the `calibrated` one [m, with its causes],
/// while springs explain nothing with the stated axis. Faults of joints may look like this, too:
/// the caller has to check that a few of them leave more error with the stated axis. A rigid robot
/// shows nothing, because nothing depends on gravity. `as_recorded` is the recording before markers
/// were split at knocks.
std::optional<UpByLoads> FindUpByLoads(const Project& given, std::optional<std::uint64_t> seed,
                                       const Measurements& as_recorded, double calibrated);

/// Text such as "up: with y up, elastic joints explain the recording to 0.35 mm, with z up only to
/// 1.3 mm ...".
std::string Describe(const UpByLoads& found, const Recording& recording);

}  // namespace elastocal
