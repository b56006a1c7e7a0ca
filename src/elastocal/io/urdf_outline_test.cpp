#include "elastocal/io/urdf_outline.hpp"

#include <gtest/gtest.h>
#include <tinyxml2.h>

namespace elastocal {
namespace {

// What is refused is tested with the reader (urdf_reader_test.cpp).
TEST(UrdfOutline, ListsLinksAndJointsAsTheyStand) {
  tinyxml2::XMLDocument xml;
  const std::string source = "r.urdf";
  ASSERT_EQ(
      xml.Parse("<robot name='r'><joint name='j' type='continuous'><parent link='a'/>"
                "<child link='b'/><origin rpy='1 2 3'/><mimic joint='k'/></joint>"
                "<link name='c'/><link name='b'/><link name='a'/>"
                "<joint name='k' type='continuous'><parent link='b'/><child link='c'/></joint>"
                "</robot>"),
      tinyxml2::XML_SUCCESS);
  const UrdfOutline outline = ReadUrdfOutline(*xml.RootElement(), source);
  EXPECT_EQ(outline.robot, "r");
  ASSERT_EQ(outline.links.size(), 3u);
  EXPECT_EQ(outline.links[0].name, "c");
  EXPECT_EQ(outline.links[0].parent_joint, 1);
  EXPECT_EQ(outline.links[outline.root].name, "a");
  ASSERT_EQ(outline.joints.size(), 2u);
  EXPECT_EQ(outline.joints[0].joint.origin.xyz, Eigen::Vector3d::Zero());
  EXPECT_EQ(outline.joints[0].joint.origin.rpy, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(outline.joints[0].mimic, "k");
  EXPECT_EQ(outline.joints[1].mimic, "");
}

}  // namespace
}  // namespace elastocal
