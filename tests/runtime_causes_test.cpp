// SPDX-License-Identifier: Apache-2.0
// Causes that a calibration found besides geometry and springs, and limbs that yield, at run time.
#include <cmath>
#include <map>
#include <sstream>
#include <string>

#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/robot/inverse_dynamics.hpp"
#include "tests/runtime_fixture.hpp"

namespace elastocal {
namespace {

/// The robot as a model file stores it.
Compensator ReadBack(const RuntimeModel& model) {
  std::stringstream file;
  WriteRuntimeModel(model, file);
  return Compensator(ReadRuntimeModel(file, "file"));
}

// A head yields to the arms on its trunk. A limb whose joints move no other limb yields to none.
TEST_F(Runtime, OnlyShortLimbsBesideLongOnesYield) {
  RuntimeModel model = MakeRuntimeModel(project_, stored_);
  int yielding = 0;
  for (const ec_tip& tip : model.tips) {
    EXPECT_EQ(tip.yields != 0, tip.freedom < 6);
    yielding += tip.yields;
  }
  EXPECT_GT(yielding, 0);
  std::erase_if(model.tips, [](const ec_tip& tip) { return tip.freedom >= 6; });
  FindBranches(model);
  for (const ec_tip& tip : model.tips) EXPECT_EQ(tip.yields, 0);
}

// Causes besides geometry and springs shift joints and change their loads.
TEST_F(Runtime, AppliesWhatTheCalibrationFoundBesideGeometryAndSprings) {
  const RobotTree& tree = project_.tree;
  const auto joint = [&](const char* name) { return FindJoint(tree, name); };
  const int elbow = joint("arm_left_4_joint"), forearm = joint("arm_left_5_joint");
  const int shoulder = joint("arm_right_2_joint"), torso = joint("torso_2_joint");
  const std::string link =
      tree.links[static_cast<std::size_t>(tree.joints[static_cast<std::size_t>(elbow)].child_link)]
          .name;
  const std::map<std::string, double> causes = {
      {"arm_left_4_joint.gear", 0.004},
      {"arm_left_4_joint.eccentricity_sin", 0.002},
      {"arm_left_4_joint.ellipticity_cos", -0.001},
      {"arm_left_5_joint.coupling_arm_left_4_joint", 0.003},
      {"arm_right_2_joint.backlash", 0.0015},
      {"torso_2_joint.stiffening", 0.05},
      {link + ".mass", 0.4},
      {link + ".moment_y", -0.02}};
  stored_.joint_errors.insert(causes.begin(), causes.end());
  Compensator robot = Make();
  const Eigen::VectorXd q = Posture(4);
  const auto of = [&](int k) { return JointPosition(tree.joints[static_cast<std::size_t>(k)], q); };
  const auto limits = [&](int k) { return tree.joints[static_cast<std::size_t>(k)].limits; };
  const double middle = 0.5 * (limits(elbow).lower + limits(elbow).upper);
  const auto shifted = [&](const JointLoads& loads) {
    Eigen::VectorXd moved = q;
    const auto add = [&](int k, double by) {
      moved[tree.joints[static_cast<std::size_t>(k)].coordinate] += by;
    };
    add(elbow, 0.004 * (of(elbow) - middle) + 0.002 * std::sin(of(elbow)) -
                   0.001 * std::cos(2.0 * of(elbow)));
    add(forearm, 0.003 * (of(elbow) - middle));
    add(shoulder, 0.0015 * std::tanh(loads(2, shoulder) / (0.02 * limits(shoulder).effort)));
    add(torso,
        0.05 * loads(2, torso) * std::abs(loads(2, torso)) / std::pow(limits(torso).effort, 2));
    return moved;
  };
  ErrorModel heavier = robot_.model;
  Link& arm = heavier.tree.links[static_cast<std::size_t>(FindLink(tree, link))];
  const Eigen::Vector3d com = BodyInertias(tree)[static_cast<std::size_t>(elbow) + 1].com;
  const Eigen::Vector3d added =
      0.4 * (arm.T_body_link.inverse() * com) - 0.02 * Eigen::Vector3d::UnitY();
  arm.com = (arm.mass * arm.com + added) / (arm.mass + 0.4);
  arm.mass += 0.4;
  const JointLoads first = GravityLoads(heavier, geometry_, q, kGravity, 0);
  const JointLoads loads = GravityLoads(heavier, geometry_, shifted(first), kGravity, 0, first);
  const std::vector<Transform> expected =
      CalibratedLinkTransforms(robot_.model, geometry_, shifted(loads), loads);
  const std::vector<Transform> without =
      CalibratedLinkTransforms(robot_.model, geometry_, q, loads);
  EXPECT_EQ(robot.Forward(q, kNoTorque, 0), 0u);
  double largest = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_LT(Distance(robot.link_pose(static_cast<int>(i)), expected[i]), 10.0 * kRounding);
    largest = std::max(largest, Distance(expected[i], without[i]));
  }
  EXPECT_GT(largest, 1e-3);
  // A command must bring the hands to where the nominal robot has them.
  EXPECT_EQ(robot.Command(q, kNoTorque, 0), 0u);
  EXPECT_LT(robot.residual_m(), 1e-5);
  Compensator read = ReadBack(robot.model());
  read.Forward(q, kNoTorque, 0);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_LT(Distance(read.link_pose(static_cast<int>(i)), expected[i]), 10.0 * kRounding);
  }
}

