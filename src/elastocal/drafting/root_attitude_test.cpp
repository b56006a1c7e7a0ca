// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/root_attitude.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/drafting/body_shapes.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/test_files.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

struct ReadRobot {
  std::string urdf;
  RobotTree tree;
  RobotShapes shapes;
};

ReadRobot Read(const std::string& urdf) {
  ReadRobot robot{urdf, ParseUrdf(urdf, "robot.urdf"), {}};
  robot.shapes = ReadBodyShapes(robot.tree, urdf, "robot.urdf", {});
  return robot;
}

std::optional<RootAttitude> AttitudeOf(const ReadRobot& robot) {
  return FindRootAttitude(robot.tree, robot.shapes, {});
}

std::vector<std::string> LimbNames(const ReadRobot& robot) {
  std::vector<std::string> names;
  for (const Limb& limb : FindLimbs(robot.tree, robot.shapes, {}).limbs) names.push_back(limb.name);
  return names;
}

/// The URDF with names of which no word tells a side, and no other one than `kept` a limb; its feet
/// reach as far back as ahead, so that knees alone tell what is ahead.
std::string Nameless(std::string urdf, const std::string& kept = "") {
  for (const std::string word : {"left", "right", "arm", "leg", "gripper", "sole"}) {
    if (word == kept) continue;
    const std::string other(word.rbegin(), word.rend());
    for (std::size_t at = 0; (at = urdf.find(word, at)) != std::string::npos; at += word.size()) {
      urdf.replace(at, word.size(), other);
    }
  }
  return urdf;
}

