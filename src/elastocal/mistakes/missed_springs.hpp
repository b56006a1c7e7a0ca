// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "elastocal/project/project.hpp"
#include "elastocal/recorded/measurements.hpp"

namespace elastocal {

/// Whether a project that holds joints or legs rigid is what a fit contradicts: with all joints and
/// legs elastic, less than half of the error is left, and less than `left_otherwise` (by the faults
/// that were found; infinite: none explain it). In words, else empty. Joints that give way under
/// gravity look like wrong gains, offsets of the trials in which a leg stands, or positions that
/// scatter. `left`: rms distance of the markers from the rigid robot as fitted, m. Of trials.
std::string FindMissedSprings(const Project& project, std::optional<std::uint64_t> seed,
                              const Measurements& as_recorded, double left, double left_otherwise);

}  // namespace elastocal
