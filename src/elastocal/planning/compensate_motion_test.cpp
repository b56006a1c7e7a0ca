// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/compensate_motion.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/planning/project_motion.hpp"
#include "elastocal/robot/collision.hpp"
#include "elastocal/robot/statics.hpp"
#include "tests/runtime_calibration.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// TALOS standing for two seconds.
JointMotion RestOnSoles(const Project& project) {
  JointMotion plan;
  plan.source = "plan";
  plan.time_s = Eigen::Vector3d(0.0, 1.0, 2.0);
  plan.q = project.motion.rest.transpose().replicate(3, 1);
  std::vector<int> soles;
  for (const Sole& sole : project.soles) soles.push_back(sole.link);
  plan.support.assign(3, soles);
  return plan;
}

// Corrected commands bring the parts of the calibrated robot to their planned places. With these
// commands the nominal robot's feet would be centimetres off, but no such robot exists.
TEST(CompensateMotion, ClearancesAreThoseOfTheCalibratedRobot) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const std::unique_ptr<StandingRobot> robot = StandProjectRobot(project, {});
  const JointMotion plan = RestOnSoles(project);
  const double planned = robot->clearances(project.motion.rest).minCoeff();
  double naive = 0.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const RuntimeModel model =
        MakeRuntimeModel(project, RandomCalibration(project, seed), RuntimeContent::kEverything);
    const CompensatedMotion result = CompensateMotion(project, model, plan);
    ASSERT_TRUE(result.has_clearance);
    EXPECT_NEAR(result.clearance.value, planned, 8e-3);
    const Eigen::VectorXd commanded = result.planned.motion.q.row(0).transpose();
    naive = std::max(naive, std::abs(robot->clearances(commanded).minCoeff() - planned));
  }
  EXPECT_GT(naive, 16e-3);
}

// A calibrated trunk that is displaced moves the centre of mass, even if hands and feet are as
// planned.
TEST(CompensateMotion, BalanceIsThatOfTheCalibratedRobot) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const JointMotion plan = RestOnSoles(project);
  RuntimeModel model =
      MakeRuntimeModel(project, RandomCalibration(project, 1), RuntimeContent::kNominal);
  const auto trunk = static_cast<std::size_t>(FindLink(project.tree, "torso_2_link"));
  double planned = 0.0;
  const auto margin = [&](double forward) {
    model.links[trunk].pose.p[0] += forward;
    const CompensatedMotion result = CompensateMotion(project, model, plan);
    EXPECT_TRUE(result.has_zmp);
    EXPECT_EQ(result.broken.empty(), result.zmp.value > 0.0);
    EXPECT_EQ(result.broken.empty() && result.warnings.empty(), result.zmp.value > 0.0195);
    planned = result.planned_zmp.value;
    return result.zmp.value;
  };
  const double as_planned = margin(0.0);
  EXPECT_NEAR(as_planned, planned, 1e-6);
  const double of_trunk = project.tree.links[trunk].mass / TotalMass(project.tree);
  EXPECT_NEAR(margin((planned - 0.01) / of_trunk), 0.01, 1e-4);
  EXPECT_NEAR(margin(0.02 / of_trunk), -0.01, 1e-4);
}

// `plan` holds the root link of a robot without soles, and its motion has no column `support`.
TEST(CompensateMotion, WithoutSolesTheRootLinkIsHeld) {
  Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  project.soles.clear();
  const RuntimeModel model = MakeRuntimeModel(project, RandomCalibration(project, 1));
  ASSERT_EQ(model.feet.size(), 2U);
  JointMotion plan;
  plan.q = project.motion.rest.transpose();
  const CompensatedMotion silent = CompensateMotion(project, model, plan);
  const auto supported = [&](const std::vector<int>& links) {
    plan.support = {links};
    return CompensateMotion(project, model, plan);
  };
  EXPECT_EQ(silent.planned.motion.q, supported({}).planned.motion.q);
  const int left = FindLink(project.tree, "left_sole_link");
  EXPECT_NE(silent.planned.motion.q, supported({left}).planned.motion.q);
}

