// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/placement.hpp"

#include <cmath>

namespace elastocal {
namespace {

using Eigen::Vector3d;

/// An axis of rotation or sliding at zero positions, in the root link's frame.
struct Axis {
  Vector3d point, direction;
};

/// The common normal (for parallel axes, a perpendicular) from one axis to the next: its two ends
/// and its direction.
struct Normal {
  Vector3d start, end, x;
};

constexpr double kSameLength = 1e-9;  // m; axes closer than this meet
// m; small errors turn the perpendicular between parallel axes that are closer than this by much.
constexpr double kCoaxial = 0.02;
// rad; beta is singular between axes at right angles, and is needed only near parallel ones.
constexpr double kMostInclined = M_PI / 4.0;

Vector3d ClosestPoint(const Axis& axis, const Vector3d& p) {
  return axis.point + axis.direction * axis.direction.dot(p - axis.point);
}

Vector3d AnyPerpendicular(const Vector3d& z, const Transform& T_root_body) {
  const Vector3d x = T_root_body.linear().col(0);
  const Vector3d candidate = std::abs(x.dot(z)) < 0.9 ? x : Vector3d(T_root_body.linear().col(1));
  return (candidate - z * z.dot(candidate)).normalized();
}

bool Coaxial(const Normal& between) { return (between.end - between.start).norm() < kCoaxial; }

/// Hayati: the perpendicular from `start`, a point of the first axis, to the second axis. If the
/// two axes coincide, `x_in` gives its direction.
Normal PerpendicularFrom(const Vector3d& start, const Axis& to, const Vector3d& x_in) {
  Normal normal{start, ClosestPoint(to, start), {}};
  normal.x = normal.end - normal.start;
  if (Coaxial(normal)) normal.x = x_in - to.direction * to.direction.dot(x_in);
  normal.x.normalize();
  return normal;
}

Normal CommonNormal(const Axis& from, const Axis& to) {
  const Vector3d across = from.direction.cross(to.direction);
  const Vector3d between = to.point - from.point;
  const double s = between.cross(to.direction).dot(across) / across.squaredNorm();
  const double t = between.cross(from.direction).dot(across) / across.squaredNorm();
  const Vector3d start = from.point + s * from.direction;
  const Vector3d end = to.point + t * to.direction;
  const double distance = between.dot(across) / across.norm();
  const double sign = std::abs(distance) > kSameLength && distance < 0.0 ? -1.0 : 1.0;
  return {start, end, sign * across.normalized()};
}

/// Whether the placement needs beta: the axes are parallel or nearly so, or they are inclined and
/// their common normal is so far away that small errors move it by much.
bool NeedsBeta(const Axis& a, const Axis& b, const PlacementOptions& options) {
  const double sine = a.direction.cross(b.direction).norm();
  if (sine < std::sin(options.parallel_tolerance_rad)) return true;
  if (sine > std::sin(kMostInclined)) return false;
  return (CommonNormal(a, b).end - b.point).norm() > options.longest_lever_m * sine;
}

/// Whether the joint of a body is prismatic. Then only the direction of its axis has a meaning.
bool Slides(const RobotTree& tree, int body) {
  return body > 0 && tree.joints[body - 1].type == JointType::kPrismatic;
}

Transform Frame(const Vector3d& origin, const Vector3d& z, const Vector3d& x) {
  Transform T;
  T.linear().col(2) = z;
  T.linear().col(0) = (x - z * z.dot(x)).normalized();
  T.linear().col(1) = T.linear().col(2).cross(T.linear().col(0));
  T.translation() = origin;
  T.makeAffine();
  return T;
}

/// The tree at zero joint positions, with what is needed to place its joints.
struct ZeroPose {
  std::vector<Transform> T_root_body;
  std::vector<Axis> axes;       // by joint
  std::vector<int> main_child;  // by body: the joint that continues the chain, or -1
};

ZeroPose MakeZeroPose(const RobotTree& tree) {
  ZeroPose zero;
  zero.T_root_body.assign(tree.body_count(), Transform::Identity());
  zero.main_child.assign(tree.body_count(), -1);
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const Joint& joint = tree.joints[k];
    const Transform T = zero.T_root_body[joint.parent_body] *
                        tree.links[joint.parent_link].T_body_link * joint.T_parent_child;
    zero.T_root_body[k + 1] = T;
    zero.axes.push_back({T.translation(), T.linear() * joint.axis});
    int& main_child = zero.main_child[joint.parent_body];
    if (joint.parent_body > 0 && main_child < 0) main_child = static_cast<int>(k);
  }
  return zero;
}

/// Constants of eq. 1 between two MDH frames, given the far end of the normal between their axes.
void MeasureConstants(const Transform& T_root_parent, const Transform& T_root_joint,
                      const Normal& normal, JointPlacement& placement) {
  const Eigen::Matrix3d R = T_root_parent.linear().transpose();
  const Vector3d x = R * normal.x;
  const Vector3d z = R * T_root_joint.linear().col(2);
  placement.beta = placement.parallel ? std::atan2(-x.z(), x.x()) : 0.0;
  placement.alpha = std::atan2(-z.y(), z.dot(RotY(placement.beta).linear().col(2)));
  placement.d = (normal.end - T_root_parent.translation()).dot(normal.x);
  const Vector3d x_joint = T_root_joint.linear().col(0);
  const Vector3d z_joint = T_root_joint.linear().col(2);
  placement.theta = std::atan2(normal.x.cross(x_joint).dot(z_joint), normal.x.dot(x_joint));
  placement.r = (T_root_joint.translation() - normal.end).dot(z_joint);
}

}  // namespace

