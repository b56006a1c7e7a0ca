// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/rod_loop.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/math/decompositions.hpp"

namespace elastocal {

using Eigen::Vector3d;

namespace {

double DerivativeOf(RodQuantity quantity, const Vector3d& u, const Vector3d& radial,
                    double by_motor, const RodLinks& links) {
  switch (quantity) {
    case RodQuantity::kLength:
      return -1.0;
    case RodQuantity::kZero:
      return by_motor;
    case RodQuantity::kRadius:
      return u.dot(radial);
    case RodQuantity::kAnchorX:
    case RodQuantity::kAnchorY:
    case RodQuantity::kAnchorZ: {
      const int axis = static_cast<int>(quantity) - static_cast<int>(RodQuantity::kAnchorX);
      return -u.dot(links.T_from_to.linear().col(axis));
    }
    default:
      return u[static_cast<int>(quantity) - static_cast<int>(RodQuantity::kCentreX)];
  }
}

}  // namespace

RodLinks PlaceLinks(const RobotTree& tree, const Linkage& linkage, const Rod& rod,
                    const Eigen::VectorXd& positions) {
  const Link& from = tree.links[rod.from_link];
  const Link& to = tree.links[rod.to_link];
  RodLinks links;
  Transform T = from.T_body_link.inverse();  // maps the body reached so far to the from link
  for (int k : JointsToBody(tree, to.body)) {
    if (k < from.body) continue;  // the joint is before the from link
    const Joint& joint = tree.joints[k];
    const auto found = std::find(linkage.joints.begin(), linkage.joints.end(), k);
    links.joints.push_back(static_cast<int>(found - linkage.joints.begin()));
    T = T * tree.links[joint.parent_link].T_body_link * joint.T_parent_child;
    T = T * RotAxis(joint.axis, positions[links.joints.back()]);
    links.axes.emplace_back(T.linear() * joint.axis);
    links.points.emplace_back(T.translation());
  }
  links.T_from_to = T * to.T_body_link;
  return links;
}

Crank CrankOf(const Rod& rod) {
  Crank crank;
  const Vector3d arm = rod.pin - rod.centre;
  crank.middle = rod.centre + rod.axis.dot(arm) * rod.axis;
  const Vector3d radial = rod.pin - crank.middle;
  crank.radius = radial.norm();
  crank.e1 = radial / crank.radius;
  crank.e2 = rod.axis.cross(crank.e1);
  return crank;
}

Rod WithErrorsOfRod(Rod rod, const double* errors) {
  for (const auto& [quantity, sd] : rod.uncertain) {
    const double error = *errors++;
    switch (quantity) {
      case RodQuantity::kLength:
        rod.length += error;
        break;
      case RodQuantity::kZero: {
        const Crank crank = CrankOf(rod);
        rod.pin =
            crank.middle + crank.radius * (std::cos(error) * crank.e1 + std::sin(error) * crank.e2);
        break;
      }
      case RodQuantity::kRadius:
        rod.pin += error * CrankOf(rod).e1;
        break;
      case RodQuantity::kAnchorX:
      case RodQuantity::kAnchorY:
      case RodQuantity::kAnchorZ:
        rod.anchor[static_cast<int>(quantity) - static_cast<int>(RodQuantity::kAnchorX)] += error;
        break;
      default: {
        const int axis = static_cast<int>(quantity) - static_cast<int>(RodQuantity::kCentreX);
        rod.centre[axis] += error;
        rod.pin[axis] += error;
      }
    }
  }
  return rod;
}

RodLoop EvaluateLoop(const RobotTree& tree, const Linkage& linkage, const Rod& rod, double motor,
                     const Eigen::VectorXd& positions) {
  const RodLinks links = PlaceLinks(tree, linkage, rod, positions);
  const Vector3d anchor = links.T_from_to * rod.anchor;
  Vector3d pin = rod.centre, radial = Vector3d::Zero(), tangent = Vector3d::Zero();
  double length = rod.length;
  if (rod.actuator) {
    length += motor;
  } else {
    const Crank crank = CrankOf(rod);
    radial = std::cos(motor) * crank.e1 + std::sin(motor) * crank.e2;
    pin = crank.middle + crank.radius * radial;
    tangent = crank.radius * rod.axis.cross(radial);
  }
  const Vector3d u = (pin - anchor).normalized();
  RodLoop loop;
  loop.gap = (pin - anchor).norm() - length;
  loop.by_motor = rod.actuator ? -1.0 : u.dot(tangent);
  loop.by_joints.setZero(static_cast<Eigen::Index>(linkage.joints.size()));
  for (std::size_t j = 0; j < links.joints.size(); ++j) {
    loop.by_joints[links.joints[j]] = -u.dot(links.axes[j].cross(anchor - links.points[j]));
  }
  loop.by_errors.resize(static_cast<Eigen::Index>(rod.uncertain.size()));
  for (std::size_t e = 0; e < rod.uncertain.size(); ++e) {
    loop.by_errors[static_cast<Eigen::Index>(e)] =
        DerivativeOf(rod.uncertain[e].quantity, u, radial, loop.by_motor, links);
  }
  return loop;
}

std::vector<RodLoop> EvaluateLoops(const RobotTree& tree, const Linkage& linkage,
                                   const Eigen::VectorXd& motors,
                                   const Eigen::VectorXd& positions) {
  std::vector<RodLoop> loops;
  for (std::size_t i = 0; i < linkage.rods.size(); ++i) {
    loops.push_back(EvaluateLoop(tree, linkage, linkage.rods[i],
                                 motors[static_cast<Eigen::Index>(i)], positions));
  }
  return loops;
}

Eigen::MatrixXd ByJoints(const std::vector<RodLoop>& loops) {
  const auto size = static_cast<Eigen::Index>(loops.size());
  Eigen::MatrixXd J(size, size);
  for (Eigen::Index i = 0; i < size; ++i) J.row(i) = loops[static_cast<std::size_t>(i)].by_joints;
  return J;
}

Eigen::VectorXd GapsOf(const std::vector<RodLoop>& loops) {
  Eigen::VectorXd gaps(static_cast<Eigen::Index>(loops.size()));
  std::transform(loops.begin(), loops.end(), gaps.begin(),
                 [](const RodLoop& loop) { return loop.gap; });
  return gaps;
}

double LeastLever(const std::vector<RodLoop>& loops) {
  double least = SingularValues(ByJoints(loops)).minCoeff();
  for (const RodLoop& loop : loops) least = std::min(least, std::abs(loop.by_motor));
  return least;
}

std::optional<double> MotorOf(const RobotTree& tree, const Linkage& linkage, const Rod& rod,
                              const Eigen::VectorXd& positions, double branch) {
  const Vector3d anchor = PlaceLinks(tree, linkage, rod, positions).T_from_to * rod.anchor;
  if (rod.actuator) return (rod.centre - anchor).norm() - rod.length;
  // |middle + radius (cos e1 + sin e2) - anchor| = length: A cos + B sin = C.
  const Crank crank = CrankOf(rod);
  const Vector3d w = anchor - crank.middle;
  const double A = w.dot(crank.e1), B = w.dot(crank.e2);
  const double C = (w.squaredNorm() + crank.radius * crank.radius - rod.length * rod.length) /
                   (2.0 * crank.radius);
  const double amplitude = std::hypot(A, B);
  if (!(std::abs(C) < amplitude)) return std::nullopt;
  const double angle = std::atan2(B, A) + branch * std::acos(C / amplitude);
  return std::remainder(angle, 2.0 * M_PI);
}

}  // namespace elastocal
