// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/motion/standing_robot.hpp"

namespace elastocal {

struct JointPathOptions {
  double duration_s = 5.0;  ///< longer on a detour, or if joints would be faster than their limits
  int way_points = 5;
  double clearance = 0.015;  ///< least distance between parts on the way, m; ends may be nearer
  double check_step =
      0.02;             ///< distance between the places that are checked, as a share of the way
  int iterations = 60;  ///< most steps of the search for a way around parts
};

/// A way from one posture to another, at rest at both ends.
struct JointPath {
  Eigen::MatrixXd control;  ///< control points of quintic B-splines x coordinates
  double duration_s = 0.0;
  double clearance = 0.0;  ///< least distance between parts on the way, m; infinite without parts
};

/// Plans a way by quintic B-splines whose way points are optimised (section 3.6):
/// 1. The way points with the least integral of squared velocity follow in closed form.
/// 2. If parts come nearer to each other than the clearance, way points of `moving` coordinates are
///    pushed along the gradient of the squared lack of distance, in the metric of velocity, so that
///    the way stays smooth. They stay inside the joints' ranges, and so does the whole way, because
///    it lies in the convex hull of the control points. All other coordinates follow the straight
///    way.
/// 3. If parts are still too near, the way points are put on a detour (ConnectByTrees) of those
///    `moving` coordinates that differ at the ends, and pushed again. A detour takes `duration_s`
///    for each of its sides.
/// Clearance is checked between the knots too.
///
/// A way that is not free is not an error: JointPath::clearance says how near parts come.
/// `clearances` gives the distances to keep, which may include more than the robot's own parts; it
/// may be empty.
JointPath PlanJointPath(const StandingRobot& robot, const Clearances& clearances,
                        const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                        const std::vector<int>& moving, const JointPathOptions& options);

/// Samples of the path at a rate, from its beginning to its end, samples x coordinates.
Eigen::MatrixXd SamplePath(const JointPath& path, double rate_hz);

}  // namespace elastocal
