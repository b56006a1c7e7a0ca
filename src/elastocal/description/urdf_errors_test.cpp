// SPDX-License-Identifier: Apache-2.0
// Errors in a robot description are reported with their line.
#include <gtest/gtest.h>

#include "tests/urdf_snippets.hpp"

namespace elastocal {
namespace {

TEST(UrdfReader, NamesWrongStructure) {
  ExpectLinksError(LinkXml("a") + LinkXml("a"), {"r.urdf:3: ", "second link", "'a'"});
  ExpectLinksError(LinkXml("a") + LinkXml("b") + LinkXml("c") + JointXml("j", "fixed", "a", "b") +
                       JointXml("j", "fixed", "a", "c"),
                   {"r.urdf:6: ", "second joint", "'j'"});
  ExpectLinksError(LinkXml("waist") + JointXml("j", "fixed", "waistt", "b"),
                   {"r.urdf:3: ", "'waistt'", "did you mean 'waist'"});
  ExpectLinksError(LinkXml("waist") + JointXml("j", "fixed", "waist", "b"),
                   {"r.urdf:3: ", "child", "'b'"});
  ExpectLinksError(LinkXml("a") + LinkXml("b") + LinkXml("c") + JointXml("j", "fixed", "a", "c") +
                       JointXml("k", "fixed", "b", "c"),
                   {"r.urdf:6: ", "'c'", "'j'", "'k'", "one parent"});
  ExpectLinksError(LinkXml("a") + LinkXml("b"), {"r.urdf:3: ", "'a'", "'b'", "one root"});
  ExpectLinksError(LinkXml("a") + LinkXml("b") + JointXml("j", "fixed", "a", "b") +
                       JointXml("k", "fixed", "b", "a"),
                   {"r.urdf:2: ", "'a'", "loop"});
  ExpectLinksError(LinkXml("root") + LinkXml("a") + JointXml("j", "fixed", "a", "a"),
                   {"r.urdf:3: ", "'a'", "loop"});
}

TEST(UrdfReader, NamesWrongJoint) {
  ExpectJointError("revolut", kLimit, {"r.urdf:4: ", "'revolut'", "did you mean 'revolute'"});
  ExpectJointError("revolute", "", {"r.urdf:4: ", "'j'", "<limit>"});
  ExpectJointError("prismatic", "", {"r.urdf:4: ", "'j'", "<limit>"});
  ExpectJointError("revolute", "<limit lower='0' upper='1' velocity='1'/>",
                   {"r.urdf:4: ", "'j'", "'effort'"});
  ExpectJointError("revolute", std::string(kLimit) + "\n<axis xyz='0 0 0'/>",
                   {"r.urdf:5: ", "axis is zero"});
  ExpectJointError("revolute", std::string(kLimit) + kLimit, {"r.urdf:4: ", "second <limit>"});
  ExpectLinksError(LinkXml("a") + "<joint name='j' type='fixed'><parent link='a'/></joint>",
                   {"r.urdf:3: ", "'j'", "<child>"});
  ExpectLinksError(LinkXml("a") + "<joint type='fixed'/>", {"r.urdf:3: ", "<joint>", "'name'"});
  ExpectLinksError("<link name='a'\n name='b'/>", {"r.urdf:2: ", "second attribute 'name'"});
}

TEST(UrdfReader, NamesWrongNumbers) {
  for (const char* xyz : {"1 2", "1 2 3 4", "1 2 x", "1 2 nan", "1 2 1e999", "1,2,3", ""}) {
    ExpectJointError("fixed", "\n<origin xyz='" + std::string(xyz) + "'/>",
                     {"r.urdf:5: ", "'xyz'", "<origin> of joint 'j'", "'" + std::string(xyz) + "'",
                      "three finite numbers"});
  }
  ExpectJointError("fixed", "<origin rpy='0 0 inf'/>", {"r.urdf:4: ", "'rpy'"});
  ExpectJointError("revolute", "<limit lower='-1' upper='${x}' effort='1' velocity='1'/>",
                   {"r.urdf:4: ", "'upper'", "'${x}'", "finite number"});
  const auto inertial = [](const std::string& mass, const std::string& ixx) {
    return "<link name='a'><inertial>\n<mass value='" + mass + "'/>\n<inertia ixx='" + ixx +
           "' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>";
  };
  ExpectLinksError(inertial("-1", "1"), {"r.urdf:3: ", "a number from 0 to"});
  ExpectLinksError(inertial("heavy", "1"), {"r.urdf:3: ", "'heavy'"});
  ExpectLinksError(
      "<link name='a'><inertial><mass value='1'/>\n<inertia ixx='1' ixy='0' ixz='0' iyy='1' "
      "iyz='0'/></inertial></link>",
      {"r.urdf:3: ", "no attribute 'izz'"});
  ExpectLinksError(inertial("1", "nan"), {"r.urdf:4: ", "'ixx'", "link 'a'", "'nan'"});
}

TEST(UrdfReader, NamesMimicsThatLeadNowhere) {
  const auto mimic = [](const std::string& joint) {
    return std::string(kLimit) + "<mimic joint='" + joint + "'/>";
  };
  ExpectJointError("revolute", mimic("nobody"), {"r.urdf:4: ", "'j'", "'nobody'"});
  ExpectJointError("revolute", mimic("j"), {"r.urdf:4: ", "'j'", "itself"});
  const std::string links = LinkXml("a") + LinkXml("b") + LinkXml("c");
  ExpectLinksError(links + JointXml("j", "revolute", "a", "b", mimic("k")) +
                       JointXml("k", "revolute", "b", "c", mimic("j")),
                   {"r.urdf:5: ", "'j'", "itself"});
  ExpectLinksError(links +
                       JointXml("j", "revolute", "a", "b",
                                std::string(kLimit) + "<mimic joint='k' offset='1'/>") +
                       JointXml("k", "fixed", "b", "c"),
                   {"r.urdf:5: ", "'j'", "'k'", "fixed"});
}

}  // namespace
}  // namespace elastocal
