// SPDX-License-Identifier: Apache-2.0
// Commands along a motion, each of which continues from the last one.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/runtime/compensator.hpp"
#include "tests/planar_chain.hpp"
#include "tests/runtime_fixture.hpp"

namespace elastocal {
namespace {

constexpr double kStep = 1e-3;  // rad, change of the planned knee from one sample to the next

/// Plans in which the knee goes from one angle to another.
std::vector<Eigen::VectorXd> Knees(double from, double to) {
  std::vector<Eigen::VectorXd> plans;
  const int count = static_cast<int>(std::lround(std::abs(to - from) / kStep));
  for (int i = 0; i <= count; ++i) {
    plans.emplace_back(Eigen::Vector3d(0.3, from + i * (to - from) / count, -0.2));
  }
  return plans;
}

struct Played {
  double largest_change = 0.0;     ///< of a joint's command between samples
  std::vector<double> residual_m;  ///< for each sample
  std::vector<double> residual_rad;
  unsigned status = 0;
};

Played Play(Compensator& robot, const std::vector<Eigen::VectorXd>& plans, bool forget) {
  Played played;
  Eigen::VectorXd last;
  for (const Eigen::VectorXd& plan : plans) {
    if (forget) robot.Forget();
    played.status |= robot.Command(plan, kNoTorque, 0);
    const Eigen::VectorXd command = robot.command();
    if (last.size() > 0) {
      played.largest_change =
          std::max(played.largest_change, (command - last).cwiseAbs().maxCoeff());
    }
    last = command;
    played.residual_m.push_back(robot.residual_m());
    played.residual_rad.push_back(robot.residual_rad());
  }
  return played;
}

double Largest(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

// The knee lags by 2 mrad. Commands of a motion there and back follow the plan without jumps, with
// errors of at most 2 mrad while the knee crosses its play.
TEST(RuntimeFollowing, CommandsTakeAJointThroughItsPlay) {
  constexpr double kLag = 2e-3;
  RuntimeModel model = PlanarLeg(0.0, -2.3, 2.3).Make().model();
  model.shifts.push_back({1, EC_HYSTERESIS, 1, -kLag, 0.0, 1.0});
  Compensator robot(model), real(model);
  std::vector<Eigen::VectorXd> plans = Knees(0.4, 0.6);
  const std::vector<Eigen::VectorXd> back = Knees(0.6, 0.4);
  plans.insert(plans.end(), back.begin(), back.end());
  const Played played = Play(robot, plans, false);
  EXPECT_EQ(played.status, 0u);
  EXPECT_LE(played.largest_change, 2.0 * kStep + 2e-4 + 1e-12);
  EXPECT_LT(Largest(played.residual_m), 1e-6);
  Compensator again(model), straight = PlanarLeg(0.0, -2.3, 2.3).Make();
  int off = 0;
  for (const Eigen::VectorXd& plan : plans) {
    again.Command(plan, kNoTorque, 0);
    real.Forward(again.command(), kNoTorque, 0);
    straight.Forward(plan, kNoTorque, 0);
    const double error =
        (real.link_pose(0).translation() - straight.link_pose(0).translation()).norm();
    EXPECT_LT(error, 1.01 * kLag * (kShank + kFoot));
    if (error > 1e-5) ++off;
  }
  EXPECT_GT(off, 0);
  EXPECT_LE(off,
            static_cast<int>(3.0 * kLag / kStep));  // half at first, all on the way back
}

// The leg is longer than nominal, so that its knee is bent by 0.2 rad where the plan's knee is
// straight. The plan then bends to the other side, where a bend to this side would be a correction
// of more than 0.25 rad. So the knee must come over.
TEST(RuntimeFollowing, AKneeThatComesOverDoesNotJump) {
  Compensator robot = PlanarLeg(4e-3, -2.3, 2.3).Make();
  const std::vector<Eigen::VectorXd> plans = Knees(0.3, -0.6);
  EXPECT_GT(Play(robot, plans, true).largest_change, 0.15);  // each call independent of the others
  robot.Forget();
  const Played played = Play(robot, plans, false);
  EXPECT_LE(played.largest_change, 2.0 * kStep + 2e-4 + 1e-12);
  EXPECT_EQ(played.status, unsigned{EC_CORRECTION_CUT});
  // The knee keeps its largest correction, which for the foot's 0.1 m is at most the sine of 0.25
  // rad.
  EXPECT_LT(Largest(played.residual_m), 15e-3);
  EXPECT_LT(played.residual_m.back(), 2e-5);
  EXPECT_LT(played.residual_rad.back(), 1e-4);
}

// The knee comes back, so that a bend to the same side is always a solution. The command hardly
// moves while the plan's knee passes the straight posture.
TEST(RuntimeFollowing, WhereASolutionGoesOnNothingIsLeft) {
  Compensator robot = PlanarLeg(4e-3, -2.3, 2.3).Make();
  std::vector<Eigen::VectorXd> plans = Knees(0.3, -0.03);
  const std::vector<Eigen::VectorXd> back = Knees(-0.03, 0.3);
  plans.insert(plans.end(), back.begin(), back.end());
  EXPECT_GT(Play(robot, plans, true).largest_change, 0.15);
  robot.Forget();
  const Played played = Play(robot, plans, false);
  EXPECT_LE(played.largest_change, 2.0 * kStep + 2e-4 + 1e-12);
  EXPECT_LT(Largest(played.residual_m), 2e-5);
  EXPECT_LT(Largest(played.residual_rad), 1e-4);
  EXPECT_EQ(played.status, 0U);
}

// A leg that is too short cannot reach the plan's nearly straight knee. Independent calls have the
// same residual.
TEST(RuntimeFollowing, WhatNoCommandReachesIsLeftAsBefore) {
  Compensator robot = PlanarLeg(-4e-3, -2.3, 2.3).Make();
  const std::vector<Eigen::VectorXd> plans = Knees(0.5, -0.5);
  const Played alone = Play(robot, plans, true);
  robot.Forget();
  const Played played = Play(robot, plans, false);
  EXPECT_LE(played.largest_change, 2.0 * kStep + 2e-4 + 1e-12);
  EXPECT_NEAR(Largest(played.residual_m), Largest(alone.residual_m), 2e-4);
  EXPECT_LT(played.residual_m.back(), 2e-5);
  for (std::size_t i = 0; i < plans.size(); ++i) {
    EXPECT_LT(played.residual_m[i], alone.residual_m[i] + 1e-3) << i;
  }
}

// The commands also follow targets that move while the nominal posture is constant.
TEST(RuntimeFollowing, TargetsThatMoveAreFollowed) {
  Compensator robot = PlanarLeg(4e-3, -2.3, 2.3).Make(), alone = PlanarLeg(4e-3, -2.3, 2.3).Make();
  PlanarChain leg = PlanarLeg(0.0, -2.3, 2.3);
  Compensator nominal = leg.Make();
  const Eigen::Vector3d middle(0.3, 0.8, -0.2);
  for (int i = 0; i <= 100; ++i) {
    const Eigen::Vector3d plan(0.3, 0.8 + 1e-3 * i, -0.2);
    nominal.Forward(plan, kNoTorque, 0);
    const Eigen::Isometry3d target = nominal.link_pose(0);
    robot.Command(&target, middle, kNoTorque, 0);
    EXPECT_LT(robot.residual_m(), 2e-5) << i;
  }
  // The command for a distant target does not depend on the last one.
  nominal.Forward(Eigen::Vector3d(0.3, 0.6, -0.2), kNoTorque, 0);
  const Eigen::Isometry3d target = nominal.link_pose(0);
  robot.Command(&target, middle, kNoTorque, 0);
  alone.Command(&target, middle, kNoTorque, 0);
  EXPECT_TRUE(robot.command() == alone.command());
}

// Speeds of joints are limited: a command changes no faster than that between calls, unless the
// plan does.
TEST(RuntimeFollowing, NoJointIsFasterThanItsLimit) {
  Compensator robot = PlanarLeg(-4e-3, -2.3, 2.3).Make();
  const std::vector<Eigen::VectorXd> plans = Knees(0.5, 0.2);
  const auto largest_changes = [&] {
    robot.Forget();
    Eigen::Vector3d largest = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < plans.size(); ++i) {
      const Eigen::Vector3d last = robot.command();
      robot.Command(plans[i], kNoTorque, 0);
      EXPECT_NEAR(robot.tip_left_m(0), std::hypot(robot.residual_m(), 0.3 * robot.residual_rad()),
                  1e-12);
      if (i > 0) largest = largest.cwiseMax((robot.command() - last).cwiseAbs());
    }
    return largest;
  };
  const Eigen::Vector3d free = largest_changes();
  EXPECT_GT(free[0], 0.5e-3);
  EXPECT_GT(free[1], 2.0 * kStep);
  robot.LimitChanges(Eigen::Vector3d(0.5e-3, 1.5 * kStep, -1.0));
  Eigen::Vector3d limited = largest_changes();
  EXPECT_LE(limited[0], 0.05e-3 + 1e-12);  // a tenth of the limit, as the plan stands still
  EXPECT_LE(limited[1], 1.15 * kStep + 1e-12);
  EXPECT_GT(limited[1], 1.05 * kStep);
  robot.LimitChanges(Eigen::Vector3d(-1.0, 1.05 * kStep, -1.0));
  EXPECT_LE(largest_changes()[1], 1.05 * kStep + 1e-12);
  robot.LimitChanges(Eigen::Vector3d::Constant(0.5 * kStep));
  limited = largest_changes();
  EXPECT_NEAR(limited[1], kStep, 1e-12);  // the plan's own change
  EXPECT_GT(robot.residual_m(), 1e-3);
  for (int i = 0; i < 3000; ++i) robot.Command(plans.back(), kNoTorque, 0);
  EXPECT_LT(robot.residual_m(), 1e-4);
  robot.LimitChanges(kNoTorque);  // removes the limits
  EXPECT_EQ(largest_changes(), free);
}

class RuntimeFollowingTalos : public Runtime {};

// For a moment, the arm is too short to reach the hand's place. A lean of the trunk to either side
// would help by a millimetre or two, but the change from one side to the other would cost eight.
TEST_F(RuntimeFollowingTalos, ANearlyStretchedArmKeepsItsSolution) {
  Compensator robot = Make();
  const std::vector<Eigen::VectorXd> plans = StretchOfElbow(100);
  Played played;
  for (const Eigen::VectorXd& plan : plans) {
    robot.Command(plan, kNoTorque, 1);
    played.residual_m.push_back(robot.residual_m());
  }
  EXPECT_LT(Largest(played.residual_m), 3e-3);
}

TEST_F(RuntimeFollowingTalos, CallsFarFromEachOtherStandByThemselves) {
  Compensator robot = Make();
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Eigen::VectorXd q = Posture(seed);
    const auto feet = static_cast<StandingFeet>(seed % 4);
    Compensator alone = Make();
    EXPECT_EQ(robot.Command(q, kNoTorque, feet), alone.Command(q, kNoTorque, feet));
    EXPECT_TRUE(robot.command() == alone.command()) << seed;  // the same bits
    EXPECT_EQ(robot.residual_m(), alone.residual_m());
    // Calls in between do not matter.
    robot.Forward(Posture(seed + 100), kNoTorque, 0);
    robot.Correct(Posture(seed + 200), kNoTorque, 0);
  }
}

TEST_F(RuntimeFollowingTalos, ForgetMakesACallStandByItself) {
  Compensator robot = Make();
  const Eigen::VectorXd from = Posture(1);
  const Eigen::VectorXd to = from.array() + 0.05;
  Compensator alone = Make();
  alone.Command(to, kNoTorque, 1);
  robot.Command(from, kNoTorque, 1);
  robot.Command(to, kNoTorque, 1);
  EXPECT_FALSE(robot.command() == alone.command());
  EXPECT_LT(robot.residual_m(), 2e-4);
  robot.Command(from, kNoTorque, 1);
  robot.Forget();
  robot.Command(to, kNoTorque, 1);
  EXPECT_TRUE(robot.command() == alone.command());
}

TEST_F(RuntimeFollowingTalos, ARobotThatShallStandStands) {
  Compensator robot = Make();
  const Eigen::VectorXd from = Posture(1);
  for (int i = 0; i < 10; ++i) robot.Command(from.array() + 0.01 * i, kNoTorque, 3);
  for (int i = 0; i < 5; ++i) robot.Command(from.array() + 0.1, kNoTorque, 3);  // it comes to rest
  const Eigen::VectorXd command = robot.command();
  const double left = robot.residual_m();
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(robot.Command(from.array() + 0.1, kNoTorque, 3), 0U);
    EXPECT_TRUE(robot.command() == command) << i;
    EXPECT_NEAR(robot.residual_m(), left, 2e-5);
  }
  // Newly given torques are corrected at once, and later ones by 0.2 mrad a call.
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(robot.robot().joints);
  EXPECT_EQ(robot.Command(from.array() + 0.1, zero, 3), 0U);
  EXPECT_LT(robot.residual_m(), 2e-4);
  const Eigen::VectorXd unloaded = robot.command();
  const Eigen::VectorXd torque = zero.array() + 20.0;
  robot.Command(from.array() + 0.1, torque, 3);
  EXPECT_LE((robot.command() - unloaded).cwiseAbs().maxCoeff(), 2e-4 + 1e-12);
  for (int i = 0; i < 300; ++i) robot.Command(from.array() + 0.1, torque, 3);
  EXPECT_GT((robot.command() - unloaded).cwiseAbs().maxCoeff(), 5e-4);
  EXPECT_LT(robot.residual_m(), 1e-4);
}

// Loads jump when a foot is lifted. The legs are corrected at once.
TEST_F(RuntimeFollowingTalos, AStepOfTheSupportIsCorrectedAtOnce) {
  Compensator robot = Make();
  const Eigen::VectorXd q = project_.motion.rest;
  for (StandingFeet feet : {3U, 1U, 3U, 2U, 0U}) {
    EXPECT_EQ(robot.Command(q, kNoTorque, feet), 0U);
    EXPECT_LT(robot.residual_m(), 5e-5) << feet;
  }
}

}  // namespace
}  // namespace elastocal
