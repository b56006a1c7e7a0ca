// SPDX-License-Identifier: Apache-2.0
// Springs below the markers of the feet, at run time.
#include <gtest/gtest.h>

#include "elastocal/robot/legs.hpp"
#include "elastocal/robot/statics.hpp"
#include "elastocal/runtime/core_statics.h"
#include "elastocal/simulation/virtual_robot.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/runtime_fixture.hpp"

namespace elastocal {
namespace {

TEST_F(Runtime, ASoleSinksByTheWholeWeight) {
  const Eigen::VectorXd q = Posture(4);
  const double weight = 9.81 * TotalMass(project_.tree);
  Compensator firm = Make();
  for (int leg : {0, 1}) {
    const Leg on = Legs()[static_cast<std::size_t>(leg)];
    stored_.soles = {{.leg = on.chain, .changes = 2, .compliance = 1e-6, .sd = 1e-8}};
    Compensator soft = Make();
    firm.Forward(q, kNoTorque, 1u << leg);
    soft.Forward(q, kNoTorque, 1u << leg);
    const Eigen::Vector3d up = on.R_floor_foot.transpose() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d sunk = firm.root_pose().translation() - soft.root_pose().translation();
    EXPECT_NEAR(sunk.dot(up), 1e-6 * weight, 1e-8);  // 0.9 mm
    EXPECT_LT((sunk - sunk.dot(up) * up).norm(), 1e-8);
    // The other foot is firm.
    firm.Forward(q, kNoTorque, 2u >> leg);
    soft.Forward(q, kNoTorque, 2u >> leg);
    EXPECT_EQ(firm.root_pose().matrix(), soft.root_pose().matrix());
    // The model of the geometry has no springs. A spring that may be zero is not applied.
    stored_.soles[0].sd = 1e-6;
    Compensator unknown = Make();
    firm.Forward(q, kNoTorque, 1u << leg);
    unknown.Forward(q, kNoTorque, 1u << leg);
    EXPECT_EQ(firm.root_pose().matrix(), unknown.root_pose().matrix());
  }
  stored_.soles[0] = {.leg = "leg_lefd", .changes = 2, .compliance = 1e-6, .sd = 1e-8};
  ExpectInputError([&] { Make(); }, {"soles", "leg_lefd", "leg_left"});
}

TEST_F(Runtime, OnTwoFeetEachSoleSinksByWhatItBears) {
  for (auto& [name, value] : stored_.joint_errors) value = 0.0;  // the feet carry equal shares
  Compensator firm = Make();
  const double weight = 9.81 * TotalMass(project_.tree);
  for (const Leg& leg : Legs()) {
    stored_.soles.push_back({.leg = leg.chain, .changes = 2, .compliance = 1e-6, .sd = 1e-8});
  }
  Compensator soft = Make();
  firm.Forward(project_.motion.rest, kNoTorque, 3);
  soft.Forward(project_.motion.rest, kNoTorque, 3);
  const double sunk = firm.root_pose().translation().z() - soft.root_pose().translation().z();
  EXPECT_NEAR(sunk, 0.5e-6 * weight, 1e-6);
}

// A lifted leg hangs on its own springs, and the calibration describes it in this state. Standing
// on one foot then tells the compliance of the leg. On two feet, the leg must give way as in the
// simulator.
TEST_F(Runtime, OnTwoFeetLegsGiveWayAsTheirSpringsDo) {
  TrueRobot robot = NominalRobot(project_.tree, project_.markers, Legs(), {});
  for (const Leg& leg : robot.legs) {
    for (int k : leg.joints) robot.link_compliance[static_cast<std::size_t>(k)][2] = 1e-6;  // m/N
  }
  const int left = Legs()[0].foot_link, right = Legs()[1].foot_link;
  const auto height = [&](const std::vector<int>& support) {
    PhysicsOptions physics;
    physics.servo_stiffness *= 1e3;
    VirtualRobot body(robot, support, project_.motion.rest, physics);
    EXPECT_TRUE(body.Settle());
    return (body.LinkPose(left).inverse() * body.WaistPose()).translation().z();
  };
  const double hanging = height({}), on_one = hanging - height({left}),
               on_two = hanging - height({left, right});
  ASSERT_GT(on_one, 4e-3);
  for (auto& [name, value] : stored_.joint_errors) value = 0.0;
  Compensator rigid = Make();
  const auto sinks = [&](StandingFeet feet) {
    Compensator elastic = Make();
    rigid.Forward(project_.motion.rest, kNoTorque, feet);
    elastic.Forward(project_.motion.rest, kNoTorque, feet);
    return rigid.root_pose().translation().z() - elastic.root_pose().translation().z();
  };
  const auto set = [&](double compliance) {
    stored_.joint_errors.at("leg_left.compliance_z") = compliance;
    stored_.joint_errors.at("leg_right.compliance_z") = compliance;
  };
  set(1e-6);
  set(1e-6 * on_one / sinks(1));
  EXPECT_NEAR(sinks(1), on_one, 1e-3 * on_one);
  // With the whole weight of the legs, it would give way by a fifth less.
  EXPECT_NEAR(sinks(3), on_two, 0.02 * on_two);
}

// The arm is the lowest chain of its project.
TEST(RuntimeFeet, AnArmThatHangsDownIsNone) {
  const Project project = ReadProject(SourceFile("examples/talos_left_arm/project.yaml"));
  const RuntimeModel model = MakeRuntimeModel(project, RandomCalibration(project, 1));
  EXPECT_TRUE(model.feet.empty());
  ASSERT_EQ(model.tips.size(), 1U);
  EXPECT_EQ(model.tips[0].foot, -1);
}

TEST_F(Runtime, WithoutSolesFeetAreTheLegsThatStood) {
  const std::vector<std::string> legs = {"leg_left", "leg_right"};
  EXPECT_EQ(MakeRuntimeModel(project_, stored_).foot_names, legs);
  project_.soles.clear();
  EXPECT_EQ(MakeRuntimeModel(project_, stored_).foot_names, legs);
  std::erase_if(stored_.joint_errors, [](const auto& error) {
    return error.first.starts_with("leg_left.") || error.first.starts_with("leg_right.");
  });
  EXPECT_TRUE(MakeRuntimeModel(project_, stored_).foot_names.empty());
  project_.contact.emplace();
  project_.contact->setup.feet = {{.link = FindLink(project_.tree, "left_sole_link")}};
  EXPECT_EQ(MakeRuntimeModel(project_, stored_).foot_names, std::vector<std::string>{"leg_left"});
  project_.contact.reset();
  stored_.soles = {{.leg = "leg_right", .changes = 2, .compliance = 1e-6, .sd = 1e-8}};
  EXPECT_EQ(MakeRuntimeModel(project_, stored_).foot_names, std::vector<std::string>{"leg_right"});
}

TEST_F(Runtime, BallsAreRefused) {
  project_.soles[0].ball_radius = 0.02;
  ExpectInputError([&] { Make(); }, {"project.yaml", "left_sole_link", "is a ball", "flat soles"});
}

// The place of one foot has no moments, but a compiler that orders sums anew leaves rounding there.
TEST(RuntimeShares, RoundingGivesOneFootNoSlope) {
  double slope[2] = {1.0, 1.0};
  ec_slopes(1e-34, 2e-35, 3e-34, 0.02, -0.01, slope);
  EXPECT_EQ(slope[0], 0.0);
  EXPECT_EQ(slope[1], 0.0);
  // Two feet, 0.2 m apart along y; the weight is 0.03 m from the middle: 1/2 + 0.03 / 0.2 on one.
  ec_slopes(0.0, 0.0, 0.02, 0.01, 0.03, slope);
  EXPECT_EQ(slope[0], 0.0);
  EXPECT_NEAR(0.5 + 0.1 * slope[1], 0.65, 1e-15);
}

}  // namespace
}  // namespace elastocal
