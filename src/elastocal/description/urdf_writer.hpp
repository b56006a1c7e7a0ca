// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include <Eigen/Core>

namespace elastocal {

/// Origin of a joint in a URDF: m and rad.
struct UrdfOrigin {
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero(), rpy = Eigen::Vector3d::Zero();
};

/// Origins of all joints of a URDF as they are written there, by name; zeros for a joint without
/// origin.
std::map<std::string, UrdfOrigin> ReadOrigins(const std::string& urdf, const std::string& source);

/// Replaces the origins of the given joints in a URDF, with 17 significant digits. Every other byte
/// stays as it is: comments, order, spaces and everything that this program does not know. Throws
/// InputError if a joint is not in the text.
std::string ReplaceOrigins(const std::string& urdf, const std::string& source,
                           const std::map<std::string, UrdfOrigin>& origins);

/// Adds `shifts` [rad, m] to the reference positions of joints in a URDF, `<calibration rising>`
/// and `falling`. A reference position is the position of the joint in this URDF at the encoder's
/// reference. A joint without them gets `rising`, with the reference at the encoder's zero. Throws
/// InputError like ReplaceOrigins.
std::string ShiftReferencePositions(const std::string& urdf, const std::string& source,
                                    const std::map<std::string, double>& shifts);

}  // namespace elastocal
