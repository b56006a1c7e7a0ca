// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/leave_room.hpp"

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/planning/plan_motion.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

constexpr double kOneDeg = M_PI / 180.0;

TEST(LeaveRoom, MovesTheLimitsOfTurningJointsAndThoseOfPostures) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const Project narrow = LeaveRoom(project, 3.0 * kOneDeg);
  const auto joint = static_cast<std::size_t>(FindJoint(project.tree, "leg_left_2_joint"));
  const JointLimits& before = project.tree.joints[joint].limits;
  const JointLimits& after = narrow.tree.joints[joint].limits;
  EXPECT_NEAR(after.lower - before.lower, 3.0 * kOneDeg, 1e-12);
  EXPECT_NEAR(before.upper - after.upper, 3.0 * kOneDeg, 1e-12);
  const int c = project.tree.joints[joint].coordinate;
  const double inside = 0.02 * (before.upper - before.lower);  // postures stay away this far
  EXPECT_NEAR(project.motion.lower[c] - before.lower, inside, 1e-12);
  EXPECT_NEAR(narrow.motion.lower[c] - after.lower, inside, 1e-12);
  EXPECT_NEAR(after.upper - narrow.motion.upper[c], inside, 1e-12);
  EXPECT_EQ(LeaveRoom(project, 0.0).tree.joints[joint].limits.lower, before.lower);
}

// The posture of rest stays possible.
TEST(LeaveRoom, WhereAJointRestsNearItsLimitLessIsLeft) {
  Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const auto lower = [](const Project& of, const char* joint) {
    return of.tree.joints[static_cast<std::size_t>(FindJoint(of.tree, joint))].limits.lower;
  };
  const int knee =
      project.tree.joints[static_cast<std::size_t>(FindJoint(project.tree, "leg_left_4_joint"))]
          .coordinate;
  project.motion.rest[knee] = project.motion.lower[knee] + 2.0 * kOneDeg;
  const Project narrow = LeavePossibleRoom(
      project, Eigen::VectorXd::Constant(project.tree.coordinate_count(), 5.0 * kOneDeg));
  EXPECT_NEAR(lower(narrow, "leg_left_2_joint") - lower(project, "leg_left_2_joint"), 5.0 * kOneDeg,
              1e-12);
  EXPECT_NEAR(lower(narrow, "leg_left_4_joint") - lower(project, "leg_left_4_joint"), 2.0 * kOneDeg,
              1e-12);
  EXPECT_NEAR(narrow.motion.lower[knee], project.motion.rest[knee], 1e-12);
}

// A project says how much room its robot needs; the command line says otherwise.
TEST(LeaveRoom, AProjectAsksForIt) {
  const std::filesystem::path talos = SourceFile("models/talos/project.yaml");
  EXPECT_EQ(ReadProject(talos).motion.room.maxCoeff(), 0.0);
  const ScratchFolder folder;
  std::filesystem::copy_file(talos.parent_path() / "talos.urdf", folder.path() / "talos.urdf");
  std::string text = ReadFile(talos);
  text.insert(text.find("  rest_deg:"), "  room_deg: {leg_left_2_joint: 5}\n");
  const Project project = ReadProject(folder.Write("project.yaml", text));
  EXPECT_NEAR(project.motion.room.sum(), 5.0 * kOneDeg, 1e-12);
  const auto lower = [&](const std::optional<double>& given) {
    const RobotTree tree = WithRoom(project, given).tree;
    return tree.joints[static_cast<std::size_t>(FindJoint(tree, "leg_left_2_joint"))].limits.lower;
  };
  EXPECT_NEAR(lower({}) - lower(0.0), 5.0 * kOneDeg, 1e-12);
  EXPECT_NEAR(lower(2.0) - lower(0.0), 2.0 * kOneDeg, 1e-12);
  text.replace(text.find("joint: 5}"), 9, "joint: 50}");
  ExpectInputError([&] { ReadProject(folder.Write("project.yaml", text)); }, {"room_deg", "45"});
}

