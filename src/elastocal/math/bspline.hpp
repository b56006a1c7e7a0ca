// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace elastocal {

/// Values at `place` of the clamped uniform B-splines of degree five (quintic) on [0, 1], or of
/// their derivatives by the place: `derivative` = 0, 1 or 2. The vector has one entry for each
/// control point, of which there are at least six. A place outside [0, 1] is moved to the nearest
/// end.
///
/// The first spline is 1 at place 0 and the last one at place 1, so that a curve begins at its
/// first control point and ends at its last. All splines sum to 1, so that a curve stays within the
/// range of its control points.
Eigen::VectorXd QuinticSplineBasis(int control_points, double place, int derivative = 0);

/// One row of QuinticSplineBasis for each of `samples` places (at least 2), equally spaced from 0
/// to 1.
Eigen::MatrixXd QuinticSplineBasisRows(int control_points, int samples, int derivative = 0);

/// Control points, (6 + way points) x coordinates, of a curve that begins at `from` and ends at
/// `to` with speed and acceleration exactly zero: three equal control points at either end, the
/// rows of `way_points` between them.
Eigen::MatrixXd RestToRestSpline(const Eigen::VectorXd& from, const Eigen::MatrixXd& way_points,
                                 const Eigen::VectorXd& to);

}  // namespace elastocal
