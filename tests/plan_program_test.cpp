// SPDX-License-Identifier: Apache-2.0
// The command `plan`, from a posture file to a motion that `simulate` can play.

#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/files/output_files.hpp"
#include "elastocal/io/motion_file.hpp"
#include "elastocal/planning/planned_motion_file.hpp"
#include "tests/arm_posture.hpp"
#include "tests/run_program.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

const std::string kPostures =
    kPostureOfArm +
    std::string(R"(      - {arm_left_1_joint: 0.3, arm_left_2_joint: 0.3, arm_left_4_joint: -1.9}
      - {arm_left_1_joint: 0.3, arm_left_2_joint: 0.3, arm_left_3_joint: -1.57, arm_left_4_joint: -1.9}
  - name: leg_left
    support: [right_sole_link]
    postures:
      - {leg_left_1_joint: 0.2, leg_left_3_joint: -0.9, leg_left_4_joint: 1.2}
)");

class Plan : public testing::Test {
 protected:
  std::string Path(const std::string& name) const { return (scratch_.path() / name).string(); }

  ProgramResult Run(const std::string& more) const {
    return RunProgram("plan " + SourceFile("models/talos/project.yaml").string() + " -o " +
                      Path("motion.csv") + " " + more);
  }

  /// The TALOS project without the design of its legs.
  std::string WithoutLegs() {
    std::string text = ReadFile(SourceFile("models/talos/project.yaml"));
    const auto begin = text.find("    - chain: leg_left"), end = text.find("    - chain: arm_left");
    EXPECT_LT(begin, end);
    text.erase(begin, end - begin);
    const std::string urdf = "urdf: talos.urdf";
    text.replace(text.find(urdf), urdf.size(),
                 "urdf: " + SourceFile("models/talos/talos.urdf").string());
    return scratch_.Write("project.yaml", text);
  }

  ScratchFolder scratch_;
};

TEST_F(Plan, WritesAMotionAndLeavesOutWhatWouldCollide) {
  const std::string postures = scratch_.Write("postures.yaml", kPostures);
  const ProgramResult result = Run("--postures " + postures + " --trajectory " +
                                   Path("trajectory.yaml") + " --json " + Path("plan.json"));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("arm_left, posture 3 is left out: clearance"), std::string::npos)
      << result.err;
  EXPECT_NE(result.out.find("zero-moment point to edge, mm"), std::string::npos) << result.out;
  const auto json = nlohmann::json::parse(ReadFile(Path("plan.json")));
  EXPECT_EQ(json["sets"][0]["visits"].size(), 2u);
  EXPECT_EQ(json["sets"][1]["visits"].size(), 1u);
  EXPECT_GE(json["margins"]["zmp_m"], 0.015);
  EXPECT_LT(json["margins"]["foot_moved_m"], 1e-6);

  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const JointMotion motion = ReadMotion(Path("motion.csv"), project);
  EXPECT_EQ(motion.q.row(0), motion.q.row(motion.q.rows() - 1));
  const std::vector<int> right = {FindLink(project.tree, "right_sole_link")};
  EXPECT_EQ(motion.support.front().size(), 2u);
  EXPECT_NE(std::find(motion.support.begin(), motion.support.end(), right), motion.support.end());
  const std::string trajectory = ReadFile(Path("trajectory.yaml"));
  EXPECT_NE(trajectory.find("joint_names:\n  - torso_1_joint\n"), std::string::npos);
  EXPECT_NE(trajectory.find("time_from_start: {sec: 1, nanosec: 50000000}"), std::string::npos);
}

TEST_F(Plan, SaysWhichConstraintMakesItImpossible) {
  const std::string postures = scratch_.Write("postures.yaml", kPostures);
  const ProgramResult result = Run("--postures " + postures + " --torque-share 0.1");
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_NE(result.err.find("joint torque limit"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(Path("motion.csv")));
}

TEST_F(Plan, WritesNoMotionThatBreaksItsLimitsAndSaysWhich) {
  // All sines are left out, and a wrist of the robot at rest needs 19 % of its torque. Legs are not
  // in the project, because they could not even be lifted.
  const ProgramResult refused = RunProgram("plan " + WithoutLegs() + " -o " + Path("motion.csv") +
                                           " --kind sine --torque-share 0.1");
  EXPECT_EQ(refused.exit_code, 4) << refused.out;
  EXPECT_NE(refused.err.find("the motion breaks a limit: torque, % of limit: 19 at 0.00 s (arm_"),
            std::string::npos)
      << refused.err;
  EXPECT_NE(refused.err.find("the limit is 10"), std::string::npos) << refused.err;
  EXPECT_EQ(refused.out.find("Written"), std::string::npos) << refused.out;
  for (const char* name : {"motion.csv", "motion_margins.json", "report.html"}) {
    EXPECT_FALSE(std::filesystem::exists(Path(name))) << name;
  }
}

TEST_F(Plan, RefusesSharesAboveOneAndOutputsThatMeet) {
  const std::string postures = scratch_.Write("postures.yaml", kPostures);
  const auto refused = [&](const std::string& more, int exit_code, const std::string& part) {
    const ProgramResult result = Run("--postures " + postures + " " + more);
    EXPECT_EQ(result.exit_code, exit_code) << more << "\n" << result.out;
    EXPECT_NE((result.out + result.err).find(part), std::string::npos) << result.out << result.err;
    EXPECT_FALSE(std::filesystem::exists(Path("motion.csv")));
  };
  refused("--torque-share 80", 2, "--torque-share");
  refused("--velocity-share 0", 2, "--velocity-share");
  refused("--zmp-margin-mm -10", 2, "--zmp-margin-mm");
  refused("--json " + postures, 3, "postures.yaml");
  refused("--json " + Path("motion.csv"), 3, "motion.csv");
  refused("--json " + Path("motion_margins.json"), 3, "motion_margins.json");
  refused("--trajectory " + Path("motion.csv"), 3, "motion.csv");
  EXPECT_EQ(ReadFile(postures), kPostures);
}

// For the trial `leg_left`, `simulate` writes the joint log leg_left.csv.
TEST_F(Plan, MotionsOfChainsAreNotNamedLikeJointLogs) {
  const std::string postures = scratch_.Write("postures.yaml", kPostures);
  std::filesystem::create_directory(Path("chains"));
  const std::string log = scratch_.Write("chains/leg_left.csv", "t,leg_left_1_joint\n0,0\n");
  const std::string more = "--postures " + postures + " --per-chain " + Path("chains");
  ASSERT_EQ(Run(more).exit_code, 0);
  EXPECT_EQ(ReadFile(log), "t,leg_left_1_joint\n0,0\n");
  EXPECT_TRUE(std::filesystem::exists(Path("chains/leg_left_motion.csv")));
  EXPECT_EQ(Run(more).exit_code, 0) << "an earlier motion is replaced";

  const std::string other = scratch_.Write("chains/arm_left_motion.csv", "t,leg\n0,0\n");
  const ProgramResult refused = Run(more);
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("arm_left_motion.csv"), std::string::npos) << refused.err;
  EXPECT_EQ(ReadFile(other), "t,leg\n0,0\n");
}

