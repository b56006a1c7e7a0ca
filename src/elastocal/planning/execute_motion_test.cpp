// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/execute_motion.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"
#include "tests/runtime_calibration.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// A motion that is at rest for a while.
JointMotion OneJoint(const Project& project) {
  JointMotion motion;
  motion.source = "motion.csv";
  motion.time_s = Eigen::VectorXd::LinSpaced(5, 0.0, 0.04);
  motion.q = project.motion.rest.transpose().replicate(5, 1);
  return motion;
}

// All feet stand if a motion does not say which do.
TEST(ExecuteMotion, AMotionMayLeaveItsSupportOpen) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const JointMotion motion = OneJoint(project);
  DeployOptions options;
  options.as = {DeployAs::kCompensated};
  options.stabilised = {false};
  const std::vector<Execution> executions =
      PlayExecutions(project, RandomCalibration(project, 1), motion, options);
  ASSERT_EQ(executions.size(), 1u);
  EXPECT_EQ(executions[0].refused, "");
  EXPECT_TRUE(executions[0].run.stood);
}

// The planned torques of a swinging leg bend it more than its weight alone, and so give another
// command.
TEST(ExecuteMotion, AControllerKnowsTheTorquesOfItsPlan) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  JointMotion motion = OneJoint(project);
  motion.time_s = Eigen::VectorXd::LinSpaced(41, 0.0, 0.4);
  motion.q = project.motion.rest.transpose().replicate(41, 1);
  const int arm = FindJoint(project.tree, "arm_left_1_joint");
  const Eigen::Index c = project.tree.joints[static_cast<std::size_t>(arm)].coordinate;
  motion.q.col(c).array() += 0.1 * (15.0 * motion.time_s.array()).sin().square();
  const StoredCalibration calibration = RandomCalibration(project, 1);
  const auto hands_m = [&](const DeployOptions& options) {
    return PlayExecutions(project, calibration, motion, options).at(0).hands.rms_m;
  };
  DeployOptions options;
  options.as = {DeployAs::kCompensated};
  options.stabilised = {false};
  const double by_default = hands_m(options);
  options.loads = MotionLoads::kStatics;
  EXPECT_GT(std::abs(hands_m(options) - by_default), 1e-6);
}

TEST(ExecuteMotion, ARobotWithoutFeetIsRefused) {
  const Project project = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  ExpectInputError([&] { PlayExecutions(project, {}, OneJoint(project), {}); },
                   {"mini_humanoid_project.yaml", "has no feet", "'soles'"});
}

}  // namespace
}  // namespace elastocal
