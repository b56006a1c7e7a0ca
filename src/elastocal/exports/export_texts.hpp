// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/description/calibrated_urdf.hpp"
#include "elastocal/robot/legs.hpp"
#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {

// Files with some numbers of a calibration. `heading` holds comment lines for the top of the file.

/// Lines of a comment in YAML and in XML.
std::string YamlComment(const std::vector<std::string>& lines);
std::string XmlComment(const std::vector<std::string>& lines);

/// PAL's seven numbers of each joint: the change of its origin, and the zero of its encoder.
std::string MakePalYaml(const CalibratedUrdf& urdf, const std::vector<std::string>& heading);

/// The zeros of the encoders as offsets of ros2_control's SimpleTransmission.
std::string MakeRos2Transmissions(const CalibratedUrdf& urdf,
                                  const std::vector<std::string>& heading);

/// Settings of flex-joints (Gepetto), an estimator of the flexibility between waist and legs:
/// `left_stiffness` and `right_stiffness`, about y and x of the root link in this order, N.m/rad.
///
/// A stiffness is the inverse of a sum of estimated compliances: those of the root link at this
/// hip, and those of the three joints of the hip, each times the square of the cosine between its
/// axis in the zero posture and y or x. Comments give 95 % intervals, from the covariance of these
/// parameters, or without one from their standard deviations alone. `damping` [N.m.s/rad], if
/// given, is the user's value and is written for both legs and axes, because postures at rest do
/// not determine it.
///
/// `result` and `calibrated` are as for SeriesSprings. Throws InputError for a robot that does not
/// have two legs, or whose hips do not begin with joints about z, x and y, and where the
/// calibration has no compliance of the hips.
std::string MakeFlexJointsYaml(const CalibrationResult& result, const RobotTree& calibrated,
                               const std::vector<Leg>& legs, const CalibrationEstimate& estimate,
                               std::optional<double> damping,
                               const std::vector<std::string>& heading);

}  // namespace elastocal
