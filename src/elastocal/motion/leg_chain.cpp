#include "elastocal/motion/leg_chain.hpp"

#include <algorithm>
#include <string>

#include <Eigen/LU>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/rotation_vector.hpp"

namespace elastocal {

LegChain::LegChain(const RobotTree& tree, int sole_link)
    : tree_(tree),
      sole_link_(sole_link),
      joints_(JointsToBody(tree, tree.links[static_cast<std::size_t>(sole_link)].body)) {
  bool own = joints_.size() == 6;
  for (const int k : joints_) {
    const Joint& joint = tree.joints[static_cast<std::size_t>(k)];
    own = own && !joint.mimic && joint.type == JointType::kRevolute;
    coordinates_.push_back(joint.coordinate);
  }
  if (own) return;
  throw InputError("robot '" + tree.name + "': '" +
                   tree.links[static_cast<std::size_t>(sole_link)].name + "' is at the end of " +
                   std::to_string(joints_.size()) +
                   " joints; expected a leg of six revolute joints of its own to balance on");
}

Transform LegChain::Evaluate(const Eigen::VectorXd& q, Eigen::Matrix<double, 6, 6>& screws) const {
  // Each column is a rotation and the velocity of the point at the root's origin.
  Transform T = Transform::Identity();
  for (int i = 0; i < 6; ++i) {
    const int k = joints_[static_cast<std::size_t>(i)];
    T = T * ParentBodyToChild(tree_, k, q);
    const Eigen::Vector3d axis = T.linear() * tree_.joints[static_cast<std::size_t>(k)].axis;
    screws.col(i).head<3>() = axis;
    screws.col(i).tail<3>() = T.translation().cross(axis);
  }
  return T * tree_.links[static_cast<std::size_t>(sole_link_)].T_body_link;
}

Transform LegChain::SolePose(const Eigen::VectorXd& q) const {
  Eigen::Matrix<double, 6, 6> screws;
  return Evaluate(q, screws);
}

bool LegChain::Place(const Transform& T_root_sole, Eigen::VectorXd& q) const {
  constexpr int kIterations = 40;
  constexpr double kReached = 1e-11;
  constexpr double kLargestMove = 0.3;  // rad
  Eigen::Matrix<double, 6, 6> screws;
  for (int i = 0; i < kIterations; ++i) {
    const Transform found = Evaluate(q, screws);
    const Eigen::Vector3d turn = RotationVector(T_root_sole.linear() * found.linear().transpose());
    const Eigen::Vector3d move = T_root_sole.translation() - found.translation();
    if (turn.norm() < kReached && move.norm() < kReached) return true;
    Eigen::Matrix<double, 6, 1> wanted;
    wanted << turn, move - turn.cross(found.translation());
    Eigen::Matrix<double, 6, 1> step = screws.partialPivLu().solve(wanted);
    const double largest = step.cwiseAbs().maxCoeff();
    if (!(largest < 1e6)) return false;
    step *= std::min(1.0, kLargestMove / std::max(largest, 1e-12));
    for (int j = 0; j < 6; ++j) q[coordinates_[static_cast<std::size_t>(j)]] += step[j];
  }
  return false;
}

}  // namespace elastocal
