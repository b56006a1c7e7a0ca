#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/simulation/postures.hpp"

namespace elastocal {

/// A piece of a motion: from one posture to another, at rest at both ends; one joint to and fro
/// around a posture; or along given samples.
struct MotionSegment {
  double duration_s = 0.0;
  Eigen::VectorXd from, to;  ///< by coordinate; of a sine both the posture around which it moves
  int coordinate = -1;       ///< of a sine: what moves; -1: a quintic polynomial between postures
  double centre = 0.0, amplitude = 0.0, frequency_hz = 0.0;  ///< of a sine, rad or m
  /// Of samples: when, from the segment's beginning, and where, samples x coordinates; a cubic runs
  /// through them (Catmull-Rom's). Empty for all others.
  Eigen::VectorXd sample_s = {};
  Eigen::MatrixXd samples = {};

  bool IsRest() const { return coordinate < 0 && sample_s.size() == 0 && from == to; }
};

/// A joint trajectory: what the robot is commanded.
struct Motion {
  std::vector<MotionSegment> segments;

  double duration_s() const;
};

/// The commanded posture at a time from the motion's beginning; held before and after.
Eigen::VectorXd PostureAt(const Motion& motion, double time_s);

struct MotionOptions {
  std::uint64_t seed = 1;
  PostureOptions postures;
  double lead_in_s =
      5.0;  ///< at rest before the first motion (cameras start before the robot's log)
  double move_s = 3.5, rest_s = 1.5;  ///< of a posture: 5 s apart, as in the paper
  int head_postures = 8;  ///< of chains with less than PostureOptions::arm_joints joints
  int arm_postures = 32;  ///< of other chains that are no leg
  int leg_postures = 24;  ///< of each leg while another carries
  /// While a leg swings, head, arms and trunk move too, this share of the way to their own random
  /// postures: it loads the leg that carries differently each time.
  double counterweight = 1.0;
  int random_postures = 20;  ///< of each validation trial
  int repetitions = 5;
  double sine_hz = 0.5;
  double sine_periods = 2.0;  ///< of each joint; one more to begin and one to end
  double sine_share = 0.8;    ///< of a joint's range that a sine spans, where speed and space allow
  double speed_share = 0.8;   ///< of a joint's largest speed that a sine may reach
};

/// A trial to be played.
struct PlannedTrial {
  std::string name;
  TrialKind kind = TrialKind::kCalibration;
  std::vector<int> chains;   ///< of those given
  std::vector<int> support;  ///< feet on the floor: links
  Motion motion;
  int postures = 0;  ///< in which it rests
};

/// The trials of the paper's sections 5 and 6 for any robot: calibration postures of each chain
/// from the waist (of a leg while another carries; without a second leg, none), and for validation,
/// of head, arms and trunk together and of each leg, a sinusoidal motion of one joint after the
/// other, random postures, and five repetitions of one motion. Chains that begin beyond the waist
/// are exercised with those that hold them and have no trial of their own. What no leg carries
/// moves while the robot stands on all feet.
std::vector<PlannedTrial> PlanTrials(const RobotTree& tree, const std::vector<NamedChain>& chains,
                                     const MotionOptions& options);

}  // namespace elastocal