// A joint lags by 2 mrad: its link stands still while the joint crosses its play of 4 mrad. Plans
// can cross the play on their own.
TEST_F(Runtime, FollowsAJointThroughItsPlay) {
  Compensator plain = Make();
  stored_.joint_errors["arm_left_4_joint.hysteresis"] = -2e-3;
  Compensator robot = ReadBack(Make().model());
  const auto elbow = static_cast<std::size_t>(FindJoint(project_.tree, "arm_left_4_joint"));
  const Eigen::Index at = project_.tree.joints[elbow].coordinate;
  const Eigen::VectorXd start = Posture(4);
  const auto moved = [&](double by) {
    Eigen::VectorXd q = start;
    q[at] += by;
    return q;
  };
  // Positions of the encoder, and of the joint.
  for (const auto& [encoder, joint] : std::initializer_list<std::pair<double, double>>{
           {0.0, 0.0}, {1e-3, 0.0}, {0.05, 0.048}, {0.049, 0.048}, {0.046, 0.048}, {0.03, 0.032}}) {
    robot.Forward(moved(encoder), kNoTorque, 0);
    plain.Forward(moved(joint), kNoTorque, 0);
    for (int i = 0; i < static_cast<int>(robot.model().links.size()); ++i) {
      // The loads of the first step are those at the encoders.
      EXPECT_LT(Distance(robot.link_pose(i), Transform(plain.link_pose(i).matrix())), 1e-7);
    }
    robot.Command(moved(0.02 - encoder), kNoTorque, 0);
    EXPECT_LT(robot.residual_m(), 1e-5);
  }
}

// A root link that gives way in its suspension moves the whole robot.
TEST_F(Runtime, SinksAsTheCalibrationFoundItsSuspension) {
  const Eigen::VectorXd q = Posture(5);
  const JointLoads first = GravityLoads(robot_.model, geometry_, q, kGravity, 0);
  const JointLoads loads = GravityLoads(robot_.model, geometry_, q, kGravity, 0, first);
  const std::vector<Transform> level = CalibratedLinkTransforms(robot_.model, geometry_, q, loads);
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < level.size(); ++i) {
    const Link& link = project_.tree.links[i];
    moment += (level[i] * link.com).cross(link.mass * kGravity);
  }
  stored_.joint_errors["waist.suspension_rx"] = 2e-5;
  stored_.joint_errors["waist.suspension_ry"] = 3e-5;
  stored_.joint_errors["waist.suspension_rx_my"] = -1e-5;
  stored_.joint_errors["waist.suspension_x"] = 5e-6;
  Transform sunk = Transform::Identity();
  sunk.translation().x() = 5e-6 * moment.y();
  sunk.linear() = RotationFromVector(
      Eigen::Vector3d(2e-5 * moment.x() - 1e-5 * moment.y(), 3e-5 * moment.y(), 0.0));
  Compensator robot = Make();
  EXPECT_EQ(robot.Forward(q, kNoTorque, 0), 0u);
  double largest = 0.0;
  for (std::size_t i = 0; i < level.size(); ++i) {
    // The moment is that of the posture before the last step of the fixed point, so its deflection
    // remains.
    EXPECT_LT(Distance(robot.link_pose(static_cast<int>(i)), sunk * level[i]), 1e-6);
    largest = std::max(largest, Distance(sunk * level[i], level[i]));
  }
  EXPECT_GT(largest, 2e-4);
  EXPECT_EQ(robot.Command(q, kNoTorque, 0), 0u);
  EXPECT_LT(robot.residual_m(), 1e-5);
  Compensator read = ReadBack(robot.model());
  read.Forward(q, kNoTorque, 0);
  robot.Forward(q, kNoTorque, 0);
  EXPECT_TRUE(read.link_pose(9).isApprox(robot.link_pose(9), kRounding));
}

}  // namespace
}  // namespace elastocal
