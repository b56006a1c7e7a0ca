// SPDX-License-Identifier: Apache-2.0
// How far commands of the run-time library change from one call to the next.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/runtime/compensator.hpp"
#include "tests/elastic_arm.hpp"

namespace elastocal {
namespace {

using Joints = Eigen::Matrix<double, 6, 1>;

const Eigen::VectorXd kStatics;
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kMost = 2e-3;  // rad a call

/// The shorter way round.
double Round(double angle) { return std::remainder(angle, 2.0 * M_PI); }

/// Compares commands with those of the call before. A joint may go as far as its limit, or as its
/// own plan went.
class ChangeWatch {
 public:
  void Look(const Eigen::VectorXd& plan, const Eigen::VectorXd& command) {
    for (Eigen::Index c = 0; c < plan.size() && last_plan_.size() > 0; ++c) {
      const double planned = std::abs(Round(plan[c] - last_plan_[c]));
      const double moved = std::abs(Round(command[c] - last_command_[c]));
      over_ = std::max(over_, moved - std::max(kMost, planned));
      const double way = Round(command[c] - last_command_[c]), to = Round(plan[c] - last_plan_[c]);
      beside_ = std::max({beside_, way - std::max(to, 0.0), std::min(to, 0.0) - way});
      most_[c] = std::max(most_[c], moved);
    }
    last_plan_ = plan;
    last_command_ = command;
  }

  double over() const { return over_; }
  /// How far a joint left the way from where it was to where its plan goes from there.
  double beside() const { return beside_; }
  const Joints& most() const { return most_; }