/// TALOS with random errors, and a plan that stays in its posture of rest.
class AtRest {
 public:
  CompensatedMotion Compensate(const CompensateMotionOptions& options = {}) const {
    return CompensateMotion(project_, model_, plan_, options);
  }
  /// Holds a joint at its planned position, by its limits.
  void Hold(const char* joint) {
    const Eigen::Index c =
        project_.tree.joints[static_cast<std::size_t>(FindJoint(project_.tree, joint))].coordinate;
    model_.lower[static_cast<std::size_t>(c)] = plan_.q(0, c);
    model_.upper[static_cast<std::size_t>(c)] = plan_.q(0, c);
  }

 private:
  Project project_ = ReadProject(SourceFile("models/talos/project.yaml"));
  RuntimeModel model_ =
      MakeRuntimeModel(project_, RandomCalibration(project_, 1), RuntimeContent::kEverything);
  JointMotion plan_{.source = {}, .time_s = {}, .q = project_.motion.rest.transpose()};
};

TEST(CompensateMotion, ARefusalNamesTheJointThatStopsAtItsLimit) {
  AtRest talos;
  EXPECT_TRUE(talos.Compensate().broken.empty());
  talos.Hold("leg_left_4_joint");
  const CompensatedMotion result = talos.Compensate({.most_left_m = 1e-3});
  ASSERT_EQ(result.broken.size(), 2U);
  EXPECT_NE(result.broken[1].find("mm are left at the end of leg_left at 0.00 s, more than 1.00 mm "
                                  "(a degree counts 5.2 mm)"),
            std::string::npos)
      << result.broken[1];
  EXPECT_EQ(result.broken[0].find("stopped by a joint's limit: leg_left_4_joint ("), 0U)
      << result.broken[0];
  EXPECT_NE(result.broken[0].find("(a degree counts 5.2 mm; 1 of 1 samples"), std::string::npos);
  EXPECT_NE(result.broken[0].find("plan the motion further from this limit (design and plan again "
                                  "with --limit-margin-deg, or for an arm with a narrower "
                                  "design.range_deg"),
            std::string::npos);
}

// A hand is mounted eleven degrees off on an arm of four joints, which can only correct its
// position.
TEST(CompensateMotion, AHandInItsPlaceIsRefusedForItsAttitude) {
  const Project project = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  RuntimeModel model =
      MakeRuntimeModel(project, RandomCalibration(project, 1), RuntimeContent::kNominal);
  const auto hand = std::ranges::find(model.tip_names, "left_arm") - model.tip_names.begin();
  ec_joint& elbow = model.calibrated[static_cast<std::size_t>(
      model.tips[static_cast<std::size_t>(hand)].frame.body - 1)];
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()).matrix();
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(elbow.body.R);
  R = turn * R.eval();
  JointMotion plan;
  plan.q = project.motion.rest.transpose();
  const auto most_turned = [&](double degrees) {
    return CompensateMotion(project, model, plan, {.most_turned_rad = degrees * M_PI / 180.0});
  };
  const CompensatedMotion result = most_turned(3.0);
  EXPECT_LT(result.residual_m, 2e-3);
  ASSERT_FALSE(result.broken.empty());
  EXPECT_NE(result.broken.back().find("deg are left at the end of left_arm at 0.00 s, more than 3"),
            std::string::npos)
      << result.broken.back();
  EXPECT_TRUE(most_turned(10.0).broken.empty());
}

