#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/motion/standing_robot.hpp"

namespace elastocal {

struct JointPathOptions {
  double duration_s = 5.0;  ///< longer where joints would be faster than their limits
  int way_points = 5;
  double clearance = 0.015;  ///< least distance between parts on the way, m; ends may be nearer
  double check_step = 0.02;  ///< of the path's length, between places that are looked at
  int iterations = 60;       ///< of the search for a way around
};

/// A way from one posture to another, at rest at both ends.
struct JointPath {
  Eigen::MatrixXd control;  ///< control points of quintic B-splines x coordinates
  double duration_s = 0.0;
  double clearance = 0.0;  ///< least distance met on the way, m; infinite without parts
};

/// Plans a way by quintic B-splines whose way points are optimised (section 3.6): least integral of
/// squared velocity, for which the way points have a closed form; where parts come nearer to each
/// other than the clearance, way points of `moving` coordinates are pushed away along the gradient
/// of the squared lack of distance, in the metric of velocity, so that ways stay smooth, and inside
/// the joints' ranges, where the convex hull of the control points keeps the whole way. All other
/// coordinates follow the straight way. Looked at between the knots too.
///
/// The clearance found says whether that was enough; a way that is not free is no failure.
/// `clearances`: what is to be kept apart, perhaps more than the robot's own parts; may be empty.
JointPath PlanJointPath(const StandingRobot& robot, const Clearances& clearances,
                        const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                        const std::vector<int>& moving, const JointPathOptions& options);

/// samples x coordinates at a rate, from the path's begin to its end.
Eigen::MatrixXd SamplePath(const JointPath& path, double rate_hz);

}  // namespace elastocal
