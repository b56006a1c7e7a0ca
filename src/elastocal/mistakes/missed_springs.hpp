// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "elastocal/project/project.hpp"
#include "elastocal/recorded/measurements.hpp"

namespace elastocal {

/// Describes that a fit contradicts a project that holds joints or legs rigid; empty if it does
/// not. It does if, with all joints and legs elastic, less than half of the error is left, and less
/// than `left_otherwise` (the error with the faults that were found; infinite: none explain it).
/// Joints that deflect under gravity look like wrong gains, like offsets in the trials in which a
/// leg stands, or like positions that scatter. `left` is the rms distance of the markers from the
/// fitted rigid robot, m. Only for trials.
std::string FindMissedSprings(const Project& project, std::optional<std::uint64_t> seed,
                              const Measurements& as_recorded, double left, double left_otherwise);

}  // namespace elastocal
