// SPDX-License-Identifier: Apache-2.0
// Robots that stand, that are held, that lift a foot, or that cannot.
#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/motion/move_builder.hpp"
#include "elastocal/motion/plan.hpp"
#include "elastocal/robot/statics.hpp"
#include "tests/walker.hpp"

namespace elastocal {
namespace {

TEST(StandUp, PutsTheFeetAsFarApartAsTheStanceAsks) {
  const Walker walker = MakeWalker();
  StandingRobot usual(walker.tree, walker.soles, {}), wide(walker.tree, walker.soles, {});
  StandUp(usual, NeutralPosture(usual.tree, 0.05), {});
  StandOptions options;
  options.stance = 0.4;
  StandUp(wide, NeutralPosture(wide.tree, 0.05), options);
  for (std::size_t i = 0; i < 2; ++i) {
    const Transform T_world_sole =
        wide.T_world_root *
        LinkTransforms(wide.tree, wide.rest)[static_cast<std::size_t>(walker.soles[i].link)];
    EXPECT_NEAR(T_world_sole.translation().y(), i == 0 ? 0.2 : -0.2, 1e-9);
    EXPECT_NEAR(T_world_sole.translation().z(), 0.0, 1e-9);
    EXPECT_NEAR(T_world_sole.translation().x(), usual.T_world_sole[i].translation().x(), 1e-9);
    EXPECT_TRUE(T_world_sole.linear().isIdentity(1e-9));
  }
  EXPECT_NEAR(usual.T_world_sole[0].translation().y(), 0.085, 1e-9);
}

TEST(HeldRobot, VisitsItsPosturesWithoutBalanceAndWithTheTorquesOfStatics) {
  const Walker walker = MakeWalker();
  StandingRobot robot(walker.tree, {}, {});
  StandUp(robot, NeutralPosture(robot.tree, 0.05), {});
  PostureTour set{"all", {}, {robot.rest, robot.rest}, false, {}};
  set.postures[0].head<3>() << 0.8, -0.5, 0.3;
  set.postures[0][5] = -1.0;  // a hip joint: its leg hangs
  set.postures[1].head<3>() << -0.4, 0.6, -1.0;
  const PlannedTour planned = PlanTour(robot, set, {});
  EXPECT_TRUE(planned.left_out.empty());
  ASSERT_EQ(planned.visits.size(), 2U);
  MotionForces forces;
  const MotionMargins margins = CheckMotion(robot, planned.motion, &forces);
  EXPECT_FALSE(Broken(margins, robot.limits));
  EXPECT_LT(margins.zmp.sample, 0);  // no foot stands
  for (const Visit& visit : planned.visits) {
    const int middle = (visit.begin + visit.end) / 2;
    const Eigen::VectorXd q = planned.motion.q.row(middle).transpose();
    EXPECT_LT((q - set.postures[static_cast<std::size_t>(visit.posture)]).norm(), 1e-12);
    EXPECT_LT((forces.torques.row(middle).transpose() - GravityTorques(robot.tree, q)).norm(),
              1e-9);
    EXPECT_EQ(forces.T_world_root[static_cast<std::size_t>(middle)].matrix(),
              robot.T_world_root.matrix());
  }
  // Limits are checked as in any other motion: the leg that is held ahead needs 30 of its 150 N.m.
  robot.limits.torque_share = 0.1;
  EXPECT_FALSE(PlanTour(robot, set, {}).left_out.empty());
}

TEST(StandingRobot, LengthsOfAMotionFollowFromItsSize) {
  const Walker walker = MakeWalker();
  const StandingRobot robot(walker.tree, walker.soles, {});
  EXPECT_NEAR(robot.leg_length, 0.38 + 0.325 + 0.107, 1e-12);  // the axes of the hip meet
  EXPECT_NEAR(robot.half_support, 0.06, 1e-12);
  EXPECT_NEAR(robot.limits.zmp_margin, 0.3 * 0.06, 1e-12);
  const PlanOptions sized = SizedOptions(robot, {});
  EXPECT_NEAR(sized.lift_m, 0.123 * 0.812, 1e-12);
  EXPECT_NEAR(sized.inset, 0.54 * 0.06, 1e-12);
  PlanOptions given;
  given.lift_m = 0.05;
  EXPECT_EQ(SizedOptions(robot, given).lift_m, 0.05);
}

// Bent knees already use 0.5 rad of the ankle's pitch. To lift a foot flat would take 0.8 rad.
TEST(StandingRobot, LiftsItsFootTiltedWhereTheAnkleBendsLittle) {
  Walker walker = MakeWalker();
  for (Joint& joint : walker.tree.joints) {
    if (joint.name == "left_5" || joint.name == "right_5") joint.limits.lower = -0.6;
  }
  StandingRobot robot(walker.tree, walker.soles, {});
  StandUp(robot, NeutralPosture(robot.tree, 0.05), {});
  const PostureTour set{"right", {0}, {}, false, {}};
  const PlannedTour planned = PlanTour(robot, set, {});
  ASSERT_GT(planned.end, planned.begin);
  EXPECT_FALSE(Broken(CheckMotion(robot, planned.motion), robot.limits));
  const auto tilt = [&](int row) {
    const auto poses = LinkTransforms(robot.tree, planned.motion.q.row(row).transpose());
    const Transform T_left_right = poses[static_cast<std::size_t>(robot.soles[0].link)].inverse() *
                                   poses[static_cast<std::size_t>(robot.soles[1].link)];
    return RotationAngle(T_left_right.linear());
  };
  EXPECT_GT(tilt(planned.begin), 0.05);
  EXPECT_LT(tilt(0), 1e-9);
}

// A lifted foot passes the standing leg further out than its own hip. If it stays flat, its ankle
// rolls more the higher it is.
TEST(StandingRobot, LiftsItsFootTiltedWhereTheAnkleRollsLittle) {
  Walker walker = MakeWalker();
  const int roll = FindJoint(walker.tree, "right_6");
  const auto largest_roll = [&] {
    StandingRobot robot(walker.tree, walker.soles, {});
    StandUp(robot, NeutralPosture(robot.tree, 0.05), {});
    const PlannedTour planned = PlanTour(robot, {"right", {0}, {}, false, {}}, {});
    EXPECT_GT(planned.end, planned.begin);
    EXPECT_FALSE(Broken(CheckMotion(robot, planned.motion), robot.limits));
    return planned.motion.q.col(robot.tree.joints[Size(roll)].coordinate).cwiseAbs().maxCoeff();
  };
  const double flat = largest_roll();
  JointLimits& limits = walker.tree.joints[Size(roll)].limits;
  limits.upper = 0.95 * flat + MotionLimits{}.position_margin;
  limits.lower = -limits.upper;
  EXPECT_LE(largest_roll(), 0.95 * flat);
}

TEST(StandingRobot, RefusesWhatCannotStand) {
  Walker walker = MakeWalker();
  Sole on_arm{walker.hand, {-0.1, -0.1}, {0.1, 0.1}};
  EXPECT_THROW(StandingRobot(walker.tree, {on_arm}, {}), InputError);
}

}  // namespace
}  // namespace elastocal
