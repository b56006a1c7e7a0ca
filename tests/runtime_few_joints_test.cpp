// SPDX-License-Identifier: Apache-2.0
// Commands of robots whose arms have too few joints for position and attitude of the hand.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/runtime/compensator.hpp"
#include "elastocal/runtime/core_equations.h"
#include "tests/runtime_calibration.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// Adds a limb of so many joints to a body, with a tip at its end.
void AddLimb(int joints, int parent, int foot, RuntimeModel& model) {
  for (int i = 0; i < joints; ++i) {
    ec_joint joint{};
    joint.parent = parent;
    joint.coordinate = static_cast<int>(model.calibrated.size());
    model.calibrated.push_back(joint);
    model.lower.push_back(-1.0);
    parent = static_cast<int>(model.calibrated.size());
  }
  if (foot < -1) return;
  ec_tip tip{};
  tip.frame.body = parent;
  tip.foot = foot;
  model.tips.push_back(tip);
}

/// The mini humanoid's posture of rest with bent elbows, which give the hands room to move.
Eigen::VectorXd BentArms(const Project& project) {
  Eigen::VectorXd q = project.motion.rest;
  for (const auto& [joint, position] :
       {std::pair{"left_elbow_roll", -0.9}, {"right_elbow_roll", 0.9}}) {
    q[project.tree.joints[static_cast<std::size_t>(FindJoint(project.tree, joint))].coordinate] =
        position;
  }
  return q;
}

bool IsOfArm(const std::string& name) {
  return name.find("shoulder") != std::string::npos || name.find("elbow") != std::string::npos;
}

/// Two arms and a neck of two joints, on one waist joint, and a leg of five joints.
std::vector<double> ArmsOf(int joints) {
  RuntimeModel model;
  AddLimb(1, 0, -2, model);
  AddLimb(joints, 1, -1, model);
  AddLimb(joints, 1, -1, model);
  AddLimb(2, 1, -1, model);
  AddLimb(5, 0, 0, model);
  FindBranches(model);
  std::vector<double> arms;
  for (const ec_tip& tip : model.tips) arms.push_back(tip.arm);
  return arms;
}

// Eleven joints for twelve numbers: the neck's two joints move no hand. With arms of six joints,
// there are thirteen.
TEST(RuntimeFewJoints, ThePlaceOfAHandComesFirstWhereJointsAreTooFew) {
  EXPECT_EQ(ArmsOf(5), (std::vector{EC_ARM_OF_FEW, EC_ARM_OF_FEW, EC_ARM, EC_ARM}));
  EXPECT_EQ(ArmsOf(6), (std::vector{EC_ARM, EC_ARM, EC_ARM, EC_ARM}));
}

// Two arms of four joints and a neck of two, on a trunk of five, like Poppy: 15 joints for 18
// numbers. Seven joints move the neck's end, but five of them, the trunk's, move the hands as well.
TEST(RuntimeFewJoints, AHeadOnAJointedTrunkIsNoArm) {
  RuntimeModel model;
  AddLimb(5, 0, -2, model);
  for (int joints : {4, 4, 2}) AddLimb(joints, 5, -1, model);
  FindBranches(model);
  EXPECT_EQ(model.tips[0].arm, EC_ARM_OF_FEW);
  EXPECT_EQ(model.tips[1].arm, EC_ARM_OF_FEW);
  EXPECT_EQ(model.tips[2].arm, EC_ARM);
  EXPECT_TRUE(IsArm(model, 0));
  EXPECT_FALSE(IsArm(model, 2));
}

TEST(RuntimeFewJoints, JointsThatMimicAddNoFreedom) {
  RuntimeModel model;
  AddLimb(6, 0, -1, model);
  model.calibrated[5].coordinate = model.calibrated[3].coordinate = 1;
  FindBranches(model);
  EXPECT_EQ(model.tips[0].freedom, 4);
  EXPECT_TRUE(IsArm(model, 0));
}

TEST(RuntimeFewJoints, TalosHasJointsEnough) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  for (const ec_tip& tip : MakeRuntimeModel(project, RandomCalibration(project, 1)).tips) {
    EXPECT_EQ(tip.arm, EC_ARM);
  }
}

