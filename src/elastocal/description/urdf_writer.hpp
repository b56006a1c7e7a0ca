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

/// Origins of all joints of a URDF as written there (zeros where it has no origin), by name.
std::map<std::string, UrdfOrigin> ReadOrigins(const std::string& urdf, const std::string& source);

/// The URDF with the origins of the given joints replaced and not a byte else changed: comments,
/// order, spaces and everything that this program does not know stay. 17 significant digits.
/// Throws InputError when a joint is not in the text.
std::string ReplaceOrigins(const std::string& urdf, const std::string& source,
                           const std::map<std::string, UrdfOrigin>& origins);

/// The URDF with `shifts` [rad, m] added to the reference positions of joints, `<calibration
/// rising>` and `falling`: where a joint of this URDF stands at the encoder's reference. A joint
/// without them gets `rising` with a reference at the encoder's zero. Throws InputError like
/// ReplaceOrigins.
std::string ShiftReferencePositions(const std::string& urdf, const std::string& source,
                                    const std::map<std::string, double>& shifts);

}  // namespace elastocal
