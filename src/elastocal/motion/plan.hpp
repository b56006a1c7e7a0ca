#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/motion/balance.hpp"
#include "elastocal/motion/joint_path.hpp"
#include "elastocal/motion/motion_check.hpp"

namespace elastocal {

/// Postures that are gone through while the same feet stand.
struct PostureTour {
  std::string name;
  std::vector<int> standing;  ///< feet, indices of soles: all of them, or one
  /// By coordinate, of the whole robot; joints of standing legs are found by balancing.
  std::vector<Eigen::VectorXd> postures;
  bool in_order = false;  ///< visited as given, by the posture of rest each time (repeatability)
  /// Coordinates that swing to and fro one after the other, all else at rest (section 6.1.4).
  std::vector<int> sines = {};
};

/// Sinusoidal motions: of a joint around the middle of its range, at most `share` of it, with a
/// period to swing in and one to come back. Smaller where speed, space or balance want it.
struct SineOptions {
  double frequency_hz = 0.5;
  double periods = 2.0;
  double share = 0.8;
  double least_share = 0.05;  ///< a joint that can do no more than this is left out
};

struct PlanOptions {
  JointPathOptions path;
  BalanceOptions balance;
  SineOptions sine;
  bool balanced =
      true;  ///< false: the root link stays where it is at rest, to see what comes of it
  double rate_hz = 100.0;
  double hold_s = 1.5;   ///< at rest in each posture
  double shift_s = 4.0;  ///< of the weight, from two feet to one
  double lift_s = 5.0;   ///< of a foot, and of the rest of the shift
  /// When a foot leaves or meets the floor, the zero-moment point is this much off the middle of
  /// the other, towards the one that moves, m: where legs are not quite as long as they are thought
  /// to be, the one that comes first pushes the robot away.
  double inset = 0.035;
  double lift_m = 0.10;  ///< how high it is lifted before the joints of its leg move by themselves
  double first_lift_m = 0.010;  ///< of it, before the rest of the weight is shifted
  int slower = 2;  ///< times that a move is tried half as slow again before it is given up
};

/// A posture at rest in a planned motion.
struct Visit {
  int posture = 0;         ///< of the set
  int begin = 0, end = 0;  ///< samples of the hold, end excluded
};

/// A posture (or sinusoidal motion) that is not part of the motion, and why.
struct LeftOut {
  int posture = 0;  ///< of the set; -1: a sine
  int sine = -1;    ///< coordinate of the sine
  Constraint constraint = Constraint::kReach;
  double value = 0.0;   ///< of what the constraint is about, see MotionMargins; NaN: out of reach
  int index = -1;       ///< of the joint, foot or pair
  bool at_rest = true;  ///< the posture itself breaks it; else every way there
};

/// Motion through a set of postures, from the posture of rest on all feet and back to it.
struct PlannedTour {
  std::string name;
  SampledMotion motion;
  int begin = 0, end = 0;  ///< samples between which only the set's feet stand, end excluded
  std::vector<Visit> visits;
  std::vector<LeftOut> left_out;
};

/// Plans the motion through one set (paper, section 3.6). The order is that of OrderPostures, ways
/// those of PlanJointPath, balanced by Balance; each is checked by CheckMotion and made slower, or
/// led by the posture of rest, where limits are broken. A posture that cannot be kept or reached is
/// left out. On one foot: first the weight is shifted, then the other foot is lifted straight up,
/// and at the end the same backwards, so that the foot stands where it stood.
PlannedTour PlanTour(const StandingRobot& robot, const PostureTour& set,
                     const PlanOptions& options);

/// Plans sets, several at a time, and joins them to one motion. The result does not depend on the
/// number of threads.
std::vector<PlannedTour> PlanTours(const StandingRobot& robot, const std::vector<PostureTour>& sets,
                                   const PlanOptions& options, int threads);

/// All motions one after the other, with a rest before the first.
SampledMotion JoinMotions(const StandingRobot& robot, const std::vector<PlannedTour>& sets,
                          double lead_in_s, double rate_hz);

}  // namespace elastocal
