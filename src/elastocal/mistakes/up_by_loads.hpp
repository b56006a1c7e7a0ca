// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "elastocal/project/project.hpp"
#include "elastocal/recorded/measurements.hpp"

namespace elastocal {

/// A direction up by which gravity bends a robot as a recording shows, and the stated one does not.
struct UpByLoads {
  std::string axis;     ///< of the frame of the markers: "y", "-x"
  double stated = 0.0;  ///< rms distance of the markers from a robot with elastic joints, as stated
  double found = 0.0;   ///< the same with `axis` up, m
};

/// Tries each axis of the frame of the markers as the one that points up, on a recording of a robot
/// whose root link is held (a robot on its feet: FindWrongUp) and whose joints carry what statics
/// say. Found is an axis with which the error of a fit falls to less than 0.6 of that with the
/// stated one, or to less than that of a rigid robot and of the `calibrated` one [m, with its
/// causes], while springs explain nothing with the stated axis. Faults of joints may look like that
/// too: that few of them leave more with the stated one, the caller has to see. A rigid robot shows
/// nothing: nothing depends on gravity then.
/// `as_recorded`: before markers were split at knocks.
std::optional<UpByLoads> FindUpByLoads(const Project& given, std::optional<std::uint64_t> seed,
                                       const Measurements& as_recorded, double calibrated);

/// "up: with y up, elastic joints explain the recording to 0.35 mm, with z up only to 1.3 mm ..."
std::string Describe(const UpByLoads& found, const Recording& recording);

}  // namespace elastocal
