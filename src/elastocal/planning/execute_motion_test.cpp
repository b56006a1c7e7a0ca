// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/execute_motion.hpp"

#include <gtest/gtest.h>

#include "elastocal/planning/compensate_motion.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/runtime_calibration.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// At rest for a while, with the columns of one joint alone.
JointMotion OneJoint(const Project& project) {
  JointMotion motion;
  motion.source = "motion.csv";
  motion.time_s = Eigen::VectorXd::LinSpaced(5, 0.0, 0.04);
  motion.q = project.motion.rest.transpose().replicate(5, 1);
  return motion;
}

// All feet stand where a motion does not say which.
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

TEST(ExecuteMotion, ARobotWithoutFeetIsRefused) {
  const Project project = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
  ExpectInputError([&] { PlayExecutions(project, {}, OneJoint(project), {}); },
                   {"mini_humanoid_project.yaml", "has no feet", "'soles'"});
}

}  // namespace
}  // namespace elastocal
