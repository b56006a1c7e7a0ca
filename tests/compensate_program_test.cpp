// SPDX-License-Identifier: Apache-2.0
// The command `compensate` as its users run it, also with calibrations of another robot.
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/cli/execution_report.hpp"
#include "elastocal/files/output_files.hpp"
#include "elastocal/io/motion_file.hpp"
#include "tests/calibrated_talos.hpp"

namespace elastocal {
namespace {

/// A motion of two seconds about a posture.
std::string MotionText(const RobotTree& tree, const Eigen::VectorXd& middle, double swing) {
  std::string text = "time";
  for (int k : tree.coordinate_joint) text += "," + tree.joints[static_cast<std::size_t>(k)].name;
  for (int i = 0; i <= 20; ++i) {
    text += fmt::format("\n{:.1f}", 0.1 * i);
    for (double q : middle) text += fmt::format(",{:.9f}", q + swing * std::sin(0.3 * i));
  }
  return text + "\n";
}

TEST_F(CalibratedTalos, CompensatedHandsAreWhereThePlanMeant) {
  const std::string motion =
      scratch_.Write("plan.csv", MotionText(project_.tree, project_.motion.rest, 0.05));
  const std::string json = (scratch_.path() / "c.json").string();
  const ProgramResult result = Compensate(motion, "--json " + json);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(ReadFile(json))["status"], "fine");
  const JointMotion plan = ReadMotion(motion, project_);
  const JointMotion corrected = ReadMotion(scratch_.path() / "corrected.csv", project_);
  ASSERT_EQ(corrected.q.rows(), plan.q.rows());
  Compensator nominal = Robot(RuntimeContent::kNominal), real = Robot(RuntimeContent::kEverything);
  const int hand =
      project_.chains[static_cast<std::size_t>(FindChain(project_, "arm_left"))].tip_link;
  const auto place = [&](Compensator& robot, const JointMotion& at, Eigen::Index i) {
    robot.Forward(at.q.row(i).transpose(), NoTorques(), 3);
    return Eigen::Vector3d(robot.link_pose(hand).translation());
  };
  for (Eigen::Index i = 0; i < plan.q.rows(); i += 5) {
    const Eigen::Vector3d wanted = place(nominal, plan, i);
    EXPECT_LT((place(real, corrected, i) - wanted).norm(), 2e-4);
    EXPECT_GT((place(real, plan, i) - wanted).norm(), 3e-3);
  }
}

TEST_F(CalibratedTalos, JointsThatTheMotionLeavesOpenAreNamed) {
  const std::string motion = scratch_.Write("short.csv", "time,head_1_joint\n0,0\n0.5,0\n1,0\n");
  const std::string deploy = "simulate " + ProjectFile() + " --deploy " +
                             (scratch_.path() / "out").string() + " --motion " + motion + " -o " +
                             (scratch_.path() / "played").string() +
                             " --as compensated --stabiliser without";
  for (const ProgramResult& result : {Compensate(motion), RunProgram(deploy)}) {
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const std::size_t at = result.out.find("At rest, since the motion has no column of them: ");
    ASSERT_NE(at, std::string::npos) << result.out;
    const std::string line = result.out.substr(at, result.out.find('\n', at) - at);
    EXPECT_NE(line.find("head_2_joint"), std::string::npos) << line;
    EXPECT_EQ(line.find("head_1_joint"), std::string::npos) << line;
  }
}

TEST(ExecutionReport, ARobotThatWasNotPlayedHasNoFigures) {
  Execution refused;
  refused.stabilised = true;
  refused.refused = "a limit";
  const std::string said = cli::DescribeExecutions({refused});
  EXPECT_NE(said.find("not played"), std::string::npos) << said;
  EXPECT_EQ(said.find("0.0"), std::string::npos) << said;
}

TEST(ExecutionReport, ARobotThatFellHasNoInfiniteFigures) {
  Execution fallen;
  fallen.run.stood = false;
  fallen.run.least_zmp_margin = -std::numeric_limits<double>::infinity();
  const std::string said = cli::DescribeExecutions({fallen});
  EXPECT_EQ(said.find("inf"), std::string::npos) << said;
  EXPECT_NE(said.find("no foot down"), std::string::npos) << said;
}

TEST_F(CalibratedTalos, AMotionThatWouldBreakALimitIsRefused) {
  // The joints are at their limits, and a leg of six joints has none to spare. Some corrections go
  // beyond the limits.
  int refused = 0, named = 0;
  std::vector<std::pair<const Joint*, double>> limits;
  for (const char* name : {"leg_left_2_joint", "leg_left_5_joint", "leg_left_6_joint"}) {
    const Joint& joint =
        project_.tree.joints[static_cast<std::size_t>(FindJoint(project_.tree, name))];
    limits.emplace_back(&joint, joint.limits.lower);
    limits.emplace_back(&joint, joint.limits.upper);
  }
  for (const auto& [joint, limit] : limits) {
    Eigen::VectorXd middle = project_.motion.rest;
    middle[joint->coordinate] = limit;
    const std::string motion = scratch_.Write("plan.csv", MotionText(project_.tree, middle, 0.0));
    const std::string json = (scratch_.path() / "c.json").string();
    std::filesystem::remove(scratch_.path() / "corrected.csv");
    const ProgramResult result = Compensate(motion, "--json " + json);
    const bool written = std::filesystem::exists(scratch_.path() / "corrected.csv");
    if (result.exit_code == 0) {
      EXPECT_TRUE(written);
      continue;
    }
    ++refused;
    EXPECT_EQ(result.exit_code, 4);
    EXPECT_FALSE(written);
    EXPECT_NE(result.err.find("must not be played"), std::string::npos) << result.err;
    EXPECT_EQ(nlohmann::json::parse(ReadFile(json))["status"], "refused");
    const bool says =
        result.err.find("stopped by a joint's limit: " + joint->name) != std::string::npos;
    if (says) ++named;
  }
  EXPECT_GT(refused, 0);
  EXPECT_GT(named, 0);
}

TEST_F(CalibratedTalos, AMotionOfTheUsersIsNotReplaced) {
  const std::string text = MotionText(project_.tree, project_.motion.rest, 0.05);
  const std::string motion = scratch_.Write("plan.csv", text);
  const std::string output = scratch_.Write("corrected.csv", text);
  const ProgramResult refused = Compensate(motion);
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("corrected.csv: is there and was not written by this command"),
            std::string::npos)
      << refused.err;
  EXPECT_EQ(ReadFile(output), text);
  std::filesystem::remove(output);
  EXPECT_EQ(Compensate(motion).exit_code, 0);
  // The command replaces its own output, also with that of another motion.
  scratch_.Write("plan.csv", MotionText(project_.tree, project_.motion.rest, 0.04));
  const std::string first = ReadFile(output);
  EXPECT_EQ(Compensate(motion).exit_code, 0);
  EXPECT_NE(ReadFile(output), first);
}

