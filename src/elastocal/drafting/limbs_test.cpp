// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/limbs.hpp"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/drafting/draft.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

std::string LinkText(const std::string& name) {
  return "<link name='" + name +
         "'><inertial><mass value='1'/><inertia ixx='0.01' ixy='0' ixz='0' "
         "iyy='0.01' iyz='0' izz='0.01'/></inertial></link>";
}

std::string JointText(const std::string& parent, const std::string& child, const std::string& more,
                      const std::string& xyz = "0 0 0.1") {
  return LinkText(child) + "<joint name='" + child + "_joint' type='revolute'><parent link='" +
         parent + "'/><child link='" + child + "'/><origin xyz='" + xyz +
         "'/><axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='50' velocity='2'/>" + more +
         "</joint>";
}

/// A trunk with two arms and a neck of three joints, of which the second follows the first.
std::string RobotWithNeck(bool with_pan) {
  std::string text = "<robot name='r'>" + LinkText("base") + JointText("base", "waist", "") +
                     JointText("waist", "trunk", "");
  for (const std::string side : {"l", "r"}) {
    const std::string y = side == "l" ? "0.2" : "-0.2";
    text += JointText("trunk", side + "_shoulder", "", "0 " + y + " 0.4") +
            JointText(side + "_shoulder", side + "_elbow", "", "0 0 -0.4") +
            JointText(side + "_elbow", side + "_wrist", "", "0 0 -0.4");
  }
  text += JointText("trunk", "lower_neck", "", "0 0 0.45") +
          JointText("lower_neck", "upper_neck",
                    "<mimic joint='lower_neck_joint' multiplier='0.5'/>", "0 0 0.08");
  if (with_pan) text += JointText("upper_neck", "head", "", "0 0 0.05");
  return text + "</robot>";
}

std::string EndOfNeck(const std::string& urdf) {
  const ProjectDraft draft = DraftProject(urdf, "r.urdf", {});
  for (const Limb& limb : draft.limbs.limbs) {
    const std::string& tip = draft.tree.links[Size(limb.tip_link)].name;
    if (tip.find("neck") != std::string::npos || tip == "head") return tip;
  }
  return "";
}

/// A trunk that is `trunk_m` above the root link, with two limbs that hang from it and a head. The
/// links are called side + "_" + `name` + "1" and so on.
std::string UpperBody(double trunk_m, double head_m, const std::string& name = "") {
  std::string text = "<robot name='r'>" + LinkText("base") +
                     JointText("base", "trunk", "", "0 0 " + std::to_string(trunk_m));
  for (const std::string side : {"l", "r"}) {
    const std::string y = side == "l" ? "0.2" : "-0.2";
    const std::string limb = side + "_" + name;
    text += JointText("trunk", limb + "1", "", "0 " + y + " 0") +
            JointText(limb + "1", limb + "2", "", "0 0 -0.35") +
            JointText(limb + "2", limb + "3", "", "0 0 -0.35");
  }
  return text + JointText("trunk", "head", "", "0 0 " + std::to_string(head_m)) + "</robot>";
}

int CountLegs(const std::string& urdf) {
  const ProjectDraft draft = DraftProject(urdf, "r.urdf", {});
  return static_cast<int>(std::count_if(draft.limbs.limbs.begin(), draft.limbs.limbs.end(),
                                        [](const Limb& limb) { return limb.leg; }));
}

TEST(Limbs, ArmsThatEndLowestAreNoLegs) {
  EXPECT_EQ(CountLegs(UpperBody(0.35, 0.1)), 0) << "shoulders above the root link";
  EXPECT_EQ(CountLegs(UpperBody(-0.1, 0.5)), 2) << "hips";
  EXPECT_EQ(CountLegs(UpperBody(0.0, 0.1, "arm_")), 0) << "shoulders level with the root link";
  EXPECT_EQ(CountLegs(UpperBody(-0.1, 0.5, "leg_arm_")), 2) << "a rocker arm of a leg";
}

// The draft gets a root link that looks ahead.
TEST(Limbs, OfARobotThatLooksAlongYAreFound) {
  std::string urdf = UpperBody(-0.1, 0.5);
  urdf.insert(urdf.rfind("</robot>"),
              "<link name='cad'/><joint name='cad_fixed' type='fixed'><parent link='cad'/><child "
              "link='base'/><origin rpy='0 0 1.5708'/></joint>");
  EXPECT_EQ(CountLegs(urdf), 2);
}

TEST(Limbs, GoOnBehindAJointThatFollows) {
  EXPECT_EQ(EndOfNeck(RobotWithNeck(true)), "head");
  // Like a finger, the limb ends with the joint that follows: no link behind it moves by itself.
  EXPECT_EQ(EndOfNeck(RobotWithNeck(false)), "lower_neck");
}

