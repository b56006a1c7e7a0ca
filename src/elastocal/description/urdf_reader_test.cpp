// SPDX-License-Identifier: Apache-2.0
#include "elastocal/description/urdf_reader.hpp"

#include <cmath>
#include <limits>
#include <regex>

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"
#include "tests/test_files.hpp"
#include "tests/urdf_snippets.hpp"

namespace elastocal {
namespace {

TEST(UrdfReader, ReadsJoint) {
  const RobotTree tree = ParseLinks(
      LinkXml("a") + LinkXml("b") +
      JointXml("j", "revolute", "a", "b",
               std::string(kLimit) + "<origin xyz='1 2\t3' rpy=\"0 0 0.5\"/><axis xyz='0 0 -2'/>"));
  ASSERT_EQ(tree.joints.size(), 1u);
  const Joint& joint = tree.joints[0];
  EXPECT_EQ(tree.name, "r");
  EXPECT_EQ(joint.name, "j");
  EXPECT_EQ(joint.type, JointType::kRevolute);
  EXPECT_EQ(tree.links[joint.parent_link].name, "a");
  EXPECT_EQ(tree.links[joint.child_link].name, "b");
  EXPECT_TRUE(joint.axis.isApprox(-Eigen::Vector3d::UnitZ(), 1e-15));
  // The rotation passes through a quaternion, which costs a few roundings.
  EXPECT_TRUE(joint.T_parent_child.isApprox(FromXyzRpy({1, 2, 3}, {0, 0, 0.5}), 1e-15));
  EXPECT_EQ(joint.limits.lower, -1.0);
  EXPECT_EQ(joint.limits.upper, 2.0);
  EXPECT_EQ(joint.limits.effort, 30.0);
  EXPECT_EQ(joint.limits.velocity, 4.0);
  EXPECT_FALSE(joint.mimic);
}

TEST(UrdfReader, ContinuousJointHasNoPositionLimits) {
  const double infinity = std::numeric_limits<double>::infinity();
  const RobotTree tree = ParseLinks(LinkXml("a") + LinkXml("b") + LinkXml("c") +
                                    JointXml("with", "continuous", "a", "b") +
                                    JointXml("without", "continuous", "b", "c", ""));
  EXPECT_EQ(tree.joints[0].limits.lower, -infinity);
  EXPECT_EQ(tree.joints[0].limits.upper, infinity);
  EXPECT_EQ(tree.joints[0].limits.velocity, 4.0);
  EXPECT_EQ(tree.joints[1].limits.velocity, infinity);
  EXPECT_EQ(tree.joints[1].limits.effort, infinity);
  // The axis that URDF has by default.
  EXPECT_EQ(tree.joints[1].axis, Eigen::Vector3d::UnitX());
}

TEST(UrdfReader, TurnsInertiaIntoTheLinksAxes) {
  const RobotTree tree = ParseLinks(
      "<link name='a'><inertial><origin xyz='1 2 3' rpy='0 0 1.5707963267948966'/>"
      "<mass value='5'/><inertia ixx='1' iyy='2' izz='3' ixy='0.1' ixz='0.2' iyz='0.3'/>"
      "</inertial></link>");
  const elastocal::Link& link = tree.links[0];
  EXPECT_EQ(link.mass, 5.0);
  EXPECT_TRUE(link.com.isApprox(Eigen::Vector3d(1, 2, 3), 1e-15));
  // A quarter turn about z: the inertial frame's x is the link's y, its y the link's -x.
  Eigen::Matrix3d expected;
  expected << 2, -0.1, -0.3, -0.1, 1, 0.2, -0.3, 0.2, 3;
  EXPECT_TRUE(link.inertia.isApprox(expected, 1e-14));
}

TEST(UrdfReader, LinksOnFixedJointsAreOneBody) {
  const RobotTree tree = ParseLinks(
      LinkXml("tip") + LinkXml("flange") + LinkXml("arm") + LinkXml("mount") + LinkXml("base") +
      JointXml("tip_j", "fixed", "flange", "tip", "<origin xyz='0 0 2'/>") +
      JointXml("flange_j", "fixed", "arm", "flange", "<origin xyz='0 0 1'/>") +
      JointXml("arm_j", "revolute", "mount", "arm") +
      JointXml("mount_j", "fixed", "base", "mount", "<origin xyz='1 0 0' rpy='0 0 1'/>"));
  ASSERT_EQ(tree.body_count(), 2);
  EXPECT_EQ(tree.links[0].name, "base");
  const auto link = [&](const std::string& name) { return tree.links[FindLink(tree, name)]; };
  EXPECT_EQ(link("mount").body, 0);
  EXPECT_TRUE(link("mount").T_body_link.isApprox(FromXyzRpy({1, 0, 0}, {0, 0, 1}), 1e-15));
  EXPECT_EQ(link("arm").body, 1);
  EXPECT_TRUE(link("arm").T_body_link.isApprox(Transform::Identity()));
  EXPECT_EQ(link("tip").body, 1);
  EXPECT_EQ(link("tip").T_body_link.translation(), Eigen::Vector3d(0, 0, 3));
  EXPECT_EQ(tree.joints[0].parent_body, 0);
}

TEST(UrdfReader, JointsFollowTheFileAsFarAsTheTreeAllows) {
  // Joint b2 stands before the joint that carries it, and z before a: the order is neither
  // alphabetical nor by depth.
  const RobotTree tree =
      ParseLinks(LinkXml("root") + LinkXml("l1") + LinkXml("l2") + LinkXml("l3") + LinkXml("l4") +
                 JointXml("b2", "revolute", "l1", "l2") + JointXml("z", "revolute", "root", "l3") +
                 JointXml("b1", "revolute", "root", "l1") + JointXml("a", "revolute", "l3", "l4"));
  std::vector<std::string> names;
  for (const Joint& joint : tree.joints) names.push_back(joint.name);
  EXPECT_EQ(names, (std::vector<std::string>{"z", "b1", "b2", "a"}));
  EXPECT_EQ(tree.joints[2].parent_body, 2);
  EXPECT_EQ(tree.coordinate_joint, (std::vector<int>{0, 1, 2, 3}));
}

TEST(UrdfReader, MimicJointsShareACoordinate) {
  const RobotTree tree = ParseLinks(
      LinkXml("a") + LinkXml("b") + LinkXml("c") + LinkXml("d") +
      JointXml("second", "revolute", "a", "b",
               std::string(kLimit) + "<mimic joint='first' multiplier='3' offset='0.5'/>") +
      JointXml("first", "prismatic", "b", "c",
               std::string(kLimit) + "<mimic joint='driver' multiplier='-2' offset='0.25'/>") +
      JointXml("driver", "revolute", "c", "d"));
  ASSERT_EQ(tree.coordinate_count(), 1);
  EXPECT_EQ(tree.coordinate_joint[0], 2);
  // second = 3 (-2 q + 0.25) + 0.5
  EXPECT_TRUE(tree.joints[0].mimic);
  EXPECT_EQ(tree.joints[0].coordinate, 0);
  EXPECT_EQ(tree.joints[0].multiplier, -6.0);
  EXPECT_EQ(tree.joints[0].offset, 1.25);
  EXPECT_EQ(tree.joints[1].type, JointType::kPrismatic);
}

TEST(UrdfReader, FloatingRootIsLeftOut) {
  const RobotTree tree = ParseLinks(LinkXml("world") + LinkXml("waist") + LinkXml("leg") +
                                    JointXml("free", "floating", "world", "waist", "") +
                                    JointXml("hip", "revolute", "waist", "leg"));
  EXPECT_EQ(tree.links[0].name, "waist");
  EXPECT_EQ(tree.links.size(), 2u);
  ASSERT_EQ(tree.joints.size(), 1u);
  EXPECT_EQ(tree.joints[0].parent_body, 0);
}

void ExpectWarning(const RobotTree& tree, const std::string& part) {
  ASSERT_EQ(tree.warnings.size(), 1u);
  EXPECT_NE(tree.warnings[0].find(part), std::string::npos) << tree.warnings[0];
}

TEST(UrdfReader, VelocityAndEffortOfZeroAreNoLimitsWhereTheJointCanMove) {
  const auto parse = [](const std::string& ends) {
    return ParseLinks(
        LinkXml("a") + LinkXml("b") +
        JointXml("finger", "revolute", "a", "b", "<limit " + ends + " velocity='0' effort='0'/>"));
  };
  const RobotTree moves = parse("lower='0' upper='1'");
  EXPECT_TRUE(std::isinf(moves.joints[0].limits.velocity));
  EXPECT_TRUE(std::isinf(moves.joints[0].limits.effort));
  ASSERT_EQ(moves.warnings.size(), 2u);
  EXPECT_NE(moves.warnings[0].find("'finger': its velocity limit is 0"), std::string::npos);
  EXPECT_NE(moves.warnings[1].find("'finger': its effort limit is 0"), std::string::npos);
  const RobotTree wheel =
      ParseLinks(LinkXml("a") + LinkXml("b") +
                 JointXml("wheel", "continuous", "a", "b", "<limit velocity='0' effort='1'/>"));
  EXPECT_TRUE(std::isinf(wheel.joints[0].limits.velocity));
  EXPECT_EQ(wheel.joints[0].limits.effort, 1.0);
  const RobotTree rigid = parse("");
  EXPECT_EQ(rigid.joints[0].limits.velocity, 0.0);
  EXPECT_EQ(rigid.joints[0].limits.effort, 0.0);
  EXPECT_TRUE(rigid.warnings.empty());
}

TEST(UrdfReader, AnInertiaInAnotherUnitIsNone) {
  const auto parse = [](const std::string& moment) {
    return ParseLinks("<link name='a'><inertial><mass value='0.158'/><inertia ixx='" + moment +
                      "' ixy='0' ixz='0' iyy='" + moment + "' iyz='0' izz='" + moment +
                      "'/></inertial></link>");
  };
  const RobotTree wrong = parse("6.9e4");
  EXPECT_EQ(wrong.links[0].mass, 0.158);
  EXPECT_TRUE(wrong.links[0].inertia.isZero());
  ExpectWarning(wrong, "link 'a': its inertia is that of a body more than 20 m wide");
  const RobotTree placeholder = parse("1.0");
  EXPECT_EQ(placeholder.links[0].inertia(0, 0), 1.0);
  EXPECT_TRUE(placeholder.warnings.empty());
}

TEST(UrdfReader, LimitsInWhichAMimicJointCouldNotFollowAreNone) {
  const auto parse = [](const std::string& multiplier) {
    const std::string limit = "<limit lower='0' upper='0.5' effort='1' velocity='1'/>";
    return ParseLinks(LinkXml("a") + LinkXml("b") + LinkXml("c") +
                      JointXml("leader", "revolute", "a", "b", limit) +
                      JointXml("follower", "revolute", "b", "c",
                               limit + "<mimic joint='leader' multiplier='" + multiplier + "'/>"));
  };
  const RobotTree forgotten = parse("-1");
  EXPECT_EQ(forgotten.joints[1].limits.lower, -std::numeric_limits<double>::infinity());
  ExpectWarning(forgotten, "'follower' mimics another joint, which moves it -0.5 to 0");
  const RobotTree right = parse("0.5");
  EXPECT_EQ(right.joints[1].limits.upper, 0.5);
  EXPECT_TRUE(right.warnings.empty());
}

// Other moments of inertia are read as they are. The code that uses inertia reports what is wrong
// with them.
TEST(UrdfReader, AMomentOfInertiaBelowZeroByRoundingIsZero) {
  const auto parse = [](const std::string& ixx) {
    return ParseLinks("<link name='a'/><link name='b'><inertial><mass value='1'/><inertia ixx='" +
                      ixx + "' ixy='0' ixz='0' iyy='2e-5' iyz='0' izz='3e-5'/></inertial></link>" +
                      JointXml("j", "revolute", "a", "b"));
  };
  EXPECT_EQ(parse("-5.42101e-20").links[1].inertia(0, 0), 0.0);
  EXPECT_EQ(parse("1e-5").links[1].inertia(0, 0), 1e-5);
  EXPECT_EQ(parse("-1e-6").links[1].inertia(0, 0), -1e-6);
}

TEST(UrdfReader, FloatingAndPlanarJointsPartTheRobotFromTheRest) {
  const std::string arm = LinkXml("a") + LinkXml("b") + JointXml("hip", "revolute", "a", "b");
  // A ball in the robot's hand, with a link that turns on the ball.
  const RobotTree holder = ParseLinks(arm + LinkXml("c") + LinkXml("ball") + LinkXml("lid") +
                                      JointXml("more", "revolute", "b", "c") +
                                      JointXml("free", "floating", "c", "ball", "") +
                                      JointXml("hinge", "continuous", "ball", "lid", ""));
  EXPECT_EQ(holder.links.size(), 3u);
  EXPECT_EQ(holder.joints.size(), 2u);
  ExpectWarning(holder, "'free' is floating: what it carries (link 'ball') is left out, with 1 ");
  // The robot hangs on a link that also carries a camera. All of the robot is read.
  const RobotTree beside = ParseLinks(LinkXml("camera") + LinkXml("world") + arm +
                                      JointXml("on", "fixed", "world", "camera", "") +
                                      JointXml("free", "floating", "world", "a", ""));
  EXPECT_EQ(beside.links.size(), 2u);
  EXPECT_EQ(beside.links[0].name, "a");
  EXPECT_TRUE(beside.warnings.empty());
  const RobotTree wheeled =
      ParseLinks(LinkXml("floor") + arm + JointXml("p", "planar", "floor", "a", ""));
  EXPECT_EQ(wheeled.links[0].name, "a");
  EXPECT_EQ(wheeled.joints.size(), 1u);
  // The robot is the part that carries the other. Its mimic joint must not follow a joint that is
  // left out.
  ExpectLinksError(
      arm + LinkXml("c") + LinkXml("d") + LinkXml("e") +
          JointXml("free", "floating", "b", "c", "") + JointXml("lid", "revolute", "c", "d") +
          JointXml("k", "revolute", "b", "e", std::string(kLimit) + "<mimic joint='lid'/>"),
      {"'k' mimics 'lid'", "no joint of the robot"});
}

TEST(UrdfReader, ReadsWhatIsOddButClear) {
  const auto parse = [](const std::string& more) {
    return ParseLinks(LinkXml("a") + LinkXml("b") + JointXml("j", "revolute", "a", "b", more));
  };
  const RobotTree turned = parse("<limit lower='2' upper='1' velocity='1' effort='1'/>");
  EXPECT_EQ(turned.joints[0].limits.lower, 1.0);
  EXPECT_EQ(turned.joints[0].limits.upper, 2.0);
  ExpectWarning(turned, "'j': lower limit 2 is above upper limit 1");
  const RobotTree axes = parse(std::string(kLimit) + "<axis xyz='0 1 0'/><axis xyz='0 0 1'/>");
  EXPECT_EQ(axes.joints[0].axis, Eigen::Vector3d::UnitY());
  ExpectWarning(axes, "'j' has 2 axes");
  ExpectWarning(parse(std::string(kLimit) + "<axis xyz='0 0 3'/>"), "length 3");
  EXPECT_TRUE(parse(std::string(kLimit) + "<axis xyz='0 0.707 0.707'/>").warnings.empty());
  const RobotTree heavy = ParseLinks(
      "<link name='a'><inertial><origin xyz='1 2 3'/><mass value='5'/></inertial></link>");
  EXPECT_EQ(heavy.links[0].mass, 5.0);
  EXPECT_EQ(heavy.links[0].com, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(heavy.links[0].inertia.isZero());
  const RobotTree follower =
      ParseLinks(LinkXml("a") + LinkXml("b") + LinkXml("c") + JointXml("k", "fixed", "a", "b") +
                 JointXml("j", "revolute", "b", "c", std::string(kLimit) + "<mimic joint='k'/>"));
  EXPECT_TRUE(follower.joints.empty());
  ExpectWarning(follower, "'j' mimics 'k', which is fixed");
}

TEST(UrdfReader, NamesMalformedXml) {
  const auto expect = [](const std::string& text, std::initializer_list<std::string> parts) {
    ExpectInputError([&] { ParseUrdf(text, "r.urdf"); }, parts);
  };
  expect("<robot name='r'>\n<link name='a'>\n</robot>",
         {"r.urdf:3: ", "malformed XML: Start-end tags mismatch at 'robot>'"});
  expect("<robot name='r'>\n<link name='a'/>\n",
         {"r.urdf:2: ", "malformed XML: Start-end tags mismatch at the end of the text"});
  expect("<robot name='r'>\n<link name=a/>\n</robot>", {"r.urdf:2: ", "attribute at 'a/>'"});
  expect("<robot name='r'><!-- \n", {"r.urdf:1: ", "comment at the end of the text"});
  expect("a,b\n1,2\n", {"r.urdf:1: ", "malformed XML: No document element found at 'a,b'"});
  expect("", {"r.urdf:1: ", "malformed XML: No document element found at the end of the text"});
  expect("<!-- only -->", {"r.urdf:1: ", "No document element found"});
  expect("\n<sdf/>", {"r.urdf:2: ", "<sdf>", "<robot>"});
  expect("<robot name='r'><link name='a'/></robot>\n<robot/>",
         {"r.urdf:2: ", "second element", "'robot'"});
  expect("<robot/>", {"r.urdf:1: ", "'name'"});
  expect("<robot name='r'/>", {"r.urdf:1: ", "no <link>"});
}

TEST(UrdfReader, RefusesHostileBytes) {
  ExpectInputError([] { ParseUrdf(std::string("<robot>\n\0", 9), "r.urdf"); },
                   {"r.urdf:2: ", "NUL"});
  ExpectInputError([] { ParseUrdf(std::string((16u << 20) + 1, ' '), "r.urdf"); },
                   {"r.urdf", "16 MiB"});
  const std::string utf16 = {'\xff', '\xfe', '<', '\0', 'r', '\0'};
  ExpectInputError([&] { ParseUrdf(utf16, "r.urdf"); }, {"r.urdf:1: ", "NUL", "UTF-8"});
  ExpectLinksError(LinkXml("a\xe9"),
                   {"r.urdf:2: ", "'name' of link", "text in UTF-8 was expected"});
}

/// Parsing, searching and destroying need no stack that grows with the depth.
TEST(UrdfReader, PassesOverDeepNesting) {
  std::string open, close;
  for (int i = 0; i < 1000000; ++i) {
    open += "<a>";
    close += "</a>";
  }
  EXPECT_EQ(ParseLinks(LinkXml("a") + open + close).links.size(), 1u);
  ExpectLinksError(LinkXml("a") + open, {"r.urdf:3: ", "malformed XML"});
}

TEST(UrdfReader, ReadsWhateverXmlMayHoldAroundTheRobot) {
  const RobotTree tree = ParseUrdf(
      "\xEF\xBB\xBF<?xml version='1.0' encoding='ISO-8859-1'?>\n"
      "<!DOCTYPE robot [<!ENTITY x \"<link name='c'/>\">]><!-- caf\xe9 > <robot> --><?pi <a?>\n"
      "<robot name='r'>words<link name='a'/><![CDATA[<link name='b'/>]]></robot>\n",
      "r.urdf");
  EXPECT_EQ(tree.links.size(), 1u);
}

TEST(UrdfReader, RefusesMoreLinksThanAnyRobotHas) {
  std::string links;
  for (int i = 0; i <= 5000; ++i) links += LinkXml(std::to_string(i));
  ExpectLinksError(links, {"r.urdf:5002: ", "more than 5000 links"});
}

TEST(UrdfReader, SaysThatAXacroFileIsToBeExpanded) {
  ExpectLinksError("<xacro:include filename='x'/>", {"r.urdf:2: ", "xacro", "expand"});
}

TEST(UrdfReader, PassesOverWhatItDoesNotNeed) {
  const RobotTree tree = ParseLinks(
      "<material name='grey'/>" + LinkXml("a") +
      "<link name='b'><visual><origin xyz='x'/></visual><collision/></link>" +
      JointXml("j", "revolute", "a", "b",
               std::string(kLimit) + "<calibration rising='0'/><dynamics damping='-'/>") +
      "<transmission><joint name='j'/></transmission><gazebo><joint name='j' type='x'/></gazebo>");
  EXPECT_EQ(tree.joints.size(), 1u);
}

TEST(UrdfReader, KeepsNamesWithMarkupAndAccents) {
  const RobotTree tree = ParseLinks(LinkXml("a&amp;b &lt;c&gt; 'é'"));
  EXPECT_EQ(tree.links[0].name, "a&b <c> 'é'");
}

TEST(UrdfReader, ReadsTheModelsOfTheTests) {
  const RobotTree arm = ReadUrdf(SourceFile("tests/robots/arm6.urdf"));
  EXPECT_EQ(arm.joints.size(), 9u);
  EXPECT_EQ(arm.coordinate_count(), 8);
  const Joint& finger = arm.joints[FindJoint(arm, "finger_right_joint")];
  EXPECT_EQ(finger.multiplier, -1.0);
  EXPECT_EQ(finger.offset, -0.002);
  EXPECT_EQ(ReadUrdf(SourceFile("models/talos/talos.urdf")).coordinate_count(), 30);
}

/// The largest number of links that is accepted, in one chain, in which each movable joint follows
/// the one before. Time and stack must not grow out of hand.
TEST(UrdfReader, ReadsTheLongestChain) {
  const auto chain = [](int movable) {
    std::string contents = LinkXml("0");
    for (int i = 1; i < 5000; ++i) {
      const std::string name = std::to_string(i), last = std::to_string(i - 1);
      contents += LinkXml(name) + JointXml(name, i <= movable ? "continuous" : "fixed", last, name,
                                           i == 1 ? "" : "<mimic joint='" + last + "'/>");
    }
    return contents;
  };
  const RobotTree tree = ParseLinks(chain(300));
  EXPECT_EQ(tree.joints.size(), 300u);
  EXPECT_EQ(tree.coordinate_count(), 1);
  ExpectLinksError(chain(301), {"r.urdf:1: ", "found 301 movable joints; at most 300"});
}

TEST(UrdfReader, ARevoluteJointOfManyTurnsHasNoEnd) {
  const std::string joint =
      LinkXml("a") + LinkXml("b") +
      "<joint name='wheel' type='TYPE'><parent link='a'/><child link='b'/>"
      "<limit lower='-1000000' upper='1000000' velocity='1' effort='1'/></joint>";
  const RobotTree tree = ParseLinks(std::regex_replace(joint, std::regex("TYPE"), "revolute"));
  EXPECT_EQ(tree.joints[0].limits.lower, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(tree.joints[0].limits.upper, std::numeric_limits<double>::infinity());
  ASSERT_EQ(tree.warnings.size(), 1u);
  EXPECT_NE(tree.warnings[0].find("it is taken to turn without an end"), std::string::npos);
  ExpectLinksError(std::regex_replace(joint, std::regex("TYPE"), "prismatic"),
                   {"from -1000 to 1000"});
}

// No robot has such numbers, sizes and names. They would overflow or take hours.
TEST(UrdfReader, RefusesWhatNoRobotHas) {
  const std::string links = LinkXml("a") + "\n" + LinkXml("b") + "\n";
  const auto joint = [&](const std::string& limit) {
    return links + "<joint name='j' type='revolute'><parent link='a'/><child link='b'/>\n<limit " +
           limit + "/></joint>";
  };
  ExpectLinksError(joint("lower='-1e8' upper='1' velocity='1' effort='1'"),
                   {"limits of joint 'j' are -1e+08 and 1", "from -1000 to 1000", "continuous"});
  ExpectLinksError(joint("lower='-1' upper='1' velocity='-1' effort='1'"), {"'velocity'", "'-1'"});
  ExpectLinksError(joint("lower='-1' upper='1' velocity='1' effort='-1'"), {"'effort'", "'-1'"});
  std::string attributes;
  for (int i = 0; i < 101; ++i) attributes += " a" + std::to_string(i) + "='1'";
  ExpectLinksError("<link name='a'" + attributes + "/>", {"more than 100 attributes"});
  ExpectLinksError(LinkXml(std::string(201, 'x')), {"more than 200 bytes"});
}

TEST(UrdfReader, NamesAMissingFile) {
  ExpectInputError([] { ReadUrdf("nowhere/robot.urdf"); },
                   {"nowhere/robot.urdf", "there is no such file"});
}

}  // namespace
}  // namespace elastocal
