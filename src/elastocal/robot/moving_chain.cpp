// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/moving_chain.hpp"

#include <algorithm>

namespace elastocal {

using Eigen::Vector3d;

namespace {

/// Factor by which an entry of q moves the joint.
double Multiplier(const Joint& joint, int coordinate) {
  double sum = 0.0;
  for (const Drive& drive : DrivesOf(joint)) {
    if (drive.coordinate == coordinate) sum += drive.multiplier;
  }
  return sum;
}

}  // namespace

std::vector<int> ChainCoordinates(const RobotTree& tree, int from_link, int tip_link) {
  std::vector<int> joints = JointsToBody(tree, tree.links[tip_link].body);
  const auto from = std::find(joints.begin(), joints.end(), tree.links[from_link].body - 1);
  if (from != joints.end()) joints.erase(joints.begin(), from + 1);
  std::vector<int> coordinates;
  for (int joint : joints) {
    for (const Drive& drive : DrivesOf(tree.joints[joint])) {
      if (std::find(coordinates.begin(), coordinates.end(), drive.coordinate) ==
          coordinates.end()) {
        coordinates.push_back(drive.coordinate);
      }
    }
  }
  return coordinates;
}

MovingChain::MovingChain(const RobotTree& tree, std::vector<int> coordinates, Eigen::VectorXd rest)
    : tree_(tree), coordinates_(std::move(coordinates)), q_(std::move(rest)), driven_(1) {
  carries_.assign(tree_.joints.size(), std::vector<char>(tree_.joints.size(), 0));
  for (std::size_t k = 0; k < tree_.joints.size(); ++k) {
    const Joint& joint = tree_.joints[k];
    for (int inner : JointsToBody(tree_, static_cast<int>(k) + 1)) carries_[inner][k] = 1;
    driven_.push_back(driven_[joint.parent_body]);
    for (const Drive& drive : DrivesOf(joint)) {
      const auto found = std::find(coordinates_.begin(), coordinates_.end(), drive.coordinate);
      if (found == coordinates_.end()) continue;
      driven_.back().push_back(
          {static_cast<int>(k), static_cast<int>(found - coordinates_.begin()), drive.multiplier});
      all_driven_.push_back(driven_.back().back());
    }
  }
  Move(q_(coordinates_));
}

Eigen::VectorXd MovingChain::FullPosture(const Eigen::VectorXd& x) const {
  Eigen::VectorXd q = q_;
  q(coordinates_) = x;
  return q;
}

void MovingChain::Move(const Eigen::VectorXd& x) {
  q_(coordinates_) = x;
  T_root_link_ = LinkTransforms(tree_, q_);
  carried_ = CarriedLoads(tree_, T_root_link_, 0);
}

Vector3d MovingChain::Axis(int joint) const {
  return T_root_link_[tree_.joints[joint].child_link].linear() * tree_.joints[joint].axis;
}

Vector3d MovingChain::Origin(int joint) const {
  return T_root_link_[tree_.joints[joint].child_link].translation();
}

Eigen::Matrix3Xd MovingChain::PointJacobian(int link, const Vector3d& p_root_point) const {
  Eigen::Matrix3Xd J = Eigen::Matrix3Xd::Zero(3, size());
  for (const Driven& d : driven_[tree_.links[link].body]) {
    const Vector3d axis = Axis(d.joint);
    J.col(d.variable) += d.multiplier * (tree_.joints[d.joint].type == JointType::kRevolute
                                             ? axis.cross(p_root_point - Origin(d.joint))
                                             : axis);
  }
  return J;
}

Eigen::Matrix3Xd MovingChain::RotationJacobian(int link) const {
  Eigen::Matrix3Xd J = Eigen::Matrix3Xd::Zero(3, size());
  for (const Driven& d : driven_[tree_.links[link].body]) {
    if (tree_.joints[d.joint].type == JointType::kRevolute) {
      J.col(d.variable) += d.multiplier * Axis(d.joint);
    }
  }
  return J;
}

Eigen::RowVectorXd MovingChain::JacobianGradient(int link, const Eigen::VectorXd& u,
                                                 const Eigen::VectorXd& v) const {
  const Vector3d end = T_root_link_[link].translation();
  const auto turns = [&](const Driven& d) {
    return tree_.joints[d.joint].type == JointType::kRevolute;
  };
  const auto slide = [&](const Driven& d) -> Vector3d {
    return turns(d) ? Axis(d.joint).cross(end - Origin(d.joint)) : Axis(d.joint);
  };
  Eigen::RowVectorXd gradient = Eigen::RowVectorXd::Zero(size());
  for (const Driven& moved : driven_[tree_.links[link].body]) {  // its column of J ...
    for (const Driven& by : driven_[tree_.links[link].body]) {   // ... when this one moves
      // The inner one of the two turns what the outer one does.
      const bool carried = carries_[by.joint][moved.joint] != 0;
      const Driven& inner = carried ? by : moved;
      if (!turns(inner)) continue;
      double change = u.head<3>().dot(Axis(inner.joint).cross(slide(carried ? moved : by)));
      if (carried && turns(moved)) {
        change += u.tail<3>().dot(Axis(by.joint).cross(Axis(moved.joint)));
      }
      gradient[by.variable] += by.multiplier * moved.multiplier * v[moved.variable] * change;
    }
  }
  return gradient;
}

/// Derivative of the first moment of all masses by a joint, kg.m/rad or kg.
Vector3d MovingChain::MomentGradient(int joint) const {
  const CarriedLoad& load = carried_[joint];
  if (tree_.joints[joint].type == JointType::kPrismatic) return load.mass * Axis(joint);
  return Axis(joint).cross(load.moment - load.mass * Origin(joint));
}

/// Second derivative of the potential energy by two joints, of which `inner` carries `outer`: it
/// turns what `outer` moves.
double MovingChain::PotentialCurvature(int inner, int outer) const {
  if (tree_.joints[inner].type == JointType::kPrismatic) return 0.0;
  return -Axis(inner).cross(MomentGradient(outer)).dot(kGravity);
}

double MovingChain::GravityTorque(int coordinate) const {
  double torque = 0.0;
  for (std::size_t k = 0; k < tree_.joints.size(); ++k) {
    if (!IsMovedBy(tree_.joints[k], coordinate)) continue;
    torque -=
        Multiplier(tree_.joints[k], coordinate) * MomentGradient(static_cast<int>(k)).dot(kGravity);
  }
  return torque;
}

Eigen::RowVectorXd MovingChain::GravityTorqueGradient(int coordinate) const {
  Eigen::RowVectorXd gradient = Eigen::RowVectorXd::Zero(size());
  for (std::size_t k = 0; k < tree_.joints.size(); ++k) {
    if (!IsMovedBy(tree_.joints[k], coordinate)) continue;
    const int joint = static_cast<int>(k);
    for (const Driven& d : all_driven_) {
      const double factor = Multiplier(tree_.joints[k], coordinate) * d.multiplier;
      if (carries_[d.joint][joint]) {
        gradient[d.variable] += factor * PotentialCurvature(d.joint, joint);
      } else if (carries_[joint][d.joint]) {
        gradient[d.variable] += factor * PotentialCurvature(joint, d.joint);
      }
    }
  }
  return gradient;
}

Eigen::VectorXd MovingChain::LoadGradient(const std::vector<LoadComponent>& components,
                                          const Vector3d& gravity) const {
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size());
  for (const Driven& d : all_driven_) {
    const bool turns = tree_.joints[d.joint].type == JointType::kRevolute;
    const Vector3d moved = MomentGradient(d.joint).cross(gravity);
    double sum = 0.0;
    for (const LoadComponent& c : components) {
      const bool slides = c.joint >= 0 && tree_.joints[c.joint].type == JointType::kPrismatic;
      if (c.joint >= 0 && c.joint != d.joint && carries_[d.joint][c.joint]) {
        // The whole robot turns, which is as if gravity turned the other way.
        if (!turns) continue;
        const CarriedLoad& carried = carried_[c.joint];
        const Vector3d back = gravity.cross(Axis(d.joint));
        sum += slides ? carried.mass * c.direction.dot(back)
                      : c.direction.dot((carried.moment - carried.mass * c.point).cross(back));
      } else if (!slides && (c.joint < 0 || carries_[c.joint][d.joint])) {
        sum += c.direction.dot(moved);
      }
    }
    gradient[d.variable] += d.multiplier * sum;
  }
  return gradient;
}

}  // namespace elastocal
