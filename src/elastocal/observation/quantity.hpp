// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/math/transform.hpp"

namespace elastocal {

/// Something beside the robot that is estimated with it: the plane of a table, the place of a
/// motion-capture body on its link, the mounting of an inertial unit.
struct Quantity {
  std::string name;
  /// By number: the source of its deviation from nominal, which is zero.
  std::vector<int> sources;
  /// It belongs to the surroundings, which may be different on another day (a table, the frame of a
  /// tracker). If false, it belongs to the robot (a mounting).
  bool of_surroundings = false;
  /// Set up anew for each file: the pose of a tracker, the anchor of a wire.
  bool set_up_anew = false;
  Transform origin = Transform::Identity();  ///< nominal, see QuantityValue

  int size() const { return static_cast<int>(sources.size()); }
};

/// Value of a quantity: numbers (m, rad, m/s^2 or relative) as displacements from an origin. The
/// instruments define their meaning; three charts are common.
struct QuantityValue {
  Transform origin = Transform::Identity();
  Eigen::VectorXd x;

  /// Chart of a pose (6 numbers): displacement along the axes of the parent [m], then rotation
  /// vector about them [rad].
  Transform Pose() const;
  /// Derivative (3 x 3, rad/rad) of the rotation about the parent's axes by the rotation vector
  /// `x[first...]`.
  Eigen::Matrix3d Turns(int first = 3) const;
  /// Chart of a rotation (3 numbers from `first`).
  Eigen::Matrix3d Rotation(int first) const;

  /// Chart of a plane (3 numbers): normal of the plane after it is moved up by x[0] [m] and tilted.
  /// The normal is R Rotx(x[1]) Roty(x[2]) e_z [rad], with R the rotation of the origin.
  Eigen::Vector3d Normal() const;
  /// Axes about which x[1] and x[2] turn the normal.
  Eigen::Matrix<double, 3, 2> NormalTurns() const;
  /// Signed distance of a point to the plane along its normal, m.
  double HeightOver(const Eigen::Vector3d& p) const;
  /// Derivatives of the distance by the three numbers.
  Eigen::RowVector3d HeightByPlane(const Eigen::Vector3d& p) const;
};

}  // namespace elastocal
