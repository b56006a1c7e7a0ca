#include "elastocal/io/urdf_document.hpp"

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

TEST(UrdfDocument, CanonicalTextHoldsWhatIsNeededAndNoMore) {
  const UrdfDocument document = CheckUrdf(
      "<?xml version='1.0'?><!-- c --><robot name='r' version='2'><link name='b'><visual/></link>\n"
      "<joint name='j' type='revolute'><child link='b'/><parent link='a'/><dynamics damping='x'/>\n"
      "<axis xyz=' 0\t0  +2e0 '/><limit effort='1' velocity='2' upper='.5'/></joint>\n"
      "<link name='a'><inertial><mass value='1.0'/>"
      "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>\n"
      "<gazebo/></robot>",
      "r.urdf");
  EXPECT_EQ(document.canonical,
            "<robot name=\"r\"><link name=\"b\"/><link name=\"a\"><inertial>"
            "<origin xyz=\"0 0 0\" rpy=\"0 0 0\"/><mass value=\"1\"/>"
            "<inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>"
            "</link><joint name=\"j\" type=\"revolute\"><origin xyz=\"0 0 0\" rpy=\"0 0 0\"/>"
            "<parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 0 1\"/>"
            "<limit upper=\"0.5\" effort=\"1\" velocity=\"2\"/></joint></robot>");
  EXPECT_EQ(document.root, "a");
  EXPECT_EQ(document.links, (std::vector<std::string>{"b", "a"}));
}

TEST(UrdfDocument, ListsADroppedJointButNotItsParent) {
  const UrdfDocument document = CheckUrdf(
      "<robot name='r'><link name='world'/><link name='a'/><joint name='j' type='floating'>"
      "<parent link='world'/><child link='a'/></joint></robot>",
      "r.urdf");
  EXPECT_EQ(document.root, "a");
  EXPECT_EQ(document.links, std::vector<std::string>{"a"});
  ASSERT_EQ(document.joints.size(), 1u);
  EXPECT_TRUE(document.joints[0].dropped);
  EXPECT_EQ(document.canonical, "<robot name=\"r\"><link name=\"a\"/></robot>");
}

TEST(UrdfDocument, RefusesMoreLinksThanAnyRobotHas) {
  std::string text = "<robot name='r'>\n";
  for (int i = 0; i <= 5000; ++i) text += "<link name='" + std::to_string(i) + "'/>\n";
  ExpectInputError([&] { CheckUrdf(text + "</robot>", "r.urdf"); },
                   {"r.urdf:5002: ", "more than 5000 links"});
}

}  // namespace
}  // namespace elastocal