// A forearm that ends in a gripper, without a wrist: its fingers are far from the elbow.
TEST(Limbs, FingersOnALongForearmAreNoLimbs) {
  std::string urdf = UpperBody(0.35, 0.1);
  for (const std::string side : {"l", "r"}) {
    const std::string a = side + "_dito_a", b = side + "_dito_b", forearm = side + "_3";
    urdf.insert(urdf.rfind("</robot>"),
                JointText(forearm, a, "", "0 0.02 -0.45") +
                    JointText(forearm, b, "<mimic joint='" + a + "_joint' multiplier='-1'/>",
                              "0 -0.02 -0.45"));
  }
  EXPECT_EQ(DraftProject(urdf, "r.urdf", {}).limbs.limbs.size(), 3u) << "two arms and a head";
}

// The tarsus of Cassie (agility_cassie, version 4): the spring of its heel and its foot part there,
// 0.42 m apart. Halves of that would be short enough for fingers.
TEST(Limbs, AFootFarFromASpringIsNoFinger) {
  std::string text = "<robot name='r'>" + LinkText("pelvis");
  for (const std::string side : {"left", "right"}) {
    const std::string y = side == "left" ? "0.13" : "-0.13";
    text += JointText("pelvis", side + "_hip_roll", "", "0 " + y + " 0") +
            JointText(side + "_hip_roll", side + "_hip_yaw", "", "-0.09 0 0") +
            JointText(side + "_hip_yaw", side + "_hip_pitch", "", "0 0 -0.09") +
            JointText(side + "_hip_pitch", side + "_knee", "", "0 0 -0.12") +
            JointText(side + "_knee", side + "_tarsus", "", "0.04 0 -0.435") +
            JointText(side + "_tarsus", side + "_spring", "", "-0.013 0 -0.031") +
            JointText(side + "_tarsus", side + "_foot", "", "0.408 0 -0.04");
  }
  const RobotTree tree = ParseUrdf(text + "</robot>", "r.urdf");
  const Limbs found = FindLimbs(tree, ReadBodyShapes(tree, text + "</robot>", "r.urdf", {}), {});
  EXPECT_EQ(std::count(found.tool.begin(), found.tool.end(), true), 0);
}

// To place a foot takes five joints, of which the waist is none: it moves both legs.
TEST(Limbs, ToesAreTakenWhereJointsOfTheLegAreEnough) {
  const auto toes = [](int joints_of_leg) {
    std::string text = "<robot name='r'>" + LinkText("base") + JointText("base", "head", "") +
                       JointText("base", "waist", "", "0 0 -0.05");
    for (const std::string side : {"l", "r"}) {
      const std::string leg = side + "_leg_";
      text += JointText("waist", leg + "1", "", side == "l" ? "0 0.1 0" : "0 -0.1 0");
      for (int k = 2; k <= joints_of_leg; ++k) {
        text += JointText(leg + std::to_string(k - 1), leg + std::to_string(k), "", "0 0 -0.25");
      }
      const std::string foot = leg + std::to_string(joints_of_leg);
      text += JointText(foot, side + "_dedo", "", "0.1 0 0") + LinkText(side + "_sole") +
              "<joint name='" + side + "_fixed' type='fixed'><parent link='" + foot +
              "'/><child link='" + side + "_sole'/></joint>";
    }
    text += "</robot>";
    const RobotTree tree = ParseUrdf(text, "r.urdf");
    return FindLimbs(tree, ReadBodyShapes(tree, text, "r.urdf", {}), {}).toes.size();
  };
  EXPECT_EQ(toes(4), 0u);
  EXPECT_EQ(toes(5), 2u);
}

// Of two fingers on a foot nothing tells that they are toes, on which the leg would have ended.
TEST(Limbs, FingersOnAFootAreNotCalledToes) {
  std::string urdf = UpperBody(-0.1, 0.5, "leg_");
  for (const std::string side : {"l", "r"}) {
    const std::string foot = side + "_leg_3";
    urdf.insert(urdf.rfind("</robot>"), JointText(foot, side + "_a", "", "0.05 0.02 0") +
                                            JointText(foot, side + "_b", "", "0.05 -0.02 0"));
  }
  const ProjectDraft draft = DraftProject(urdf, "r.urdf", {});
  EXPECT_EQ(std::count(draft.limbs.tool.begin(), draft.limbs.tool.end(), true), 4);
  for (const std::string& warning : draft.warnings) {
    EXPECT_EQ(warning.find("toes"), std::string::npos) << warning;
  }
}

}  // namespace
}  // namespace elastocal
