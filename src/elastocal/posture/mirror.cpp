// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/mirror.hpp"

#include <cmath>

namespace elastocal {

std::optional<MirrorMap> FindMirror(const RobotTree& tree, const std::vector<int>& coordinates,
                                    const std::vector<int>& other, std::string* reason,
                                    double angle, double distance) {
  const auto fail = [&](const std::string& text) -> std::optional<MirrorMap> {
    if (reason != nullptr) *reason = text;
    return std::nullopt;
  };
  if (coordinates.size() != other.size()) return fail("they have different numbers of joints");
  const auto poses = LinkTransforms(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  const Eigen::Vector3d reflect(1.0, -1.0, 1.0);
  MirrorMap map{Eigen::VectorXd(static_cast<Eigen::Index>(coordinates.size()))};
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    const Joint& here = tree.joints[tree.coordinate_joint[coordinates[i]]];
    const Joint& there = tree.joints[tree.coordinate_joint[other[i]]];
    const std::string pair = here.name + " and " + there.name;
    if (here.type != there.type) return fail(pair + " are of different types");
    const bool revolute = here.type == JointType::kRevolute;
    const Eigen::Vector3d wanted =
        (revolute ? -1.0 : 1.0) * reflect.cwiseProduct(poses[here.child_link].linear() * here.axis);
    const Eigen::Vector3d found = poses[there.child_link].linear() * there.axis;
    if (wanted.cross(found).norm() > std::sin(angle)) {
      return fail("the axes of " + pair + " are not mirror images");
    }
    // The place of a revolute joint along its axis does not matter.
    const Eigen::Vector3d offset = poses[there.child_link].translation() -
                                   reflect.cwiseProduct(poses[here.child_link].translation());
    if (revolute && offset.cross(found).norm() > distance) {
      return fail("the axes of " + pair + " are parallel to their mirror images, but elsewhere");
    }
    map.sign[static_cast<Eigen::Index>(i)] = wanted.dot(found) > 0.0 ? 1.0 : -1.0;
  }
  return map;
}

}  // namespace elastocal
