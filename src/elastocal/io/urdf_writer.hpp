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

}  // namespace elastocal
