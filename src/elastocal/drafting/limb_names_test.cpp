// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/limb_names.hpp"

#include <regex>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/draft_files.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

/// The side of an arm of two joints with these names and a tip that is called "hand".
int SideOf(const std::string& first, const std::string& second) {
  RobotTree tree = PlanarArm();
  tree.joints[0].name = first;
  tree.joints[1].name = second;
  Limb limb;
  limb.joints = {0, 1};
  limb.from_body = 0;
  limb.tip_body = 2;
  limb.tip_link = tree.joints[1].child_link;
  tree.links[Size(limb.tip_link)].name = "hand";
  return SideByNames(tree, limb);
}

TEST(LimbNames, TellTheSideInTheWaysThatUrdfsDo) {
  for (const char* left : {"left_knee", "leg_left_3_joint", "LKneePitch", "l_knee", "knee_l",
                           "FL_calf_joint", "LF_KFE", "RL_hip", "LeftKnee", "kneeLeft"}) {
    EXPECT_EQ(SideOf(left, "elbow"), 1) << left;
  }
  for (const char* right : {"right_knee", "RKneePitch", "r_knee", "knee_r", "RR_hip", "RH_KFE"}) {
    EXPECT_EQ(SideOf(right, "elbow"), -1) << right;
  }
  // Links with numbers, words that only begin with l or r, and names that contradict each other.
  for (const char* none : {"l1", "lift", "roll", "Rail", "lower", "elbow"}) {
    EXPECT_EQ(SideOf(none, "elbow"), 0) << none;
  }
  EXPECT_EQ(SideOf("l_knee", "r_knee"), 0);
}

TEST(LimbNames, AHeadSaysSoAndALegToo) {
  const auto name = [](const std::string& first, const std::string& tip, std::size_t joints) {
    RobotTree tree = PlanarArm();
    tree.joints[0].name = first;
    Limb limb;
    limb.joints.assign(joints, 0);
    limb.tip_link = tree.joints[1].child_link;
    tree.links[Size(limb.tip_link)].name = tip;
    return NameLimb(tree, {limb, limb}, limb);
  };
  EXPECT_EQ(name("lowerNeckPitch", "camera", 4), "head");
  EXPECT_EQ(name("yaw", "head_camera", 4), "head");
  EXPECT_EQ(name("shoulder", "camera", 4), "arm");
  EXPECT_EQ(name("KneePitch", "base", 3), "leg");
  EXPECT_EQ(name("yaw", "camera", 3), "head");
}

TEST(LimbNamesStudy, SidesAreThoseOfTheNames) {
  // The embedded robot, turned about so that its root link looks backwards.
  std::string urdf = ReadFile(SourceFile("models/talos/talos.urdf"));
  urdf = std::regex_replace(urdf, std::regex("left"), "other");
  urdf = std::regex_replace(urdf, std::regex("right"), "left");
  urdf = std::regex_replace(urdf, std::regex("other"), "right");
  const ProjectDraft draft = DraftProject(urdf, "talos.urdf", {});
  int sides = 0;
  for (const Limb& limb : draft.limbs.limbs) {
    if (limb.mirror < 0) continue;
    ++sides;
    const std::string side = limb.name.substr(0, limb.name.find('_'));
    EXPECT_NE(draft.tree.links[Size(limb.tip_link)].name.find(side), std::string::npos)
        << limb.name;
  }
  EXPECT_EQ(sides, 4);
}

}  // namespace
}  // namespace elastocal