 private:
  Eigen::VectorXd last_plan_, last_command_;
  double over_ = 0.0, beside_ = 0.0;
  Joints most_ = Joints::Zero();
};

/// The arm of ElasticArm, whose last joint counts turns and is displaced.
RuntimeModel EndlessArm(double compliance, const ec_shift& shift) {
  RuntimeModel model = ElasticArm(compliance);
  model.lower[5] = -kInfinite;
  model.upper[5] = kInfinite;
  model.shifts.push_back(shift);
  return model;
}

// Where torques begin or end, the loads jump. Without the limit, commands of these robots jump by
// up to 0.2 rad.
TEST(RuntimeChanges, LimitsHoldWhereLoadsComeFromElsewhere) {
  for (const double calls : {0.0, 30.0}) {
    Random random(1);
    double free_most = 0.0;
    for (int run = 0; run < 60; ++run) {
      const RuntimeModel model = ElasticArm(std::pow(10.0, random.Uniform(-5.0, -3.0)));
      Compensator robot(model), free(model);
      EXPECT_TRUE(robot.LimitChanges(Joints::Constant(kMost)));
      robot.EaseChanges(calls);
      Joints plan, speed;
      for (double& value : plan) value = random.Uniform(-2.5, 2.5);
      for (double& value : speed) value = random.Uniform(-kMost, kMost);
      const Joints torque = Joints::Constant(random.Uniform(-20.0, 20.0));
      ChangeWatch watch, free_watch;
      for (int i = 0; i < 300; ++i) {
        plan += speed;
        for (Eigen::Index c = 0; c < 6; ++c) {
          if (std::abs(plan[c]) > 3.0) speed[c] = -speed[c];
        }
        const bool given = i / 50 % 2 != 0;
        robot.Command(plan, given ? Eigen::VectorXd(torque) : kStatics, 0);
        free.Command(plan, given ? Eigen::VectorXd(torque) : kStatics, 0);
        watch.Look(plan, robot.command());
        free_watch.Look(plan, free.command());
      }
      EXPECT_LE(watch.over(), 1e-12) << run << ", " << calls;
      EXPECT_LE(watch.beside(), 0.1 * kMost + 1e-12) << run << ", " << calls;
      free_most = std::max(free_most, free_watch.over());
    }
    EXPECT_GT(free_most, 0.05);
  }
}

// The plan of one joint jumps, by more than the reach of a motion. This joint may jump as far, but
// no other may.
TEST(RuntimeChanges, LimitsAreThoseOfEachJoint) {
  for (const double jump : {0.11, 1.0, -2.0}) {
    for (const double calls : {0.0, 30.0}) {
      Compensator robot(ElasticArm(5e-4)), free(ElasticArm(5e-4));
      robot.LimitChanges(Joints::Constant(kMost));
      robot.EaseChanges(calls);
      Joints plan = (Joints() << 0.2, 0.5, -0.6, 0.4, 0.5, 0.1).finished();
      ChangeWatch watch, free_watch;
      for (int i = 0; i < 200; ++i) {
        if (i == 20) plan[3] += jump;
        robot.Command(plan, kStatics, 0);
        free.Command(plan, kStatics, 0);
        watch.Look(plan, robot.command());
        free_watch.Look(plan, free.command());
      }
      EXPECT_LE(watch.over(), 1e-12) << jump;
      EXPECT_LE(watch.most()[3], std::abs(jump) + 1e-12);
      if (std::abs(jump) > 0.5) {
        EXPECT_GT(free_watch.over(), 2.0 * kMost) << jump;
      }
      // In the end the hand is where a call by itself has it. Some millimetres may be left there.
      for (int i = 0; i < 2000; ++i) robot.Command(plan, kStatics, 0);
      free.Forget();
      free.Command(plan, kStatics, 0);
      EXPECT_LT(robot.residual_m(), free.residual_m() + 2e-4) << jump;
    }
  }
}

// With an error of its gear, the robot is not the same a turn further on: the commands beside such
// a step are those of a motion that begins there.
TEST(RuntimeChanges, AWholeTurnIsAMotionWhereAGearIsWrong) {
  const RuntimeModel model = EndlessArm(3e-4, {5, EC_GEAR, 5, 5e-3, 0.0, 1.0});
  Compensator robot(model), begun(model);
  Joints plan = (Joints() << 0.2, 0.6, -1.0, 0.2, 0.3, 3.1).finished();
  robot.Command(plan, kStatics, 0);
  plan[5] = -3.1;
  robot.Command(plan, kStatics, 0);
  begun.Command(plan, kStatics, 0);
  EXPECT_LT((robot.command() - begun.command()).cwiseAbs().maxCoeff(), 1e-9);
}

// An endless joint goes from half a turn to minus half a turn, which is no motion. All commands are
// as those of a plan that counts turns, and the joint stays on its side of the play.
TEST(RuntimeChanges, AWholeTurnIsNoMotion) {
  RuntimeModel model = EndlessArm(3e-4, {5, EC_HYSTERESIS, 5, 2e-3, 0.0, 1.0});
  Compensator robot(model), counted(model);
  for (Compensator* one : {&robot, &counted}) one->LimitChanges(Joints::Constant(kMost));
  Joints plan = (Joints() << 0.2, 0.6, -1.0, 0.2, 0.3, 2.9).finished();
  ChangeWatch watch;
  for (int i = 0; i < 900; ++i) {
    // Nearly stretched, so that the command depends on those before it.
    plan[2] = -1.0 + 1.9e-3 * std::min(i, 520);
    plan[5] = 2.9 + 8e-4 * i;
    Joints wrapped = plan;
    wrapped[5] = Round(plan[5]);
    robot.Command(wrapped, kStatics, 0);
    counted.Command(plan, kStatics, 0);
    watch.Look(wrapped, robot.command());
    EXPECT_LT((robot.command() - wrapped - (counted.command() - plan)).cwiseAbs().maxCoeff(), 1e-9)
        << i;
    robot.Forward(wrapped, kStatics, 0);
    counted.Forward(plan, kStatics, 0);
    EXPECT_TRUE(robot.link_pose(0).isApprox(counted.link_pose(0), 1e-12)) << i;
  }
  EXPECT_LE(watch.over(), 1e-12);
  // A joint that has a limit comes to the same place only by turning back.
  model.lower[5] = -4.0;
  Compensator limited(model);
  limited.LimitChanges(Joints::Constant(kMost));
  plan[5] = 3.14;
  limited.Command(plan, kStatics, 0);
  const double before = limited.command()[5];
  plan[5] = -3.14;
  limited.Command(plan, kStatics, 0);
  EXPECT_LT(limited.command()[5] - before, -6.0);
}

// A robot stands uncorrected at its plan, and the controller begins.
TEST(RuntimeChanges, AStartGoesOnFromThePresentCommand) {
  const Joints plan = (Joints() << 0.2, 0.5, -0.6, 0.4, 0.5, 0.1).finished();
  Compensator robot(ElasticArm(1e-4));
  robot.LimitChanges(Joints::Constant(kMost));
  robot.Command(plan, kStatics, 0);
  const Joints whole = robot.command() - plan;
  EXPECT_GT(whole.cwiseAbs().maxCoeff(), 50.0 * kMost);  // what the first call does otherwise
  for (const double calls : {0.0, 30.0}) {
    robot.EaseChanges(calls);
    // From the plan itself, from a posture nearby, from one that is out of reach of corrections,
    // and after any motion.
    for (const double away : {0.0, 0.05, 0.5}) {
      const Joints from = plan.array() + away;
      EXPECT_TRUE(robot.StartFrom(from));
      // Nothing is known of the plan, so that the robot stays.
      EXPECT_EQ(robot.Command(Joints::Constant(std::nan("")), kStatics, 0),
                unsigned{EC_BAD_POSITION} | EC_NOTHING_YET);
      EXPECT_TRUE(robot.command() == from);
      Eigen::VectorXd last = from;
      for (int i = 0; i < 4000; ++i) {
        robot.Command(plan, kStatics, 0);
        EXPECT_LE((robot.command() - last).cwiseAbs().maxCoeff(), kMost + 1e-12) << i;
        last = robot.command();
      }
      EXPECT_LT(robot.residual_m(), 1e-4) << away;
      robot.Forget();
    }
  }
  // A start that is none changes nothing.
  robot.StartFrom(plan);
  Joints bad = plan;
  bad[2] = std::nan("");
  EXPECT_FALSE(robot.StartFrom(bad));
  EXPECT_FALSE(robot.StartFrom(plan.head(3)));
  robot.Command(plan, kStatics, 0);
  EXPECT_LE((robot.command() - plan).cwiseAbs().maxCoeff(), kMost + 1e-12);
  // An endless joint may begin a turn away.
  RuntimeModel model = ElasticArm(1e-4);
  model.lower[5] = -kInfinite;
  model.upper[5] = kInfinite;
  Compensator endless(model);
  endless.LimitChanges(Joints::Constant(kMost));
  Joints turned = plan;
  turned[5] += 4.0 * M_PI;
  endless.StartFrom(turned);
  endless.Command(plan, kStatics, 0);
  EXPECT_LE((endless.command() - plan).cwiseAbs().maxCoeff(), kMost + 1e-12);
}

// Limits of a wrong size leave those that hold.
TEST(RuntimeChanges, LimitsOfAWrongSizeChangeNothing) {
  const Joints plan = (Joints() << 0.2, 0.5, -0.6, 0.4, 0.5, 0.1).finished();
  Compensator robot(ElasticArm(1e-4));
  const auto change = [&] {
    robot.Forget();
    robot.Command(plan, kStatics, 0);
    const Eigen::VectorXd before = robot.command();
    robot.Command(plan, Joints::Constant(60.0), 0);
    return (robot.command() - before).cwiseAbs().maxCoeff();
  };
  EXPECT_TRUE(robot.LimitChanges(Joints::Constant(kMost)));
  EXPECT_LE(change(), kMost + 1e-12);
  EXPECT_FALSE(robot.LimitChanges(Eigen::VectorXd::Constant(7, 1.0)));
  EXPECT_LE(change(), kMost + 1e-12);
  EXPECT_TRUE(robot.LimitChanges(kStatics));  // removes them
  EXPECT_GT(change(), 2.0 * kMost);
}

}  // namespace
}  // namespace elastocal