// If limits allow less than the wanted correction, a warning names the limb, and the motion is
// still played.
TEST(CompensateMotion, WhatLimitsLeaveIsSaidAndNotRefused) {
  AtRest talos;
  talos.Hold("leg_left_4_joint");
  const CompensatedMotion result = talos.Compensate({.most_left_m = 0.05});
  EXPECT_TRUE(result.broken.empty());
  ASSERT_EQ(result.warnings.size(), 1U);
  EXPECT_EQ(result.warnings[0].find("stopped by a joint's limit: leg_left_4_joint ("), 0U);
  for (const LeftAtLimb& one : result.left) {
    EXPECT_EQ(one.samples, one.most.value > kLeftOver_m ? 1 : 0);
    if (!one.yields) {
      EXPECT_EQ(one.samples > 0, one.limb == "leg_left") << one.limb;
    }
  }
}

// A nearly stretched arm makes the trunk move, and the head compensates for that, at most at the
// speed limit of its joints.
TEST(CompensateMotion, CorrectionsKeepTheSpeedOfTheJoints) {
  Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const RuntimeModel model =
      MakeRuntimeModel(project, RandomCalibration(project, 1), RuntimeContent::kEverything);
  const auto joint = [&](const char* name) -> Joint& {
    return project.tree.joints[static_cast<std::size_t>(FindJoint(project.tree, name))];
  };
  JointMotion plan;
  plan.time_s = Eigen::VectorXd::LinSpaced(101, 0.0, 1.0);
  plan.q = project.motion.rest.transpose().replicate(101, 1);
  for (Eigen::Index i = 0; i <= 100; ++i) {
    plan.q(i, joint("arm_right_4_joint").coordinate) =
        -0.22 - 0.45 * (1.0 + std::cos(2.0 * M_PI * plan.time_s[i]));
  }
  Joint& head = joint("head_1_joint");
  const auto largest_speed = [&] {
    const CompensatedMotion result = CompensateMotion(project, model, plan);
    EXPECT_TRUE(result.broken.empty()) << result.broken[0];
    const Eigen::VectorXd q = result.planned.motion.q.col(head.coordinate);
    return (q.tail(100) - q.head(100)).cwiseAbs().maxCoeff() / 0.01;
  };
  const double limit = 0.5 * largest_speed();
  EXPECT_GT(limit, 0.01);
  head.limits.velocity = limit;
  EXPECT_LE(largest_speed(), limit);
}

/// The small humanoid, whose right hip follows the left one, at rest for two seconds.
struct SharedHips {
  SharedHips() {
    for (const char* sole : {"left_sole", "right_sole"}) {
      project.soles.push_back({.link = FindLink(project.tree, sole),
                               .lower = Eigen::Vector2d(-0.05, -0.03),
                               .upper = Eigen::Vector2d(0.09, 0.03)});
    }
    plan = RestOnSoles(project);
  }
  Project project = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  JointMotion plan;
};

