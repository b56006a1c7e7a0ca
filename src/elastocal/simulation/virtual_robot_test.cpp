#include "elastocal/simulation/virtual_robot.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/robot/statics.hpp"
#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

/// Steel-like inertia so that every link has weight.
void GiveMass(RobotTree& tree, double mass, const Eigen::Vector3d& com) {
  for (std::size_t i = 1; i < tree.links.size(); ++i) {
    tree.links[i].mass = mass;
    tree.links[i].com = com;
    tree.links[i].inertia = 0.01 * Eigen::Matrix3d::Identity();
  }
}

/// A pendulum about y with 2 kg at 0.5 m along x, its waist held.
TrueRobot Pendulum() {
  RobotTree tree = MakeRoot();
  AddJoint(tree, "swing", 0, Transform::Identity(), {0, 1, 0});
  GiveMass(tree, 2.0, {0.5, 0, 0});
  return NominalRobot(tree, {{"TIP", 1, {1.0, 0, 0}}}, {}, {0});
}

TEST(VirtualRobot, SpringOfOneJointGivesWayToItsLoad) {
  TrueRobot robot = Pendulum();
  robot.compliance[0] = 1e-5;
  VirtualRobot body(robot, {}, Eigen::VectorXd::Zero(1));
  ASSERT_TRUE(body.Settle());
  // The weight turns the pendulum about +y; the motor balances it.
  const double load = 2.0 * 9.81 * 0.5;
  EXPECT_NEAR(body.Torques()[0], -load, 1e-5 * load);
  EXPECT_NEAR(body.Encoders()[0], load / PhysicsOptions{}.servo_stiffness, 1e-8);
  const double angle = body.Encoders()[0] + 1e-5 * load;
  EXPECT_NEAR(body.MarkerPositions()(2, 0), -std::sin(angle), 1e-8);
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
  // Sinking onto the servo, the joint is held by part of its friction (a bristle that has bent by
  // the way sunk, 2e-4 rad being the bend at which it slips).
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
    // Evaluated where the links are: beyond the encoders by the springs' deflections.
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

}  // namespace
}  // namespace elastocal
