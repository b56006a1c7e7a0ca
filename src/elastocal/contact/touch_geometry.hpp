#pragma once

#include <Eigen/Core>

#include "elastocal/math/transform.hpp"

namespace elastocal {

using Matrix3x6d = Eigen::Matrix<double, 3, 6>;

/// A plane of the floor's frame, as a displacement from the level plane through `pivot`: moved up
/// by `height` [m] and tilted, its normal being Rotx(tilt_x) Roty(tilt_y) e_z [rad].
struct TablePlane {
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();  ///< in the floor's frame, m
  Eigen::Vector3d height_tilts = Eigen::Vector3d::Zero();

  Eigen::Vector3d Normal() const;
};

/// A flat plate that touches a table, in the frame of the link that carries it: a point of its
/// face, and axes whose z is the normal of the face, out of the table that it lies on.
struct PlateFace {
  Eigen::Vector3d p_link_face = Eigen::Vector3d::Zero();  ///< m
  Eigen::Matrix3d R_link_face = Eigen::Matrix3d::Identity();
};

/// What is left of a touch: height of the plate's point above the table, along its normal [m], and
/// the angles of the plate against the table about its own x and y [rad]. Zero for a plate that
/// lies flush.
struct TouchResidual {
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();
  Eigen::Matrix3d by_table;  ///< by height, tilt_x, tilt_y
  Matrix3x6d by_root;  ///< by rotation [rad] and displacement of the root's origin on the floor
  Matrix3x6d by_link;  ///< by a screw [a; m] of the link in the root's frame
  Eigen::Matrix<double, 3, 2> by_plate;  ///< by errors of the face's tilt about its x and y
};

/// `tilts`: errors of the face about its own x, then y [rad].
TouchResidual EvaluateTouch(const PlateFace& plate, const Eigen::Vector2d& tilts,
                            const TablePlane& table, const Transform& T_floor_root,
                            const Transform& T_root_link);

}  // namespace elastocal