// A joint log begins with the time, as a planned motion does.
TEST_F(Plan, ReplacesMotionsButNoJointLog) {
  const std::string postures = scratch_.Write("postures.yaml", kPostures);
  const std::string log = "time,leg_left_1_joint\n0,0\n0.01,0\n";
  scratch_.Write("motion.csv", log);
  const std::string more = "--quiet --postures " + postures;
  const ProgramResult refused = Run(more);
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("motion.csv"), std::string::npos) << refused.err;
  EXPECT_EQ(ReadFile(Path("motion.csv")), log);

  std::filesystem::remove(Path("motion.csv"));
  ASSERT_EQ(Run(more).exit_code, 0);
  EXPECT_EQ(Run(more).exit_code, 0) << "its own motion is replaced";
  // `compensate` leaves out columns that its motion has not.
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  PlannedMotion bare;
  bare.motion = ReadMotion(Path("motion.csv"), project);
  bare.motion.support.clear();
  scratch_.Write("motion.csv", FormatMotionTable(project.tree, bare));
  EXPECT_EQ(Run(more).exit_code, 0) << "a motion of compensate is replaced";
}

TEST_F(Plan, ValidationMotionsNeedTheSectionDesign) {
  const ProgramResult refused =
      RunProgram("plan " + SourceFile("tests/robots/arm6_project.yaml").string() + " -o " +
                 Path("motion.csv") + " --kind random");
  EXPECT_EQ(refused.exit_code, 3) << refused.out;
  EXPECT_NE(refused.err.find("no section 'design' with 'chains'"), std::string::npos)
      << refused.err;
  EXPECT_FALSE(std::filesystem::exists(Path("motion.csv")));
}

TEST_F(Plan, RefusesBadInput) {
  EXPECT_EQ(Run("").exit_code, 2);
  const std::string none = scratch_.Write("none.yaml",
                                          "robot: talos\nchains: [{name: arm_left, support: "
                                          "[base_link], postures: [{arm_left_4_joint: -1}]}]\n");
  const ProgramResult result = Run("--postures " + none);
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("base_link"), std::string::npos) << result.err;
}

TEST_F(Plan, StandsOnOneFootAndFallsWithoutBalance) {
  // One posture of a leg, on a robot with errors and flexible legs whose feet lie on the floor.
  // docs/accuracy.md has the whole motion.
  const std::string postures = scratch_.Write(
      "leg.yaml",
      "robot: talos\nchains: [{name: leg_left, support: [right_sole_link], postures: "
      "[{leg_left_1_joint: 0.2, leg_left_3_joint: -1.3, leg_left_4_joint: 1.9}]}]\n");
  const auto stands = [&](const std::string& more) {
    const ProgramResult result =
        Run("--postures " + postures + " --robots 1 --seed 4 --json " + Path("plan.json") + more);
    const nlohmann::json json = nlohmann::json::parse(ReadFile(Path("plan.json")));
    const bool stood = json["tries"][0]["stood"].get<bool>();
    EXPECT_EQ(result.exit_code, stood ? 0 : 4) << result.err;
    // When a sole touches the floor, it is on its edge for a moment without tipping the robot over.
    EXPECT_EQ(json["tries"][0]["least_zmp_margin"].get<double>() > 0.01, stood);
    return stood;
  };
  EXPECT_TRUE(stands(""));
  EXPECT_FALSE(stands(" --no-balance"));
}

TEST_F(Plan, PlansValidationMotions) {
  const ProgramResult result = Run("--kind repeatability --json " + Path("plan.json"));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(ReadFile(Path("plan.json")));
  ASSERT_EQ(json["sets"].size(), 5u);
  for (const auto& set : json["sets"]) EXPECT_EQ(set["visits"].size(), 5u) << set["name"];
}

}  // namespace
}  // namespace elastocal
