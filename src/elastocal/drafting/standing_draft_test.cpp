// SPDX-License-Identifier: Apache-2.0
// Drafting robots that stand on their feet.
#include "elastocal/drafting/standing_draft.hpp"

#include <algorithm>
#include <cmath>
#include <regex>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/motion/standing_robot.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/draft_files.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

TEST(StandingDraftStudy, MissingMassesAreNamed) {
  const std::string urdf = ReadFile(SourceFile("tests/robots/quadruped.urdf"));
  const std::regex mass(R"(<mass value="[^"]*")");
  const ProjectDraft none =
      DraftProject(std::regex_replace(urdf, mass, R"(<mass value="0")"), "q.urdf", {});
  EXPECT_FALSE(none.stands);
  EXPECT_EQ(none.held_because.find("the robot description has no masses"), 0u) << none.held_because;
  EXPECT_TRUE(std::ranges::any_of(none.warnings, [](const std::string& warning) {
    return warning.find("no masses") != std::string::npos;
  }));
}

TEST(StandingDraftStudy, AQuadrupedStandsOnBalls) {
  const ProjectDraft draft = DraftFile("tests/robots/quadruped.urdf");
  EXPECT_TRUE(draft.stands);
  const ScratchFolder folder;
  const Project project = ReadBack(draft, folder);
  ASSERT_EQ(project.soles.size(), 4u);
  for (const Sole& sole : project.soles) EXPECT_NEAR(sole.ball_radius.value(), 0.022, 1e-9);
  for (const ChainSetup& setup : project.motion.chains) {
    EXPECT_EQ(setup.support.size(), 3u) << setup.name;
  }
  StandingRobot robot(project.tree, project.soles, {});
  StandUp(robot, project.motion.rest, {});
  for (const int foot : robot.AllFeet()) {
    EXPECT_NEAR(robot.T_world_sole[Size(foot)].translation().z(), 0.022, 1e-12);
    // Any three feet put the root link where all feet put it.
    const Transform T = RootOverFeet(robot, robot.AllFeetBut(foot), robot.rest);
    EXPECT_LT((T.matrix() - robot.T_world_root.matrix()).norm(), 1e-9);
  }
  // A third of the least height of the triangle of three feet, whose sides are 0.48 m and 0.32 m.
  EXPECT_NEAR(robot.half_support, 0.48 * 0.32 / std::hypot(0.48, 0.32) / 3.0, 2e-3);
}

// Berkeley's small humanoid is such a robot.
TEST(StandingDraftStudy, TheRootLinkMayBeAFrameOnTheFloor) {
  std::string urdf = ReadFile(SourceFile("models/talos/talos.urdf"));
  const ProjectDraft usual = DraftProject(urdf, "talos.urdf", {});
  urdf.insert(urdf.find("<link"), R"(<link name="floor"/><joint name="up" type="fixed">
      <parent link="floor"/><child link="base_link"/><origin xyz="0 0 1.08305"/></joint>)");
  const ProjectDraft draft = DraftProject(urdf, "talos.urdf", {});
  ASSERT_EQ(draft.tree.links.front().name, "floor");
  EXPECT_TRUE(draft.stands) << draft.held_because;
  ASSERT_EQ(draft.limbs.limbs.size(), usual.limbs.limbs.size());
  for (std::size_t i = 0; i < draft.limbs.limbs.size(); ++i) {
    EXPECT_EQ(draft.limbs.limbs[i].name, usual.limbs.limbs[i].name);
    EXPECT_EQ(draft.limbs.limbs[i].leg, usual.limbs.limbs[i].leg);
  }
  EXPECT_EQ(draft.stance.has_value(), usual.stance.has_value());
  // The legs are bent less, because they are measured from the hips, which are 0.27 m below the
  // usual root link.
  EXPECT_LT((draft.rest.q - usual.rest.q).cwiseAbs().maxCoeff(), 0.15);
}

// ANYmal is such a robot: its joints count turns, and its feet are not under the hips when the legs
// hang.
TEST(StandingDraftStudy, LegsBendAsFarAsStandingNeeds) {
  std::string urdf = ReadFile(SourceFile("tests/robots/quadruped.urdf"));
  for (const char* limits : {R"(lower="-1.2" upper="2.6")", R"(lower="-2.6" upper="0.1")"}) {
    ASSERT_NE(urdf.find(limits), std::string::npos);
    urdf = std::regex_replace(urdf, std::regex(limits), R"(lower="-9.4" upper="9.4")");
  }
  for (const char* side : {"left", "right"}) {
    for (const auto& [end, x] : {std::pair("front", "0.07"), std::pair("hind", "-0.07")}) {
      const std::string link = std::string(end) + "_" + side + "_foot\"/>";
      const std::size_t child = urdf.find("<child link=\"" + link);
      const std::size_t at = urdf.find("0 0 ", urdf.find("<origin", child));
      urdf.replace(at, 1, x);
    }
  }
  const ProjectDraft draft = DraftProject(urdf, "quadruped.urdf", {});
  ASSERT_TRUE(draft.stands) << draft.held_because;
  // A knee can bend in two ways. The legs take the way in which they bend further, towards each
  // other.
  const auto knee = [&](const std::string& leg) {
    for (const Joint& joint : draft.tree.joints) {
      if (joint.name == leg + "_knee") return draft.rest.q[joint.coordinate];
    }
    return 0.0;
  };
  EXPECT_GT(knee("front_left"), 0.8);
  EXPECT_LT(knee("hind_left"), -0.8);
  EXPECT_NEAR(knee("front_left"), -knee("hind_right"), 1e-3);
}

// REEM-C, Fourier N1 and Draco 3 are such robots: on one foot, their motors need 91 to 95 % of
// their efforts.
TEST(StandingDraftStudy, MotionsUseNearlyAllOfMotorsThatNeedIt) {
  const std::string urdf = ReadFile(SourceFile("tests/robots/quadruped.urdf"));
  const auto draft_with = [&](double effort) {
    return DraftProject(std::regex_replace(urdf, std::regex("effort=\"60\""),
                                           "effort=\"" + std::to_string(effort) + "\""),
                        "quadruped.urdf", {});
  };
  EXPECT_FALSE(draft_with(10.0).stands);  // three feet would need 104 %
  const ProjectDraft weakest = draft_with(11.0);
  ASSERT_TRUE(weakest.stands) << weakest.held_because;
  EXPECT_EQ(weakest.motion_effort_share, 0.97);
  EXPECT_TRUE(std::any_of(weakest.warnings.begin(), weakest.warnings.end(), [](const auto& text) {
    return text.find("use up to 97 % of the motors' efforts") != std::string::npos;
  }));
  const ScratchFolder folder;
  EXPECT_EQ(ReadBack(weakest, folder).motion.motion_effort_share, 0.97);
}

TEST(StandingDraftStudy, RestsWithEachFootLifted) {
  const ProjectDraft draft = DraftFile("tests/robots/quadruped.urdf");
  const std::vector<Eigen::VectorXd> postures = RestingPostures(draft);
  for (const DraftedSole& sole : draft.soles) {
    double highest = 0.0;
    for (const Eigen::VectorXd& q : postures) {
      const std::vector<Transform> poses = LinkTransforms(draft.tree, q);
      double others = 0.0;
      for (const DraftedSole& other : draft.soles) {
        others = std::max(others, -poses[Size(FindLink(draft.tree, other.link))].translation().z());
      }
      const double height = poses[Size(FindLink(draft.tree, sole.link))].translation().z();
      highest = std::max(highest, height + others);
    }
    EXPECT_GT(highest, 0.03) << sole.link;
  }
  const ScratchFolder folder;
  EXPECT_EQ(ReadBack(draft, folder).motion.effort_share, kDraftedEffort);
}

TEST(StandingDraft, FewerThanFourBallsAreRefused) {
  const ProjectDraft draft = DraftFile("tests/robots/quadruped.urdf");
  const ScratchFolder folder;
  folder.Write("robot.urdf", draft.urdf);
  std::string text = FormatDraft(draft, "robot.urdf");
  const std::string last = "    - {link: hind_right_foot, ball_radius_mm: 22}\n";
  text.erase(text.find(last), last.size());
  ExpectInputError([&] { ReadProject(folder.Write("project.yaml", text)); },
                   {"project.yaml", "four or more soles"});
}

}  // namespace
}  // namespace elastocal
