#include "elastocal/robot/statics.hpp"

#include <vector>

namespace elastocal {

Eigen::VectorXd GravityTorques(const RobotTree& tree, const Eigen::VectorXd& q,
                               const Eigen::Vector3d& gravity_waist) {
  const std::vector<Transform> T_root_link = LinkTransforms(tree, q);

  // Mass and first moment (mass times centre of mass) of each body, then of all that it carries.
  std::vector<double> mass(tree.body_count(), 0.0);
  std::vector<Eigen::Vector3d> moment(tree.body_count(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    const Link& link = tree.links[i];
    mass[link.body] += link.mass;
    moment[link.body] += link.mass * (T_root_link[i] * link.com);
  }
  Eigen::VectorXd torques = Eigen::VectorXd::Zero(tree.coordinate_count());
  for (int k = static_cast<int>(tree.joints.size()) - 1; k >= 0; --k) {
    const Joint& joint = tree.joints[k];
    const Transform& T_root_child = T_root_link[joint.child_link];
    const Eigen::Vector3d axis = T_root_child.linear() * joint.axis;
    const Eigen::Vector3d lever = moment[k + 1] - mass[k + 1] * T_root_child.translation();
    const double load = joint.type == JointType::kRevolute ? axis.dot(lever.cross(gravity_waist))
                                                           : mass[k + 1] * axis.dot(gravity_waist);
    torques[joint.coordinate] -= joint.multiplier * load;
    mass[joint.parent_body] += mass[k + 1];
    moment[joint.parent_body] += moment[k + 1];
  }
  return torques;
}

double TotalMass(const RobotTree& tree) {
  double mass = 0.0;
  for (const Link& link : tree.links) mass += link.mass;
  return mass;
}

}  // namespace elastocal
