// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/virtual_robot.hpp"

#include <filesystem>
#include <limits>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/robot/statics.hpp"
#include "elastocal/simulation/postures.hpp"
#include "tests/biped.hpp"
#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

/// Gives a link mass, and an inertia as of steel, so that every link has weight.
void GiveMass(RobotTree& tree, double mass, const Eigen::Vector3d& com) {
  for (std::size_t i = 1; i < tree.links.size(); ++i) {
    tree.links[i].mass = mass;
    tree.links[i].com = com;
    tree.links[i].inertia = 0.01 * Eigen::Matrix3d::Identity();
  }
}

/// A pendulum about y with 2 kg at 0.5 m along x. Its waist is held.
TrueRobot Pendulum() {
  RobotTree tree = MakeRoot();
  AddJoint(tree, "swing", 0, Transform::Identity(), {0, 1, 0});
  GiveMass(tree, 2.0, {0.5, 0, 0});
  return NominalRobot(tree, {{"TIP", 1, {1.0, 0, 0}}}, {}, {0});
}

// MuJoCo would start anew without a word, and write a file into the user's folder.
TEST(VirtualRobot, SaysThatItIsUnstable) {
  std::filesystem::remove("MUJOCO_LOG.TXT");
  VirtualRobot body(Pendulum(), {}, Eigen::VectorXd::Zero(1));
  body.Step();
  EXPECT_FALSE(body.Unstable());
  EXPECT_FALSE(body.FallenFrom(body.Height() - 0.1));
  body.Command(Eigen::VectorXd::Constant(1, std::numeric_limits<double>::quiet_NaN()));
  body.Step();
  body.Command(Eigen::VectorXd::Zero(1));
  body.Step();
  EXPECT_TRUE(body.Unstable());
  EXPECT_TRUE(body.FallenFrom(body.Height() - 0.1));
  EXPECT_FALSE(std::filesystem::exists("MUJOCO_LOG.TXT"));
}

TEST(VirtualRobot, SpringOfOneJointGivesWayToItsLoad) {
  TrueRobot robot = Pendulum();
  robot.compliance[0] = 1e-5;
  VirtualRobot body(robot, {}, Eigen::VectorXd::Zero(1));
  ASSERT_TRUE(body.Settle());
  // The weight turns the pendulum about +y, and the motor balances this.
  const double load = 2.0 * 9.81 * 0.5;
  EXPECT_NEAR(body.Torques()[0], -load, 1e-5 * load);
  EXPECT_NEAR(body.Encoders()[0], load / PhysicsOptions{}.servo_stiffness, 1e-8);
  const double angle = body.Encoders()[0] + 1e-5 * load;
  EXPECT_NEAR(body.MarkerPositions()(2, 0), -std::sin(angle), 1e-8);
}

// A hanging pendulum is loaded only if its support is not level.
TEST(VirtualRobot, TiltedGravityPullsAside) {
  PhysicsOptions options;
  options.gravity_tilt_y = 0.1;
  VirtualRobot body(Pendulum(), {}, Eigen::VectorXd::Constant(1, M_PI / 2.0), options);
  ASSERT_TRUE(body.Settle());
  const double load = 2.0 * 9.81 * 0.5 * std::sin(0.1);  // towards -x, so about +y
  EXPECT_NEAR(body.Torques()[0], -load, 1e-3 * load);    // the servo gives way
}

TEST(VirtualRobot, OffsetIsWhatTheEncoderDoesNotShow) {
  TrueRobot robot = Pendulum();
  robot.offset[0] = 0.02;
  VirtualRobot body(robot, {}, Eigen::VectorXd::Constant(1, 0.1));
  ASSERT_TRUE(body.Settle());
  EXPECT_NEAR(body.MarkerPositions()(2, 0), -std::sin(body.Encoders()[0] + 0.02), 1e-9);
}

TEST(VirtualRobot, FrictionHoldsUpToItsLimit) {
  TrueRobot robot = Pendulum();
  robot.compliance[0] = 1e-5;
  robot.friction[0] = 1.5;
  VirtualRobot body(robot, {}, Eigen::VectorXd::Zero(1));
  ASSERT_TRUE(body.Settle());
  // When the joint sinks onto its servo, a part of its friction holds it: the bristle bends by
  // the angle of sinking, and slips at a bend of 2e-4 rad.
  EXPECT_GT(body.Torques()[0], -9.81 + 0.5);
  EXPECT_LE(body.Torques()[0], -9.81 + 1.5);
}

TEST(VirtualRobot, TorquesAtRestAreThoseOfTheStatics) {
  Random random(3);
  for (int trial = 0; trial < 10; ++trial) {
    RobotTree tree = RandomRobot(kUsualRelations, random);
    GiveMass(tree, 1.0, {0.05, -0.1, 0.1});
    TrueRobot robot = NominalRobot(tree, {}, {}, {});
    robot.compliance.setConstant(1e-6);
    VirtualRobot body(robot, {}, 0.3 * RandomPosture(tree, random));
    ASSERT_TRUE(body.Settle());
    // The torques are those at the links' positions, which differ from the encoders by the springs'
    // deflections.
    const Eigen::VectorXd q = body.Encoders() - 1e-6 * body.Torques();
    const Eigen::VectorXd expected = GravityTorques(tree, q);
    EXPECT_LT((body.Torques() - expected).cwiseAbs().maxCoeff(), 1e-5 * (1.0 + expected.norm()));
  }
}

