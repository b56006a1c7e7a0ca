// SPDX-License-Identifier: Apache-2.0
// Commands of the robot at run time if limits of joints stand in the way.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/runtime/compensator.hpp"
#include "elastocal/runtime/core_correction.h"
#include "tests/planar_chain.hpp"
#include "tests/runtime_fixture.hpp"

namespace elastocal {
namespace {

/// Distance from hip to ankle.
double Reach(double shank, double knee) {
  return std::sqrt(kThigh * kThigh + shank * shank + 2.0 * kThigh * shank * std::cos(knee));
}

/// The error of the end at `q`, with the weight that Command gives to the angle.
double ErrorAt(Compensator& robot, const Eigen::Isometry3d& wanted, const Eigen::VectorXd& q) {
  robot.Forward(q, kNoTorque, 0);
  const Eigen::Isometry3d got = robot.link_pose(0);
  return std::hypot((got.translation() - wanted.translation()).norm(),
                    EC_ARM * Eigen::AngleAxisd(wanted.linear().transpose() * got.linear()).angle());
}

// The knee must bend by 0.2 rad to make the longer leg as long as the nominal one. The plan bends
// it slightly to the side whose limit is 0.05 rad away, and the first step goes to that side.
TEST(RuntimeLimits, AStraightKneeBendsToTheSideWhereItCan) {
  const double longer = 4e-3;
  Compensator robot = PlanarLeg(longer, -0.05, 2.3).Make();
  for (double knee : {-0.04, -0.0035, -1e-4, 0.0, 1e-4, 0.02}) {
    const Eigen::Vector3d plan(0.3, knee, -0.2);
    EXPECT_EQ(DescribeStatus(robot.Command(plan, kNoTorque, 0)), "") << knee;
    const double wanted = Reach(kShank, knee), shank = kShank + longer;
    const double bent =
        std::acos((wanted * wanted - kThigh * kThigh - shank * shank) / (2.0 * kThigh * shank));
    // 0.02 mm at the end are 0.02 / 0.2 / bent mrad at the knee.
    EXPECT_NEAR(robot.command()[1], bent, 2e-3) << knee;
    EXPECT_LT(robot.residual_m(), 2e-5) << knee;
    EXPECT_LT(robot.residual_rad(), 1e-4) << knee;
  }
}

TEST(RuntimeLimits, AKneeThatCannotBendIsNamed) {
  Compensator robot = PlanarLeg(4e-3, -0.08, 0.02).Make();
  EXPECT_EQ(robot.Command(Eigen::Vector3d(0.3, 0.0, -0.2), kNoTorque, 0), unsigned{EC_JOINT_LIMIT});
  EXPECT_EQ(robot.stopped(), (std::vector<unsigned>{0, EC_JOINT_LIMIT, 0}));
  EXPECT_NEAR(robot.left_m(1), std::hypot(robot.residual_m(), EC_ARM * robot.residual_rad()),
              1e-12);
  // The further limit is the best position. With the foot in line, this residual remains. Turning
  // the foot by a milliradian saves some micrometres.
  EXPECT_EQ(robot.command()[1], -0.08);
  EXPECT_NEAR(robot.residual_m(), Reach(kShank + 4e-3, 0.08) - Reach(kShank, 0.0), 3e-5);
}

// The lift could do the whole correction but for its limit 2 mm below. The three joints of the arm
// can do it as well. The arm's root is 12 mm higher than nominal.
TEST(RuntimeLimits, TheArmTakesOverWhatTheLiftCannot) {
  PlanarChain chain;
  chain.lift = true;
  chain.nominal_at = {Shift(0, 0), Shift(0, 0), Shift(kThigh, 0), Shift(kShank, 0)};
  chain.calibrated_at = {Shift(0, 12e-3), Shift(0, 0), Shift(kThigh, 0), Shift(kShank, 0)};
  chain.lower = {0.0, -2.0, -2.5, -2.0};
  chain.upper = {0.35, 2.0, 2.5, 2.0};
  Compensator robot = chain.Make();
  const Eigen::Vector4d plan(2e-3, 0.4, -1.2, 0.3);
  EXPECT_EQ(DescribeStatus(robot.Command(plan, kNoTorque, 0)), "");
  EXPECT_EQ(robot.command()[0], 0.0);
  EXPECT_LT(robot.residual_m(), 2e-5);
  EXPECT_EQ(robot.stopped(), std::vector<unsigned>(4, 0));
  // With enough room, the lift does the correction alone, and the others stay at the plan.
  chain.lower[0] = -0.1;
  Compensator free = chain.Make();
  free.Command(plan, kNoTorque, 0);
  EXPECT_LT(free.residual_m(), 2e-5);
  EXPECT_LT(free.command()[0], -5e-3);
}

TEST(RuntimeLimits, ACommandIsNeverWorseThanThePlan) {
  Random random(5);
  int stopped = 0;
  for (int i = 0; i < 2000; ++i) {
    const double longer = random.Uniform(-0.02, 0.02);
    PlanarChain leg = PlanarLeg(longer, random.Uniform(-0.1, 0.0), random.Uniform(0.0, 0.3));
    leg.calibrated_at[1] = Shift(kThigh, random.Uniform(-0.02, 0.02));
    leg.lower[0] = random.Uniform(-0.1, 0.0);
    leg.upper[2] = random.Uniform(0.0, 0.1);
    Compensator robot = leg.Make();
    Eigen::Vector3d plan;
    for (Eigen::Index c = 0; c < 3; ++c) {
      const auto at = static_cast<std::size_t>(c);
      plan[c] = random.Uniform(std::max(leg.lower[at], -0.3), std::min(leg.upper[at], 0.3));
    }
    Compensator nominal = [&] {
      PlanarChain same = leg;
      same.calibrated_at = same.nominal_at;
      return same.Make();
    }();
    nominal.Forward(plan, kNoTorque, 0);
    const Eigen::Isometry3d wanted = nominal.link_pose(0);
    if (robot.Command(plan, kNoTorque, 0) != 0) ++stopped;
    const Eigen::VectorXd command = robot.command();
    for (Eigen::Index c = 0; c < 3; ++c) {
      EXPECT_GE(command[c], leg.lower[static_cast<std::size_t>(c)]);
      EXPECT_LE(command[c], leg.upper[static_cast<std::size_t>(c)]);
    }
    EXPECT_LE(ErrorAt(robot, wanted, command), ErrorAt(robot, wanted, plan) + 1e-12) << i;
  }
  EXPECT_GT(stopped, 200);  // limits did stand in the way
}

// The same for the whole TALOS with springs, with postures over the whole ranges of its joints.
TEST_F(Runtime, ACommandIsNeverWorseThanThePlan) {
  Compensator robot = Make();
  Random random(6);
  for (int i = 0; i < 300; ++i) {
    Eigen::VectorXd plan = project_.motion.rest;
    for (Eigen::Index c = 0; c < plan.size(); ++c) {
      const auto at = static_cast<std::size_t>(c);
      plan[c] = random.Uniform(robot.model().lower[at], robot.model().upper[at]);
    }
    const std::vector<Transform> wanted = LinkTransforms(project_.tree, plan);
    const auto error = [&](const Eigen::VectorXd& q) {
      robot.Forward(q, kNoTorque, 0);
      double sum = 0.0;
      for (const char* name : {"arm_left", "arm_right", "leg_left", "leg_right"}) {
        const int tip =
            project_.chains[static_cast<std::size_t>(FindChain(project_, name))].tip_link;
        const Transform& T = wanted[static_cast<std::size_t>(tip)];
        const Eigen::Isometry3d got = robot.link_pose(tip);
        const double turn = Eigen::AngleAxisd(T.linear().transpose() * got.linear()).angle();
        sum += (got.translation() - T.translation()).squaredNorm() + EC_ARM * EC_ARM * turn * turn;
      }
      return std::sqrt(sum);
    };
    robot.Command(plan, kNoTorque, 0);
    const Eigen::VectorXd command = robot.command();
    EXPECT_LE(error(command), error(plan)) << i;
  }
}

// The right finger is where the left one has it: at -0.002 m less the left one's position, which
// goes from 0 to 0.04 m.
TEST(RuntimeLimits, OfADriverAreWithinThoseOfItsFollowers) {
  Project project = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  const auto find = [&](const char* name) {
    return static_cast<std::size_t>(FindJoint(project.tree, name));
  };
  JointLimits& follower = project.tree.joints[find("finger_right_joint")].limits;
  const auto range = [&](double lower, double upper) {
    follower.lower = lower;
    follower.upper = upper;
    const RuntimeModel model = MakeRuntimeModel(project, RandomCalibration(project, 1));
    const auto c = static_cast<std::size_t>(model.calibrated[find("finger_left_joint")].coordinate);
    return std::pair(model.lower[c], model.upper[c]);
  };
  const auto expect = [&](double lower, double upper, double low, double high) {
    const auto [got_low, got_high] = range(lower, upper);
    EXPECT_NEAR(got_low, low, 1e-15) << lower << ", " << upper;
    EXPECT_NEAR(got_high, high, 1e-15) << lower << ", " << upper;
  };
  expect(-0.045, 0.0, 0.0, 0.04);
  expect(-0.032, 0.0, 0.0, 0.03);
  expect(-0.045, -0.012, 0.01, 0.04);
  expect(-0.032, -0.012, 0.01, 0.03);
  expect(0.1, 0.2, 0.0, 0.04);  // it cannot follow at all: passed over
  expect(0.0, 0.0, 0.0, 0.04);  // no range is given
}

}  // namespace
}  // namespace elastocal