std::vector<JointPlacement> PlaceJoints(const RobotTree& tree, const PlacementOptions& options) {
  const ZeroPose zero = MakeZeroPose(tree);
  std::vector<JointPlacement> placements(tree.joints.size());
  std::vector<Transform> T_root_mdh(tree.body_count(), Transform::Identity());
  std::vector<Normal> outgoing(tree.body_count());  // from each body's axis to its main child's

  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const int parent = tree.joints[k].parent_body;
    const Axis& axis = zero.axes[k];
    JointPlacement& placement = placements[k];
    const bool continues = zero.main_child[parent] == static_cast<int>(k);
    const bool parallel = continues && NeedsBeta(zero.axes[parent - 1], axis, options);
    placement.general =
        !continues || (parallel && (Slides(tree, parent) || Coaxial(outgoing[parent])));
    placement.parallel = parallel && !placement.general;

    // The normals by which the chain arrives on this axis and leaves it again.
    const Normal incoming = placement.general
                                ? Normal{axis.point, axis.point,
                                         AnyPerpendicular(axis.direction, zero.T_root_body[k + 1])}
                                : outgoing[parent];
    const int next = zero.main_child[k + 1];
    Normal& leaving = outgoing[k + 1];
    if (next < 0) {
      leaving = incoming;
      leaving.start = incoming.end;
    } else if (NeedsBeta(axis, zero.axes[next], options)) {
      leaving = PerpendicularFrom(incoming.end, zero.axes[next], incoming.x);
    } else {
      leaving = CommonNormal(axis, zero.axes[next]);
    }

    const Transform T_root_joint = Frame(leaving.start, axis.direction, leaving.x);
    T_root_mdh[k + 1] = T_root_joint;
    if (placement.general) {
      placement.alpha = 0.5 * M_PI;
      placement.T_parent_pre = T_root_mdh[parent].inverse() * T_root_joint * RotX(-0.5 * M_PI);
    } else {
      MeasureConstants(T_root_mdh[parent], T_root_joint, incoming, placement);
    }
    placement.T_joint_body = T_root_joint.inverse() * zero.T_root_body[k + 1];
  }
  return placements;
}

}  // namespace elastocal