TEST(VirtualRobot, NominalAndNearlyRigidIsTheForwardKinematics) {
  Random random(5);
  for (int trial = 0; trial < 10; ++trial) {
    RobotTree tree = RandomRobot(kUsualRelations, random);
    GiveMass(tree, 0.1, {0.0, 0.05, 0.1});
    const std::vector<Marker> markers = RandomMarkers(tree, random);
    VirtualRobot body(NominalRobot(tree, markers, {}, {}), {}, RandomPosture(tree, random));
    ASSERT_TRUE(body.Settle());
    const std::vector<Transform> T_root_link = LinkTransforms(tree, body.Encoders());
    const Eigen::Matrix3Xd positions = body.MarkerPositions();
    for (std::size_t m = 0; m < markers.size(); ++m) {
      const Eigen::Vector3d expected = T_root_link[markers[m].link] * markers[m].p_link_marker;
      EXPECT_LT((positions.col(static_cast<Eigen::Index>(m)) - expected).norm(), 1e-9);
    }
  }
}

TrueRobot NominalBiped() {
  const Biped biped = MakeBiped();
  return NominalRobot(biped.tree, biped.markers, FindLegs(biped.tree, biped.chains), {});
}

/// A random posture with bent legs.
Eigen::VectorXd BentPosture(const RobotTree& tree) {
  Eigen::VectorXd q = Eigen::VectorXd::Zero(tree.coordinate_count());
  for (const char* side : {"left", "right"}) {
    const int first = FindJoint(tree, std::string(side) + "_1");
    q.segment<6>(first) << 0.1, 0.05, -0.45, 0.8, -0.35, -0.08;
  }
  q[0] = 0.2;
  q[1] = 0.3;
  return q;
}

/// Potential energy of the robot above its sole, J.
double Potential(const TrueRobot& robot, const Leg& leg, const Eigen::VectorXd& positions) {
  const std::vector<Transform> T = TrueLinkTransforms(robot, positions);
  const Transform T_floor_waist =
      Transform(leg.R_floor_foot) * T[static_cast<std::size_t>(leg.foot_link)].inverse();
  double energy = 0.0;
  for (std::size_t i = 0; i < T.size(); ++i) {
    const Link& link = robot.tree.links[i];
    energy += 9.81 * link.mass * (T_floor_waist * T[i] * link.com).z();
  }
  return energy;
}

TEST(VirtualRobot, TorquesOnOneLegAreTheGradientOfThePotential) {
  TrueRobot robot = NominalBiped();
  robot.compliance.setConstant(5e-6);
  const Leg& leg = robot.legs[1];
  VirtualRobot body(robot, {leg.foot_link}, BentPosture(robot.tree));
  ASSERT_TRUE(body.Settle());
  const Eigen::VectorXd torques = body.Torques();
  const Eigen::VectorXd positions = body.Encoders() - 5e-6 * torques;
  for (Eigen::Index k = 0; k < positions.size(); ++k) {
    constexpr double kStep = 1e-5;
    Eigen::VectorXd up = positions;
    Eigen::VectorXd down = positions;
    up[k] += kStep;
    down[k] -= kStep;
    const double expected =
        (Potential(robot, leg, up) - Potential(robot, leg, down)) / (2.0 * kStep);
    EXPECT_NEAR(torques[k], expected, 1e-3) << robot.tree.joints[static_cast<std::size_t>(k)].name;
  }
}

TEST(VirtualRobot, FeetStayWhereTheyWerePutDown) {
  TrueRobot robot = NominalBiped();
  robot.compliance.setConstant(5e-6);
  const std::vector<int> feet = {robot.legs[0].foot_link, robot.legs[1].foot_link};
  Eigen::VectorXd q = BentPosture(robot.tree);
  VirtualRobot body(robot, feet, q);
  const Transform first = body.SolePose(0);
  const Transform second = body.SolePose(1);
  ASSERT_TRUE(body.Settle());
  q[0] = -0.4;  // the trunk turns and leans
  q[1] = 0.5;
  body.Command(q);
  ASSERT_TRUE(body.Settle());
  // The feet are held by constraints and not as fixed bodies.
  for (const auto& [sole, pose] : {std::pair{0, first}, std::pair{1, second}}) {
    const Transform now = body.SolePose(sole);
    EXPECT_LT((now.translation() - pose.translation()).norm(), 2e-6);
    EXPECT_LT(RotationAngle(now.linear().transpose() * pose.linear()), 2e-6);
  }
}

TEST(VirtualRobot, StandsFreeOnBothFeet) {
  TrueRobot robot = NominalBiped();
  PhysicsOptions options;
  options.standing = Standing::kFree;
  options.time_step_s = 0.002;
  Eigen::VectorXd q = Eigen::VectorXd::Zero(robot.tree.coordinate_count());
  VirtualRobot body(robot, {robot.legs[0].foot_link, robot.legs[1].foot_link}, q, options);
  const double height = body.WaistPose().translation().z();
  for (int i = 0; i < 1000; ++i) body.Step();
  EXPECT_NEAR(body.WaistPose().translation().z(), height, 2e-3);
  EXPECT_LT(RotationAngle(body.WaistPose().linear()), 0.01);
  // The floor is as firm as the constraints that hold feet: only the robot's springs give way.
  for (int sole : {0, 1}) EXPECT_NEAR(body.SolePose(sole).translation().z(), 0.0, 5e-5);
}

TEST(VirtualRobot, NeedsFeetToStandOn) {
  const TrueRobot robot = NominalBiped();
  const Eigen::VectorXd q = BentPosture(robot.tree);
  EXPECT_THROW(VirtualRobot(robot, {0}, q), std::invalid_argument);
  EXPECT_THROW(VirtualRobot(robot, {}, q, {.standing = Standing::kFree}), std::invalid_argument);
}

}  // namespace
}  // namespace elastocal
