// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/math/transform.hpp"

namespace elastocal {

/// Something beside the robot that is estimated along with it: the plane of a table, where a body
/// of a motion capture system sits on its link, how an inertial unit is mounted.
struct Quantity {
  std::string name;
  /// By number: the source of its deviation from nominal, which is zero.
  std::vector<int> sources;
  /// Whether it belongs to the surroundings, which another day may have changed (a table, the
  /// frame of a tracker), or to the robot (a mounting).
  bool of_surroundings = false;
  bool set_up_anew = false;  ///< for each file: the pose of a tracker, the anchor of a wire
  Transform origin = Transform::Identity();  ///< nominal, see QuantityValue

  int size() const { return static_cast<int>(sources.size()); }
};

/// Value of a quantity: numbers (m, rad, m/s^2 or relative) as displacements from an origin. What
/// they mean is up to the instruments; three charts are common.
struct QuantityValue {
  Transform origin = Transform::Identity();
  Eigen::VectorXd x;

  /// Chart of a pose (6 numbers): displacement along the axes of the parent [m], then rotation
  /// vector about them [rad].
  Transform Pose() const;
  /// Rotation of the parent's axes (3 x 3, rad/rad) by the rotation vector `x[first...]`.
  Eigen::Matrix3d Turns(int first = 3) const;
  /// Chart of a rotation alone (3 numbers from `first`).
  Eigen::Matrix3d Rotation(int first) const;

  /// Chart of a plane (3 numbers): moved up by x[0] [m] and tilted, its normal being
  /// R Rotx(x[1]) Roty(x[2]) e_z [rad] with R the rotation of the origin.
  Eigen::Vector3d Normal() const;
  /// Axes about which the normal turns by x[1] and x[2].
  Eigen::Matrix<double, 3, 2> NormalTurns() const;
  /// Signed distance of a point to the plane along its normal, m.
  double HeightOver(const Eigen::Vector3d& p) const;
  /// Its derivatives by the three numbers.
  Eigen::RowVector3d HeightByPlane(const Eigen::Vector3d& p) const;
};

}  // namespace elastocal