TEST_F(CalibratedTalos, ACalibrationOfAnotherRobotIsRefused) {
  const std::string motion =
      scratch_.Write("plan.csv", MotionText(project_.tree, project_.motion.rest, 0.0));
  const std::string calibration = (scratch_.path() / "out" / "calibration.yaml").string();
  std::string text = ReadFile(calibration);
  const std::size_t at = text.find(stored_.nominal);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, stored_.nominal.size(), "0123456789abcdef");
  scratch_.Write("out/calibration.yaml", text);
  const ProgramResult compensated = Compensate(motion);
  EXPECT_EQ(compensated.exit_code, 3);
  EXPECT_NE(compensated.err.find("other nominal geometry"), std::string::npos) << compensated.err;
  EXPECT_FALSE(std::filesystem::exists(scratch_.path() / "corrected.csv"));
  for (const char* format : {"urdf", "c99", "runtime", "pal", "flex_joints"}) {
    const std::string file = (scratch_.path() / format).string();
    const ProgramResult exported = RunExport(format, file);
    EXPECT_EQ(exported.exit_code, 3) << format;
    EXPECT_NE(exported.err.find("other nominal geometry"), std::string::npos) << exported.err;
    EXPECT_FALSE(std::filesystem::exists(file)) << format;
  }
}

}  // namespace
}  // namespace elastocal
