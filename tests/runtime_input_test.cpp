// SPDX-License-Identifier: Apache-2.0
// What the functions of the run-time library remember of their input.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "elastocal/runtime/compensator.hpp"
#include "tests/elastic_arm.hpp"

namespace elastocal {
namespace {

using Six = Eigen::Matrix<double, 6, 1>;

const Eigen::VectorXd kNone;
const double kNan = std::numeric_limits<double>::quiet_NaN();
const Six kPlan = (Six() << 0.2, 0.5, -0.6, 0.4, 0.5, 0.1).finished();

// A controller calls Correct for measured positions and Command for its plan. The planner fails.
// The measured positions hold the correction, so that a command made from them would add another
// one in each call.
TEST(RuntimeInput, WhatIsMeasuredIsNoPlan) {
  Compensator robot(ElasticArm());
  Eigen::VectorXd measured = kPlan, good;
  for (int i = 0; i < 100; ++i) {
    robot.Correct(measured, kNone, 0);
    robot.Forward(measured, kNone, 0);
    const bool fails = i >= 5;
    const unsigned status = robot.Command(fails ? Six::Constant(kNan) : kPlan, kNone, 0);
    EXPECT_EQ(status & EC_BAD_POSITION, fails ? unsigned{EC_BAD_POSITION} : 0U);
    measured = robot.command();
    if (!fails) good = measured;
    EXPECT_LT((measured - good).cwiseAbs().maxCoeff(), 1e-3) << i;
  }
  // Nor is a plan measured.
  Compensator other(ElasticArm());
  other.Command(kPlan, kNone, 0);
  EXPECT_EQ(other.Forward(Six::Constant(kNan), kNone, 0),
            unsigned{EC_BAD_POSITION} | EC_NOTHING_YET);
  other.Forward(kPlan, kNone, 0);
  EXPECT_EQ(other.Correct(Six::Constant(kNan), kNone, 0),
            unsigned{EC_BAD_POSITION} | EC_NOTHING_YET);
}

// The low-pass of a function does not depend on whether others are called as well.
TEST(RuntimeInput, EachFunctionFiltersItsOwnTorques) {
  CompensatorOptions options;
  options.torque_time_constant_s = 0.05;
  Compensator alone(ElasticArm(), options), beside(ElasticArm(), options);
  Six measured = Six::Zero();
  for (int i = 0; i < 30; ++i) {
    measured[1] = i == 0 ? 0.0 : -20.0;
    alone.Correct(kPlan, measured, 0);
    beside.Forward(kPlan, measured, 0);
    beside.Command(kPlan, Six::Constant(7.0), 0);
    beside.Correct(kPlan, measured, 0);
    EXPECT_TRUE(beside.rigid_positions() == alone.rigid_positions()) << i;
  }
}

// A torque that has gone with all others is not known any more.
TEST(RuntimeInput, ACallWithoutTorquesForgetsThem) {
  CompensatorOptions options;
  options.torque_time_constant_s = 0.05;
  const Six pull = Six::Constant(-40.0), unknown = Six::Constant(kNan);
  for (const bool forget : {false, true}) {
    Compensator robot(ElasticArm(), options), statics(ElasticArm(), options);
    // A torque that no sensor has ever told is not missed.
    EXPECT_EQ(robot.Forward(kPlan, unknown, 0), unsigned{EC_FINE});
    EXPECT_EQ(robot.Forward(kPlan, pull, 0), unsigned{EC_FINE});
    const Eigen::Isometry3d pulled = robot.link_pose(0);
    EXPECT_EQ(robot.Forward(kPlan, unknown, 0), unsigned{EC_BAD_TORQUE});
    EXPECT_TRUE(robot.link_pose(0).matrix() == pulled.matrix());
    if (forget) {
      robot.Forget();
    } else {
      EXPECT_EQ(robot.Forward(kPlan, kNone, 0), unsigned{EC_FINE});
    }
    EXPECT_EQ(robot.Forward(kPlan, unknown, 0), unsigned{EC_BAD_TORQUE});
    statics.Forward(kPlan, kNone, 0);
    EXPECT_TRUE(robot.link_pose(0).matrix() == statics.link_pose(0).matrix());
    EXPECT_FALSE(robot.link_pose(0).matrix() == pulled.matrix());
    // The low-pass begins anew.
    robot.Forward(kPlan, Six::Constant(10.0), 0);
    Compensator other(ElasticArm(), options);
    other.Forward(kPlan, Six::Constant(10.0), 0);
    EXPECT_TRUE(robot.link_pose(0).matrix() == other.link_pose(0).matrix());
  }
}

TEST(RuntimeInput, ForgetForgetsAllInput) {
  Compensator robot(ElasticArm());
  const Six unknown = Six::Constant(kNan);
  constexpr unsigned kNothing = unsigned{EC_BAD_POSITION} | EC_NOTHING_YET;
  robot.Forward(kPlan, kNone, 0);
  robot.Correct(kPlan, kNone, 0);
  robot.Command(kPlan, kNone, 0);
  robot.Forget();
  EXPECT_EQ(robot.Forward(unknown, kNone, 0), kNothing);
  EXPECT_EQ(robot.Correct(unknown, kNone, 0), kNothing);
  EXPECT_EQ(robot.Command(unknown, kNone, 0), kNothing);
}

// They are not taken for "no torques", which would mean statics without a word.
TEST(RuntimeInput, TorquesOfAWrongNumberAreBad) {
  Compensator robot(ElasticArm());
  const Eigen::VectorXd seven = Eigen::VectorXd::Constant(7, 60.0);
  EXPECT_EQ(robot.Forward(kPlan, seven, 0), unsigned{EC_BAD_TORQUE});
  EXPECT_EQ(robot.Correct(kPlan, seven, 0) & EC_BAD_TORQUE, unsigned{EC_BAD_TORQUE});
  EXPECT_EQ(robot.Command(kPlan, seven, 0), unsigned{EC_BAD_TORQUE});
  const Eigen::Isometry3d target(Eigen::Translation3d(0.3, 0.2, 0.4));
  EXPECT_EQ(robot.Command(&target, kPlan, seven, 0) & EC_BAD_TORQUE, unsigned{EC_BAD_TORQUE});
}

// An unknown foot is replaced by the last good support of the same function.
TEST(RuntimeInput, EachFunctionKeepsItsOwnSupport) {
  RuntimeModel model = ElasticArm();
  ec_foot foot{};
  foot.sole = {6, model.tips[0].frame.pose};
  foot.up[2] = 1.0;
  model.feet = {foot};
  model.foot_names = {"hand"};
  Compensator robot(model), other(model);
  robot.Forward(kPlan, kNone, 1);
  robot.Command(kPlan, kNone, 0);
  robot.Correct(kPlan, kNone, 0);
  EXPECT_EQ(robot.Forward(kPlan, kNone, 2), unsigned{EC_BAD_SUPPORT});
  other.Forward(kPlan, kNone, 1);
  EXPECT_TRUE(robot.root_pose().matrix() == other.root_pose().matrix());
  EXPECT_FALSE(robot.root_pose().matrix() == Eigen::Isometry3d::Identity().matrix());
}

// Without any good positions there is nothing to bring the hand to.
TEST(RuntimeInput, PosesWithoutAPostureGiveNoCorrection) {
  Eigen::Isometry3d target = Eigen::Isometry3d::Identity();
  target.translation() << 0.3, 0.2, 0.4;
  for (const bool good : {true, false}) {
    Compensator robot(ElasticArm());
    if (!good) target.translation()[0] = kNan;
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(robot.Command(&target, Six::Constant(kNan), kNone, 0),
                unsigned{EC_BAD_POSITION} | EC_NOTHING_YET);
      EXPECT_EQ(robot.command(), Eigen::VectorXd(Six::Zero()));
    }
    EXPECT_EQ(robot.Command(Six::Constant(kNan), kNone, 0),
              unsigned{EC_BAD_POSITION} | EC_NOTHING_YET);
  }
}

// With good positions, the nominal robot's pose replaces one that is none.
TEST(RuntimeInput, APoseMustBeFiniteAndARotation) {
  Compensator plain(ElasticArm());
  plain.Command(kPlan, kNone, 0);
  plain.Forward(plain.command(), kNone, 0);
  const Eigen::Isometry3d there = plain.link_pose(0);
  Eigen::Isometry3d nowhere = there, scaled = there, mirrored = there, sheared = there;
  nowhere.translation()[0] = kNan;
  scaled.linear() *= 1.01;
  mirrored.linear().col(2) *= -1.0;
  sheared.linear().col(0) += 0.01 * there.linear().col(1);
  for (const Eigen::Isometry3d& target : {nowhere, scaled, mirrored, sheared}) {
    Compensator robot(ElasticArm());
    EXPECT_EQ(robot.Command(&target, kPlan, kNone, 0), unsigned{EC_BAD_POSITION});
    EXPECT_TRUE(robot.command() == plain.command());
  }
  Eigen::Isometry3d rounded = there;  // three decimals
  rounded.linear() = (1e3 * there.linear()).array().round() / 1e3;
  EXPECT_EQ(Compensator(ElasticArm()).Command(&rounded, kPlan, kNone, 0), unsigned{EC_FINE});
}

}  // namespace
}  // namespace elastocal
