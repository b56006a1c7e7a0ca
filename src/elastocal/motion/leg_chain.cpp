// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/leg_chain.hpp"

#include <algorithm>
#include <string>

#include <Eigen/LU>

#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/robot/moving_chain.hpp"

namespace elastocal {

namespace {

/// The shortest step of the joints that gives the wanted motion, or comes nearest to it.
Eigen::VectorXd LeastStep(const Eigen::MatrixXd& screws, const Eigen::VectorXd& wanted) {
  if (screws.cols() == screws.rows()) return screws.partialPivLu().solve(wanted);
  return ShortestSolution(screws, wanted);
}

/// Derivatives of a point by the coordinates, 3 x coordinates, from the screws of its body about
/// the root's origin.
Eigen::MatrixXd PointMoves(const Eigen::MatrixXd& screws, const Eigen::Vector3d& point) {
  return screws.bottomRows(3) - Skew(point) * screws.topRows(3);
}

/// Sum of the distances between the joints that carry a link, from the first one to the link, m.
double LengthOf(const RobotTree& tree, int link) {
  const auto poses = LinkTransforms(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  double length = 0.0;
  Eigen::Vector3d end = poses[static_cast<std::size_t>(link)].translation();
  const std::vector<int> joints =
      JointsToBody(tree, tree.links[static_cast<std::size_t>(link)].body);
  for (std::size_t k = joints.size(); k-- > 0;) {
    const int child = tree.joints[static_cast<std::size_t>(joints[k])].child_link;
    const Eigen::Vector3d here = poses[static_cast<std::size_t>(child)].translation();
    length += (end - here).norm();
    end = here;
  }
  return length;
}

}  // namespace

LegChain::LegChain(const RobotTree& tree, const Sole& sole, const std::vector<Sole>& soles)
    : tree_(tree),
      sole_link_(sole.link),
      on_ball_(sole.ball_radius.has_value()),
      joints_(JointsToBody(tree, tree.links[static_cast<std::size_t>(sole.link)].body)) {
  for (const int c : ChainCoordinates(tree, 0, sole_link_)) {
    const bool shared = std::any_of(soles.begin(), soles.end(), [&](const Sole& other) {
      const std::vector<int> others = ChainCoordinates(tree, 0, other.link);
      return other.link != sole_link_ && std::find(others.begin(), others.end(), c) != others.end();
    });
    (shared ? shared_ : coordinates_).push_back(c);
  }
  turns_root_ = !shared_.empty() && !on_ball_ && coordinates_.size() < 6;
  length_ = LengthOf(tree, sole_link_);
  if (coordinates_.size() >= LeastLegJoints(on_ball_)) return;
  throw InputError(
      "robot '" + tree.name + "': '" + tree.links[static_cast<std::size_t>(sole_link_)].name +
      "' is at the end of " + std::to_string(joints_.size()) + " joints" +
      (shared_.empty() ? "" : ", " + std::to_string(coordinates_.size()) + " of them its own") +
      "; expected a leg of " + (on_ball_ ? "three" : "five") +
      " or more joints of its own to balance on");
}

Transform LegChain::Evaluate(const Eigen::VectorXd& q, Eigen::MatrixXd& screws) const {
  screws.setZero(6, static_cast<Eigen::Index>(coordinates_.size()));
  Transform T = Transform::Identity();
  for (const int k : joints_) {
    const Joint& joint = tree_.joints[static_cast<std::size_t>(k)];
    T = T * ParentBodyToChild(tree_, k, q);
    const Eigen::Vector3d axis = T.linear() * joint.axis;
    Eigen::Matrix<double, 6, 1> screw;
    if (joint.type == JointType::kRevolute) {
      screw << axis, T.translation().cross(axis);
    } else {
      screw << Eigen::Vector3d::Zero(), axis;
    }
    for (const Drive& drive : DrivesOf(joint)) {
      const auto at = std::find(coordinates_.begin(), coordinates_.end(), drive.coordinate);
      if (at == coordinates_.end()) continue;
      screws.col(at - coordinates_.begin()) += drive.multiplier * screw;
    }
  }
  return T * tree_.links[static_cast<std::size_t>(sole_link_)].T_body_link;
}

Transform LegChain::SolePose(const Eigen::VectorXd& q) const {
  Eigen::MatrixXd screws;
  return Evaluate(q, screws);
}

void LegChain::Prefer(const Eigen::VectorXd& q) {
  const auto count = static_cast<Eigen::Index>(coordinates_.size());
  if (count <= placed()) return;
  Eigen::MatrixXd moves;
  const Transform T_root_sole = Evaluate(q, moves);
  if (on_ball_) moves = PointMoves(moves, T_root_sole.translation());
  preferred_ = q(coordinates_);
  still_ = OrthogonalFactor(moves.transpose()).rightCols(count - placed()).transpose();
}

bool LegChain::Place(const Transform& T_root_sole, Eigen::VectorXd& q) const {
  return Solve(T_root_sole, Turns::kNothing, Eigen::Vector3d::UnitZ(), q).has_value();
}

bool LegChain::PlaceFlat(const Transform& T_root_sole, Eigen::VectorXd& q) const {
  const Turns turns = !on_ball_ && coordinates_.size() < 6 ? Turns::kSole : Turns::kNothing;
  return Solve(T_root_sole, turns, Eigen::Vector3d::UnitZ(), q).has_value();
}

bool LegChain::PlaceUnderRoot(const Transform& T_world_sole, Transform& T_world_root,
                              Eigen::VectorXd& q) const {
  const Eigen::Vector3d up = T_world_root.linear().transpose() * Eigen::Vector3d::UnitZ();
  const auto turned = Solve(T_world_root.inverse() * T_world_sole,
                            turns_root_ ? Turns::kRoot : Turns::kNothing, up, q);
  if (!turned) return false;
  if (turns_root_) T_world_root.linear() = T_world_root.linear() * RotAxis(up, *turned).linear();
  return true;
}

std::optional<double> LegChain::Solve(Transform T_root_sole, Turns turns, const Eigen::Vector3d& up,
                                      Eigen::VectorXd& q) const {
  constexpr int kIterations = 40;
  constexpr double kReached = 1e-11;
  constexpr double kLargestMove = 0.3;  // rad
  Eigen::MatrixXd screws;
  double turned = 0.0;
  for (int i = 0; i < kIterations; ++i) {
    const Transform found = Evaluate(q, screws);
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();
    if (!on_ball_) turn = RotationVector(T_root_sole.linear() * found.linear().transpose());
    if (turns == Turns::kRoot) {
      screws.conservativeResize(Eigen::NoChange, screws.cols() + 1);
      screws.rightCols<1>() << up, Eigen::Vector3d::Zero();
    }
    if (turns == Turns::kSole) {  // the turn about the normal is one more unknown
      const Eigen::Vector3d normal = T_root_sole.linear().col(2);
      screws.conservativeResize(Eigen::NoChange, screws.cols() + 1);
      screws.rightCols<1>() << normal, found.translation().cross(normal);
      turn -= normal * normal.dot(turn);
    }
    const Eigen::Vector3d move = T_root_sole.translation() - found.translation();
    Eigen::VectorXd off;
    if (still_.rows() > 0) off = still_ * (preferred_ - q(coordinates_));
    if (turn.norm() < kReached && move.norm() < kReached && off.norm() < kReached) {
      return turned;
    }
    Eigen::VectorXd wanted(6);
    wanted << turn, move - turn.cross(found.translation());
    if (on_ball_) {
      wanted = move;
      screws = PointMoves(screws, found.translation());
    }
    if (still_.rows() > 0) {
      wanted.conservativeResize(placed() + off.size());
      wanted.tail(off.size()) = off;
      screws.conservativeResize(wanted.size(), Eigen::NoChange);
      screws.bottomRows(still_.rows()) = still_;
    }
    Eigen::VectorXd step = LeastStep(screws, wanted);
    const double largest = step.cwiseAbs().maxCoeff();
    if (!(largest < 1e6)) return std::nullopt;
    step *= std::min(1.0, kLargestMove / std::max(largest, 1e-12));
    q(coordinates_) += step.head(static_cast<Eigen::Index>(coordinates_.size()));
    if (turns == Turns::kRoot) {
      T_root_sole = RotAxis(up, -step[step.size() - 1]) * T_root_sole;
      turned += step[step.size() - 1];
    }
  }
  return std::nullopt;
}

}  // namespace elastocal
