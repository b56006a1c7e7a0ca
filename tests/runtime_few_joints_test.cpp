// SPDX-License-Identifier: Apache-2.0
// Commands of robots whose arms have too few joints for place and attitude of the hand.
#include <algorithm>
#include <string>
#include <vector>

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

/// A limb of so many joints on a body, with a tip at its end.
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

/// Two arms and a neck of two joints on one waist joint, and a leg of five.
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

// Eleven joints for twelve numbers: the neck's two help no hand. With six each, thirteen.
TEST(RuntimeFewJoints, ThePlaceOfAHandComesFirstWhereJointsAreTooFew) {
  EXPECT_EQ(ArmsOf(5), (std::vector{EC_ARM_OF_FEW, EC_ARM_OF_FEW, EC_ARM, EC_ARM}));
  EXPECT_EQ(ArmsOf(6), (std::vector{EC_ARM, EC_ARM, EC_ARM, EC_ARM}));
}

// Errors of half a degree and a millimetre a joint. With turns as heavy as those of other
// limbs, 2.3 mm and 0.2 degrees are left.
TEST(RuntimeFewJoints, ArmsOfFourJointsBringTheHandToItsPlace) {
  const Project project = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  StoredCalibration stored = RandomCalibration(project, 1);
  for (auto& [name, value] : stored.joint_errors) {
    const bool of_arm =
        name.find("shoulder") != std::string::npos || name.find("elbow") != std::string::npos;
    if (!of_arm) value = 0.0;
  }
  Compensator robot(MakeRuntimeModel(project, stored));
  Eigen::VectorXd bent = project.motion.rest;  // elbows, by which the hand can be put elsewhere
  for (Eigen::Index c = 0; c < bent.size(); ++c) {
    const std::string& name = robot.model().coordinate_names[static_cast<std::size_t>(c)];
    if (name == "left_elbow_roll") bent[c] = -0.9;
    if (name == "right_elbow_roll") bent[c] = 0.9;
  }
  Random random(2);
  double largest = 0.0, turned = 0.0;
  for (int i = 0; i < 20; ++i) {
    Eigen::VectorXd q = bent;
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