// The shared coordinate carries both hips' torques; each spring feels its own.
TEST(CompensateMotion, JointsThatShareAMotorHaveTheirOwnTorques) {
  const SharedHips robot;
  StoredCalibration calibration = RandomCalibration(robot.project, 1);
  for (auto& [name, value] : calibration.joint_errors) {
    if (name.find("hip_yaw_pitch.compliance_z") != std::string::npos) value = 2e-3;
  }
  const RuntimeModel model =
      MakeRuntimeModel(robot.project, calibration, RuntimeContent::kEverything);
  const auto commands = [&](MotionLoads loads) {
    const CompensatedMotion result =
        CompensateMotion(robot.project, model, robot.plan, {.loads = loads, .most_left_m = 1.0});
    return Eigen::VectorXd(result.planned.motion.q.row(1).transpose());
  };
  // At rest, torques of the plan are those of statics.
  const Eigen::VectorXd statics = commands(MotionLoads::kStatics);
  EXPECT_LT((commands(MotionLoads::kPlanned) - statics).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(CompensateMotion, AJointIsNoFasterThanItsFollowerMayBe) {
  SharedHips robot;
  const RuntimeModel model = MakeRuntimeModel(robot.project, RandomCalibration(robot.project, 1),
                                              RuntimeContent::kNominal);
  const int leader = FindJoint(robot.project.tree, "left_hip_yaw_pitch");
  const int follower = FindJoint(robot.project.tree, "right_hip_yaw_pitch");
  const Eigen::Index c = robot.project.tree.joints[static_cast<std::size_t>(leader)].coordinate;
  robot.plan.q.col(c).array() -= Eigen::Array3d(0.0, 0.1, 0.2);
  robot.project.tree.joints[static_cast<std::size_t>(follower)].limits.velocity = 0.05;
  const CompensatedMotion result =
      CompensateMotion(robot.project, model, robot.plan, {.most_left_m = 1.0});
  EXPECT_NEAR(result.velocity.value, 2.0, 0.1);
  ASSERT_FALSE(result.broken.empty());
  EXPECT_NE(result.broken.back().find("faster than a joint's limit: left_hip_yaw_pitch"),
            std::string::npos)
      << result.broken.back();
}

// Accelerations are differences of positions at equal intervals.
TEST(CompensateMotion, BalanceIsCheckedWhereSamplesAreEven) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const RuntimeModel model =
      MakeRuntimeModel(project, RandomCalibration(project, 1), RuntimeContent::kEverything);
  JointMotion plan = RestOnSoles(project);
  plan.time_s[2] = 1.5;
  const CompensatedMotion result = CompensateMotion(project, model, plan);
  EXPECT_FALSE(result.has_zmp);
  ASSERT_EQ(result.warnings.size(), 1U);
  EXPECT_NE(result.warnings[0].find("balance was not checked"), std::string::npos);
  EXPECT_THROW(CompensateMotion(project, model, plan, {.loads = MotionLoads::kPlanned}),
               InputError);
}

// A soft robot may bend by more than the limit, and its user may know that.
TEST(CompensateMotion, ADeflectionBeyondItsLimitIsSaidWithTheLimit) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const RuntimeModel model =
      MakeRuntimeModel(project, RandomCalibration(project, 1), RuntimeContent::kEverything);
  CompensateMotionOptions options;
  options.limits.largest_turn_rad = 1e-4;
  const CompensatedMotion cut = CompensateMotion(project, model, RestOnSoles(project), options);
  ASSERT_FALSE(cut.broken.empty());
  EXPECT_NE(cut.broken[0].find("from 0.00 s on (limits: 0.00573 deg and 20 mm)"), std::string::npos)
      << cut.broken[0];
  options.limits.largest_turn_rad = 0.05;
  EXPECT_TRUE(CompensateMotion(project, model, RestOnSoles(project), options).broken.empty());
}

// Motions of arms often lack the fingers or the legs.
TEST(CompensateMotion, JointsThatAMotionLeavesOpenAreAtRest) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const RuntimeModel model =
      MakeRuntimeModel(project, RandomCalibration(project, 1), RuntimeContent::kEverything);
  JointMotion whole, open;
  whole.q = open.q = project.motion.rest.transpose().replicate(2, 1);
  open.q.col(0).setConstant(std::numeric_limits<double>::quiet_NaN());
  const CompensatedMotion expected = CompensateMotion(project, model, whole);
  const CompensatedMotion result = CompensateMotion(project, model, open);
  EXPECT_TRUE(expected.at_rest.empty());
  EXPECT_EQ(result.at_rest, std::vector<std::string>{model.coordinate_names[0]});
  EXPECT_TRUE(result.broken.empty()) << result.broken[0];
  EXPECT_EQ(result.planned.motion.q, expected.planned.motion.q);
}

// Nothing would be corrected, and everything would be reported to be where the plan has it.
TEST(CompensateMotion, WithoutChainsNothingSaysWhatIsToBeWhere) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  RuntimeModel model =
      MakeRuntimeModel(project, RandomCalibration(project, 1), RuntimeContent::kEverything);
  model.tips.clear();
  JointMotion plan;
  plan.q = project.motion.rest.transpose();
  try {
    CompensateMotion(project, model, plan);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'chains: [{name: NAME, tip: LINK}]' was expected"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace elastocal
