#pragma once

#include <Eigen/Core>

namespace elastocal {

/// Values of the clamped uniform B-splines of degree five (quintic) at a place in [0, 1], or of
/// their derivatives by that place: `derivative` = 0, 1 or 2. One a control point, of which there
/// are at least six; outside [0, 1] the place is moved to the nearest end.
///
/// The first and last spline are 1 at their ends, where a curve takes the value of the first and
/// last control point. All sum to 1, so that a curve stays within the range of its control points.
Eigen::VectorXd QuinticSplineBasis(int control_points, double place, int derivative = 0);

/// Rows: as QuinticSplineBasis, at `samples` places equally spaced from 0 to 1 (at least 2).
Eigen::MatrixXd QuinticSplineBasisRows(int control_points, int samples, int derivative = 0);

/// Control points, (6 + way points) x coordinates, of a curve that begins at `from` and ends at
/// `to` with speed and acceleration exactly zero: three equal control points at either end, the
/// rows of `way_points` between them.
Eigen::MatrixXd RestToRestSpline(const Eigen::VectorXd& from, const Eigen::MatrixXd& way_points,
                                 const Eigen::VectorXd& to);

}  // namespace elastocal
