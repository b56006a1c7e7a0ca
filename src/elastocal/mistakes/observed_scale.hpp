// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "elastocal/observation/observation_fit.hpp"
#include "elastocal/screening/camera_scale.hpp"

namespace elastocal {

/// The factor by which all lengths that trackers, wires and cameras measured are off, by the
/// pattern that it leaves in the lengths of the robot, where no robot has that (FindWrongScale).
/// Cameras know no length but the size of the tags. Nothing where no instrument measures lengths,
/// or the lengths do not tell it.
std::optional<CommonScale> FindObservedScale(const ObservedRobot& model,
                                             const Observations& observations,
                                             const ObservationFit& fit);

/// The same in words, with what to correct: "size_mm of the tags seems 1.0239 +- 0.0020 times the
/// true one, ...".
std::string DescribeScale(const CommonScale& scale, const ObservedRobot& model,
                          const Observations& observations);

/// What to write into the project where a tag (-1: all that were seen) is there with `factor` times
/// its size: "measure them again and correct the project, where 80.08 mm would fit instead of 82".
std::string WriteSizeOfTags(const ObservedRobot& model, const Observations& observations, int tag,
                            double factor);

}  // namespace elastocal
