// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/description/calibrated_urdf.hpp"
#include "elastocal/robot/legs.hpp"
#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {

// Files that carry some numbers of a calibration. `heading`: lines of comment at the top.

/// Lines of a comment in YAML and in XML.
std::string YamlComment(const std::vector<std::string>& lines);
std::string XmlComment(const std::vector<std::string>& lines);

/// PAL's seven numbers of each joint: what is added to its origin, and the zero of its encoder.
std::string MakePalYaml(const CalibratedUrdf& urdf, const std::vector<std::string>& heading);

/// The zeros of the encoders as offsets of ros2_control's SimpleTransmission.
std::string MakeRos2Transmissions(const CalibratedUrdf& urdf,
                                  const std::vector<std::string>& heading);

/// Settings of flex-joints (Gepetto), an estimator of the flexibility between waist and legs:
/// `left_stiffness` and `right_stiffness`, about y and x of the root link in this order, N.m/rad.
///
/// A stiffness is the inverse of the sum of what was estimated of the root link at this hip and of
/// the three joints of the hip, each by the square of the cosine between its axis in the zero
/// posture and y or x. Comments give 95 % intervals, from the covariance of these parameters, or
/// without one from their standard deviations alone. `damping` [N.m.s/rad], where given, is the
/// user's and written for both legs and axes: postures at rest tell none.
///
/// `result` and `calibrated` as for SeriesSprings. Throws InputError for a robot that has not two
/// legs, or whose hips do not begin with joints about z, x and y; and where no compliance of the
/// hips is in the calibration.
std::string MakeFlexJointsYaml(const CalibrationResult& result, const RobotTree& calibrated,
                               const std::vector<Leg>& legs, const CalibrationEstimate& estimate,
                               std::optional<double> damping,
                               const std::vector<std::string>& heading);

}  // namespace elastocal