// Eleven joints place two feet, of which each had its own six if the hips did not share a motor.
// What is left is shared out: it does not all fall to the foot that comes second.
TEST(RuntimeFewJoints, FeetWhoseHipsShareAMotorAreCorrectedTogether) {
  const Project project = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  const StoredCalibration stored = RandomCalibration(project, 1);
  Compensator real(MakeRuntimeModel(project, stored, RuntimeContent::kGeometry));
  Compensator nominal(MakeRuntimeModel(project, stored, RuntimeContent::kNominal));
  Eigen::VectorXd q = project.motion.rest;
  for (const auto& [joint, position] :
       {std::pair{"hip_pitch", -0.5}, {"knee_pitch", 1.0}, {"ankle_pitch", -0.5}}) {
    for (const char* side : {"left_", "right_"}) {
      const int k = FindJoint(project.tree, side + std::string(joint));
      q[project.tree.joints[static_cast<std::size_t>(k)].coordinate] = position;
    }
  }
  nominal.Forward(q, Eigen::VectorXd(), 0);
  const auto turned = [&](const char* sole) {
    const int link = FindLink(project.tree, sole);
    const Eigen::Matrix3d R =
        nominal.link_pose(link).linear().transpose() * real.link_pose(link).linear();
    return Eigen::AngleAxisd(R).angle();
  };
  real.Forward(q, Eigen::VectorXd(), 0);
  const double before = std::max(turned("left_sole"), turned("right_sole"));
  real.Command(q, Eigen::VectorXd(), 0);
  real.Forward(real.command(), Eigen::VectorXd(), 0);
  const double left = turned("left_sole"), right = turned("right_sole");
  EXPECT_GT(before, 0.01);
  EXPECT_LT(std::max(left, right), 2.0 * std::min(left, right));
}

// The springs are so soft that they bend by some milliradians. After two steps, further steps
// change nothing.
TEST(RuntimeFewJoints, CorrectedPositionsNeedNoThirdStep) {
  const Project project = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  StoredCalibration stored = RandomCalibration(project, 1);
  for (auto& [name, value] : stored.joint_errors) {
    if (name.find(".compliance") != std::string::npos) value *= 100.0;
  }
  Compensator elastic(MakeRuntimeModel(project, stored));
  Compensator rigid(MakeRuntimeModel(project, stored, RuntimeContent::kGeometry));
  Random random(2);
  double corrected = 0.0, missed = 0.0;
  for (int i = 0; i < 5; ++i) {
    Eigen::VectorXd q = BentArms(project);
    for (double& position : q) position += random.Uniform(-0.1, 0.1);
    q = q.cwiseMax(project.motion.lower).cwiseMin(project.motion.upper);
    elastic.Correct(q, Eigen::VectorXd(), 0);
    const Eigen::VectorXd two = elastic.rigid_positions();
    elastic.Forward(q, Eigen::VectorXd(), 0);
    std::vector<Eigen::Isometry3d> ends;
    for (const std::string& chain : elastic.model().tip_names) {
      const auto k = static_cast<std::size_t>(FindChain(project, chain));
      ends.push_back(elastic.link_pose(project.chains[k].tip_link));
    }
    rigid.Forget();
    rigid.Command(ends.data(), two, Eigen::VectorXd(), 0);
    for (Eigen::Index c = 0; c < q.size(); ++c) {
      if (!IsOfArm(rigid.model().coordinate_names[static_cast<std::size_t>(c)])) continue;
      corrected = std::max(corrected, std::abs(two[c] - q[c]));
      missed = std::max(missed, std::abs(rigid.command()[c] - two[c]));
    }
  }
  EXPECT_GT(corrected, 2e-3);
  EXPECT_LT(missed, 0.01 * corrected);
}

// Each joint has errors of half a degree and a millimetre. If turns had the weight that they have
// for other limbs, 2.3 mm and 0.2 degrees would remain.
TEST(RuntimeFewJoints, ArmsOfFourJointsBringTheHandToItsPlace) {
  const Project project = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  StoredCalibration stored = RandomCalibration(project, 1);
  for (auto& [name, value] : stored.joint_errors) {
    if (!IsOfArm(name)) value = 0.0;
  }
  Compensator robot(MakeRuntimeModel(project, stored));
  Random random(2);
  double largest = 0.0, turned = 0.0;
  for (int i = 0; i < 20; ++i) {
    Eigen::VectorXd q = BentArms(project);
    for (double& position : q) position += random.Uniform(-0.1, 0.1);
    robot.Forget();
    robot.Command(q.cwiseMax(project.motion.lower).cwiseMin(project.motion.upper),
                  Eigen::VectorXd(), 0);
    largest = std::max(largest, robot.residual_m());
    turned = std::max(turned, robot.residual_rad());
  }
  EXPECT_LT(largest, 3e-4);
  EXPECT_LT(turned, 0.03);
}

}  // namespace
}  // namespace elastocal