// Sines of an elbow went beyond the range that the project asks for. Legs need theirs to balance.
TEST(LeaveRoom, MotionsOfArmsKeepTheRangesOfPostures) {
  Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const auto joint = [](const Project& of, const char* name) -> const Joint& {
    return of.tree.joints[static_cast<std::size_t>(FindJoint(of.tree, name))];
  };
  const JointLimits elbow = joint(project, "arm_left_4_joint").limits;
  const JointLimits knee = joint(project, "leg_left_4_joint").limits;
  const double inside = 0.02 * (elbow.upper - elbow.lower);
  // Nothing changes where postures have the whole range, also of a robot that leaves room.
  for (const double room_deg : {0.0, 6.0}) {
    const Project narrow = LeaveRoom(project, room_deg * kOneDeg),
                  same = WithRoom(project, room_deg);
    for (std::size_t k = 0; k < project.tree.joints.size(); ++k) {
      EXPECT_NEAR(same.tree.joints[k].limits.lower, narrow.tree.joints[k].limits.lower, 1e-12);
      EXPECT_NEAR(same.tree.joints[k].limits.upper, narrow.tree.joints[k].limits.upper, 1e-12);
    }
  }
  project.motion.upper[joint(project, "arm_left_4_joint").coordinate] = -0.5;
  project.motion.lower[joint(project, "leg_left_4_joint").coordinate] = 0.5;
  const Project kept = KeepRanges(project, project.tree);
  EXPECT_NEAR(joint(kept, "arm_left_4_joint").limits.upper, -0.5 + inside, 1e-12);
  EXPECT_NEAR(joint(kept, "arm_left_4_joint").limits.lower, elbow.lower, 1e-12);
  EXPECT_EQ(joint(kept, "leg_left_4_joint").limits.lower, knee.lower);
}

// Six free degrees and a margin of 0.57 degrees make 6.57 degrees to the joint's own limit.
TEST(LeaveRoom, APlanCountsToTheJointsOwnLimits) {
  const Project own = ReadProject(SourceFile("models/talos/project.yaml"));
  const Project narrow = LeaveRoom(own, 6.0 * kOneDeg);
  MotionPlan plan;
  plan.margins.position = {0.6 * kOneDeg, 3, FindJoint(own.tree, "leg_left_4_joint")};
  plan.limits.resize(2);
  plan.limits[0].what = "torque, % of limit";
  plan.limits[0].worst = "50";
  plan.limits[1].what = "joint to end of range, deg";
  CountToOwnLimits(own, narrow, {}, plan);
  EXPECT_NEAR(plan.margins.position.value, 6.6 * kOneDeg, 1e-12);
  EXPECT_EQ(plan.limits[0].worst, "50");
  EXPECT_EQ(plan.limits[1].worst, "6.60");
  EXPECT_EQ(plan.limits[1].limit, "6.57");
  CountToOwnLimits(own, own, {}, plan);
  EXPECT_EQ(plan.limits[1].worst, "6.60");
  Project one_end = own;  // the plan does not say which end is near: nothing is added
  one_end.tree.joints[static_cast<std::size_t>(plan.margins.position.index)].limits.upper -= 0.5;
  CountToOwnLimits(own, one_end, {}, plan);
  EXPECT_EQ(plan.limits[1].worst, "6.60");
}

// A joint with a range of 20 degrees keeps 16 of them. A sliding joint keeps its whole range.
TEST(LeaveRoom, LeavesNineTenthsOfAShortRange) {
  Project project = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  for (Joint& joint : project.tree.joints) {
    if (joint.type == JointType::kRevolute)
      joint.limits.lower = -(joint.limits.upper = 10.0 * kOneDeg);
  }
  project.motion.rest.setZero();
  project.motion.lower.setConstant(-10.0);
  project.motion.upper.setConstant(10.0);
  const Project narrow = LeaveRoom(project, 30.0 * kOneDeg);
  for (std::size_t k = 0; k < project.tree.joints.size(); ++k) {
    const Joint& joint = narrow.tree.joints[k];
    if (joint.type == JointType::kPrismatic) {
      EXPECT_EQ(joint.limits.upper, project.tree.joints[k].limits.upper);
    } else if (!joint.mimic) {
      EXPECT_NEAR(joint.limits.upper, 8.0 * kOneDeg, 1e-12);
    }
  }
}

TEST(LeaveRoom, APostureOfRestInTheRoomIsNamed) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  ExpectInputError([&] { LeaveRoom(project, 20.0 * kOneDeg); },
                   {"project.yaml", "arm_left_2_joint", "12.00", "rest_deg"});
}

}  // namespace
}  // namespace elastocal