void ExpectFound(const ReadRobot& plain, const Transform& T_root_plain) {
  const ReadRobot cad = Read(AddRootLink(plain.urdf, plain.tree, {T_root_plain, "cad"}));
  const auto attitude = AttitudeOf(cad);
  ASSERT_TRUE(attitude);
  const Transform off = attitude->T_new_root * T_root_plain;  // as the plain robot is, but along x
  EXPECT_LT((off.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-3);
  EXPECT_LT(std::abs(off.translation().y()), 1e-3);
  const ReadRobot mended = Read(AddRootLink(cad.urdf, cad.tree, *attitude));
  EXPECT_EQ(LimbNames(mended), LimbNames(plain));
  EXPECT_FALSE(AttitudeOf(mended));
}

// The embedded humanoid as CAD programs may export it: it looks along y or between the axes, or the
// root link is beside its middle.
TEST(RootAttitude, OfAHumanoidThatLooksElsewhere) {
  const ReadRobot plain = Read(Nameless(ReadFile(SourceFile("models/talos/talos.urdf"))));
  EXPECT_FALSE(AttitudeOf(plain));
  for (const Transform& T_root_plain :
       {RotZ(M_PI / 2.0), RotZ(-M_PI / 2.0), RotZ(0.7), Offset(0.0, 0.3, 0.0)}) {
    ExpectFound(plain, T_root_plain);
  }
}

// It stands along y or x, or hangs along z. Names have to tell which limbs are legs.
TEST(RootAttitude, OfAHumanoidThatStandsElsewhere) {
  const std::string urdf = ReadFile(SourceFile("models/talos/talos.urdf"));
  const ReadRobot plain = Read(Nameless(urdf, "leg")), nameless = Read(Nameless(urdf));
  EXPECT_FALSE(AttitudeOf(plain));
  for (const Transform& T_root_plain :
       {RotX(-M_PI / 2.0), RotX(M_PI / 2.0), RotX(-M_PI / 2.0) * RotZ(M_PI / 2.0),
        RotX(M_PI) * RotZ(M_PI / 2.0), RotX(M_PI), RotY(M_PI / 2.0), RotY(-M_PI / 2.0)}) {
    ExpectFound(plain, T_root_plain);
    EXPECT_FALSE(
        AttitudeOf(Read(AddRootLink(nameless.urdf, nameless.tree, {T_root_plain, "cad"}))));
  }
}

/// A joint with its child link.
std::string JointTo(const std::string& parent, const std::string& joint, const std::string& child,
                    const Eigen::Vector3d& at, bool fixed = false) {
  return "<link name='" + child + "'><inertial><mass value='1'/><inertia ixx='0.01' ixy='0' " +
         "ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial></link><joint name='" + joint +
         "' type='" + (fixed ? "fixed" : "revolute") + "'><parent link='" + parent +
         "'/><child link='" + child + "'/><origin xyz='" + std::to_string(at.x()) + " " +
         std::to_string(at.y()) + " " + std::to_string(at.z()) +
         "'/><axis xyz='0 1 0'/><limit lower='-1' upper='1' effort='50' velocity='2'/></joint>";
}

std::string Chain(const std::string& parent, const std::string& name, const Eigen::Vector3d& at,
                  const Eigen::Vector3d& step, int joints) {
  std::string text, before = parent;
  for (int k = 1; k <= joints; ++k) {
    const std::string link = name + "_link_" + std::to_string(k);
    text += JointTo(before, name + "_joint_" + std::to_string(k), link, k == 1 ? at : step);
    before = link;
  }
  return text + JointTo(before, name + "_joint_ee", name + "_link_ee", 0.5 * step, true);
}

std::string Robot(const std::string& parts) {
  return "<robot name='r'><link name='base'/>" + parts + "</robot>";
}

// Two arms of seven joints, which point up at zero. They are the legs of nothing that hangs.
TEST(RootAttitude, OfTwoArmsOnATableStaysAsItIs) {
  const Eigen::Vector3d up(0.0, 0.0, 0.2);
  for (const Eigen::Vector3d& second :
       {Eigen::Vector3d(0.0, 0.8, 0.0), Eigen::Vector3d(0.0, -0.8, 0.0),
        Eigen::Vector3d(0.8, 0.0, 0.0), Eigen::Vector3d(0.5, 0.5, 0.0)}) {
    for (const Eigen::Vector3d& step : {up, Eigen::Vector3d(0.2, 0.0, 0.0)}) {
      EXPECT_FALSE(AttitudeOf(Read(Robot(Chain("base", "left", {0.0, 0.0, 0.0}, step, 7) +
                                         Chain("base", "right", second, step, 7)))))
          << second.transpose() << ", " << step.transpose();
    }
  }
}

// An upper body that looks along y: only a head tells that two arms are those of one body.
TEST(RootAttitude, OfArmsNeedsAHeadAndSides) {
  const auto found = [](const std::string& left, const std::string& right, const char* third) {
    const Eigen::Vector3d hang(0.0, 0.0, -0.1);
    return AttitudeOf(Read(Robot(Chain("base", left, {-0.2, 0.0, 1.0}, hang, 6) +
                                 Chain("base", right, {0.2, 0.0, 1.0}, hang, 6) +
                                 Chain("base", third, {0.0, 0.0, 1.1}, -hang, 2))));
  };
  const auto attitude = found("left_arm", "right_arm", "head");
  ASSERT_TRUE(attitude);
  EXPECT_LT((attitude->T_new_root.linear() - RotZ(-M_PI / 2.0).linear()).norm(), 1e-6);
  EXPECT_FALSE(found("left_arm", "right_arm", "camera"));
  EXPECT_FALSE(found("one_arm", "other_arm", "head"));
}

// Front and hind legs are mirror images as well as left and right ones, and so are opposite ones of
// two corners.
TEST(RootAttitude, OfFourLegsIsThatOfAnyOrderInTheUrdf) {
  const std::vector<std::string> orders[] = {
      {"FL", "FR", "HL", "HR"}, {"FL", "HL", "FR", "HR"}, {"FL", "HR", "FR", "HL"}};
  for (const std::vector<std::string>& order : orders) {
    std::string legs;
    for (const std::string& leg : order) {
      const Eigen::Vector3d hip(leg[0] == 'F' ? 0.3 : -0.3, leg[1] == 'L' ? 0.2 : -0.2, 0.0);
      legs += Chain("base", leg, RotZ(0.5) * hip, {0.0, 0.0, -0.25}, 3);
    }
    const auto attitude = AttitudeOf(Read(Robot(legs)));
    ASSERT_TRUE(attitude) << order[0] << order[1];
    EXPECT_LT((attitude->T_new_root.linear() - RotZ(-0.5).linear()).norm(), 1e-5);
  }
}

// Names of links and joints are different kinds of names, and both are unique.
TEST(RootAttitude, TheNewJointHasANameOfItsOwn) {
  const std::string urdf = Robot(Chain("base", "a", {0.0, 0.0, 0.0}, {0.0, 0.0, 0.2}, 2) +
                                 JointTo("base", "looks_ahead_fixed", "b", {0.0, 0.0, 0.1}));
  const RootAttitude attitude{RotZ(1.0), "looks_ahead"};
  const RobotTree tree = ParseUrdf(urdf, "robot.urdf");
  const std::string text = AddRootLink(urdf, tree, attitude);
  EXPECT_NE(text.find("\"looks_ahead_fixed_2\""), std::string::npos);
  EXPECT_EQ(ParseUrdf(text, "robot.urdf").joints.size(), tree.joints.size());
}

}  // namespace
}  // namespace elastocal
