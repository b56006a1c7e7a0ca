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
#include "tests/runtime_calibration.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

// Corrected commands take the parts of the calibrated robot to where the plan has them. The nominal
// robot with these commands would have its feet by centimetres elsewhere, which nobody plays.
TEST(CompensateMotion, ClearancesAreThoseOfTheCalibratedRobot) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const std::unique_ptr<StandingRobot> robot = StandProjectRobot(project, {});
  JointMotion plan;
  plan.source = "plan";
  plan.time_s = Eigen::Vector3d(0.0, 1.0, 2.0);
  plan.q = project.motion.rest.transpose().replicate(3, 1);
  std::vector<int> soles;
  for (const Sole& sole : project.soles) soles.push_back(sole.link);
  plan.support.assign(3, soles);
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

TEST(CompensateMotion, ARefusalNamesTheJointThatStopsAtItsLimit) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  RuntimeModel model =
      MakeRuntimeModel(project, RandomCalibration(project, 1), RuntimeContent::kEverything);
  JointMotion plan;
  plan.q = project.motion.rest.transpose();
  const auto knee = static_cast<std::size_t>(std::distance(
      model.coordinate_names.begin(),
      std::find(model.coordinate_names.begin(), model.coordinate_names.end(), "leg_left_4_joint")));
  ASSERT_LT(knee, model.lower.size());
  EXPECT_TRUE(CompensateMotion(project, model, plan).broken.empty());
  model.lower[knee] = model.upper[knee] = plan.q(0, static_cast<Eigen::Index>(knee));
  const CompensatedMotion result = CompensateMotion(project, model, plan);
  ASSERT_FALSE(result.broken.empty());
  EXPECT_EQ(result.broken[0].find("stopped by a joint's limit: leg_left_4_joint ("), 0U)
      << result.broken[0];
  EXPECT_NE(result.broken[0].find("plan the motion further from this limit"), std::string::npos);
}

// Motions of arms often lack the fingers, or the legs.
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

// Nothing would be corrected, and all of it said to be where the plan has it.
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
