// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "elastocal/observation/observation_fit.hpp"
#include "elastocal/screening/camera_scale.hpp"

namespace elastocal {

/// Finds the factor by which all lengths measured by trackers, wires and cameras deviate from the
/// true ones, by its pattern in the lengths of the robot, if no robot has that pattern
/// (FindWrongScale). Cameras know no length but the size of the tags. Nothing where no instrument
/// measures lengths, or where the robot's lengths do not determine the factor.
std::optional<CommonScale> FindObservedScale(const ObservedRobot& model,
                                             const Observations& observations,
                                             const ObservationFit& fit);

/// The factor as text, with the correction: "size_mm of the tags seems 1.0239 +- 0.0020 times the
/// true one, ...".
std::string DescribeScale(const CommonScale& scale, const ObservedRobot& model,
                          const Observations& observations);

/// Text that says what to write into the project if a tag (-1: all seen tags) has `factor` times
/// its size there: "measure them again and correct the project, where 80.08 mm would fit instead of
/// 82".
std::string WriteSizeOfTags(const ObservedRobot& model, const Observations& observations, int tag,
                            double factor);

}  // namespace elastocal
