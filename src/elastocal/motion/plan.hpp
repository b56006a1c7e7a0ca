// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/math/progress.hpp"
#include "elastocal/motion/balance.hpp"
#include "elastocal/motion/joint_path.hpp"
#include "elastocal/motion/motion_check.hpp"

namespace elastocal {

/// Postures that a robot goes through while the same feet stand.
struct PostureTour {
  std::string name;
  std::vector<int> standing;  ///< feet, indices of soles: all of them, or all but one
  /// Postures of the whole robot, by coordinate. Balancing finds the joints of standing legs.
  std::vector<Eigen::VectorXd> postures;
  bool in_order =
      false;  ///< visited in the given order, each time from the posture of rest (repeatability)
  /// Coordinates that oscillate one after the other while all else is at rest (section 6.1.4).
  std::vector<int> sines = {};
  /// Whether the postures are held as they are given, including the legs. The first foot that
  /// stands then gives the pose of the root link.
  bool legs_given = false;
  /// For each posture, the only way to it, samples x coordinates at the rate of the options. The
  /// robot goes this way forth and back, while the root link stays where it is in the posture. A
  /// posture with an empty way is left out. No entries: ways are planned.
  std::vector<Eigen::MatrixXd> approaches = {};
};

/// Sinusoidal motions of a joint around the middle of its range. The amplitude is at most `share`
/// of the range, and smaller if speed, clearance or balance require it. One more period is used to
/// swing in and one to come back.
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
  bool balanced = true;  ///< false: the root link stays where it is at rest; only for comparison
  double rate_hz = 100.0;
  double hold_s = 1.5;   ///< time at rest in each posture
  double shift_s = 4.0;  ///< time to shift the weight off a foot
  double lift_s = 5.0;   ///< time to lift a foot and shift the rest of the weight
  /// When a foot leaves or meets the floor, the zero-moment point is this far from the middle of
  /// the other foot (if it is one alone), towards the one that moves, m. If legs are longer than
  /// the model says, the foot that touches the floor first pushes the robot away from it. 0: 0.54
  /// of half the width of the sole.
  double inset = 0.0;
  /// Height to which a foot is lifted before its leg moves freely, m. A tenth of it is lifted
  /// before the rest of the weight is shifted. 0: 0.123 of the leg's length.
  double lift_m = 0.0;
  int slower = 2;  ///< how often a move is tried again, 1.5 times slower, before it is given up
};

/// A posture at rest in a planned motion.
struct Visit {
  int posture = 0;         ///< index of the posture in the set
  int begin = 0, end = 0;  ///< samples of the hold, without `end`
};

/// A posture (or sinusoidal motion) that is not part of the motion, and why.
struct LeftOut {
  int posture = 0;  ///< index of the posture in the set; -1: a sine
  int sine = -1;    ///< coordinate of the sine
  Constraint constraint = Constraint::kReach;
  double value = 0.0;   ///< value that breaks the constraint, see MotionMargins; NaN: out of reach
  int index = -1;       ///< index of the joint, foot or pair of parts
  bool at_rest = true;  ///< whether the posture itself breaks it; otherwise every way there does
};

/// Motion from the posture of rest on all feet through a set of postures and back to it.
struct PlannedTour {
  std::string name;
  SampledMotion motion;
  int begin = 0, end = 0;  ///< samples between which only the set's feet stand, without `end`
  std::vector<Visit> visits;
  std::vector<LeftOut> left_out;
};

/// Plans the motion through one set (paper, section 3.6). OrderPostures gives the order,
/// PlanJointPath the ways, and Balance balances them. CheckMotion checks each way; if it breaks
/// limits, it is made slower or led by the posture of rest. A posture that cannot be held or
/// reached is left out. For a set on all feet but one, the weight is first shifted and that foot
/// lifted straight up, flat or, where its ankle does not bend so far, tilted; at the end the same
/// is done backwards, so that the foot lands where it stood.
PlannedTour PlanTour(const StandingRobot& robot, const PostureTour& set,
                     const PlanOptions& options);

/// Plans several sets, on several threads. The result does not depend on the number of threads.
/// Progress counts sets.
std::vector<PlannedTour> PlanTours(const StandingRobot& robot, const std::vector<PostureTour>& sets,
                                   const PlanOptions& options, int threads,
                                   const Progress& progress = {});

/// All motions one after the other, with a rest before the first.
SampledMotion JoinMotions(const StandingRobot& robot, const std::vector<PlannedTour>& sets,
                          double lead_in_s, double rate_hz);

}  // namespace elastocal
