// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>

#include "elastocal/drafting/limbs.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// Expected displacement of a link's origin against the root link by errors of this robot: standard
/// deviation in one direction (root mean square over the three), m, if the errors of geometry and
/// the deflections of joints under gravity are as the prior of a calibration has them by default.
/// `fixed_link` stands still: a foot, or the root link (0). Corrections of commands undo such
/// displacements.
double ExpectedDisplacement(const RobotTree& tree, int link, const Eigen::VectorXd& q,
                            int fixed_link = 0);

/// Standard deviations of what brings the end of a limb back to where it belongs, by the same
/// errors.
struct ExpectedCorrection {
  /// By entry of q that moves the limb against the root link: its change, rad or m.
  std::map<int, double> joints;
  /// Displacement of the limb's links that then remains, in one direction, m: of that which is
  /// displaced most.
  double displacement = 0.0;
};

/// What is to be expected of a limb, whose end gets its place and attitude, in posture `q`. Where
/// there are too few joints, they do what they can, with 0.3 m for a radian.
ExpectedCorrection ExpectCorrection(const RobotTree& tree, const Limb& limb,
                                    const Eigen::VectorXd& q);

/// Medians of ExpectCorrection over random postures of the limb within `lower` and `upper` (by
/// entry of q), with everything else as in `q`: singular postures do not count.
ExpectedCorrection TypicalCorrection(const RobotTree& tree, const Limb& limb,
                                     const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                     const Eigen::VectorXd& q);

/// Standard deviations for which motions keep room, so that of `count` corrections none exceeds it
/// in 95 % of robots: 2.2 for four limbs, 2.9 for thirty joints.
double RoomSds(std::size_t count);

/// The limbs whose corrections count: those with four or more joints of their own, and no heads.
std::vector<const Limb*> CorrectedLimbs(const RobotTree& tree, const Limbs& limbs);

/// A joint that bends a limb between its two long parts: an elbow or a knee. Its limb is longest at
/// the position `straight`.
struct Hinge {
  int joint = -1;
  double straight = 0.0;  ///< entry of q, rad
  /// Distances of the joint's axis from where the joints before it meet (shoulder, hip), and those
  /// after it (wrist, ankle; the tip, if there are none), m.
  double upper = 0.0, lower = 0.0;
};

/// The hinge of a limb, in posture `q`; `joint` is -1 if the limb has none.
Hinge FindHinge(const RobotTree& tree, const Limb& limb, const Eigen::VectorXd& q);

/// How far a hinge has to be bent so that its limb can become longer by `length`, rad. Near the
/// straight limb the length changes with the square of the angle.
double BendForLength(const Hinge& hinge, double length);

/// The part of a hinge's range in which its limb is bent.
struct BentRange {
  int coordinate = 0;
  bool leg = false;
  Eigen::Vector2d range = Eigen::Vector2d::Zero();  ///< rad
};

/// Ranges of elbows and knees of CorrectedLimbs in which their limbs are bent far enough for the
/// corrections that are to be expected (RoomSds of as many) in posture `q`. At least half of a
/// joint's range is kept. Joints that need no narrower range have no entry, nor have those that
/// bend their limb either way, a quarter of their range or more.
std::vector<BentRange> BentRanges(const RobotTree& tree, const Limbs& limbs,
                                  const Eigen::VectorXd& q);

}  // namespace elastocal
