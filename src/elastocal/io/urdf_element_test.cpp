#include "elastocal/io/urdf_element.hpp"

#include <gtest/gtest.h>
#include <tinyxml2.h>

#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

class UrdfElementTest : public testing::Test {
 protected:
  /// The top element of `text`.
  UrdfElement Parse(const std::string& text) {
    EXPECT_EQ(xml_.Parse(text.c_str()), tinyxml2::XML_SUCCESS);
    return UrdfElement(*xml_.RootElement(), source_);
  }

 private:
  tinyxml2::XMLDocument xml_;
  const std::string source_ = "r.urdf";
};

TEST_F(UrdfElementTest, ReadsAttributesAndChildren) {
  const UrdfElement joint =
      Parse("<joint name='j' n=' -2e1 '><axis xyz='1\n2\t 3'/><limit/></joint>");
  EXPECT_EQ(joint.Text("name"), "j");
  EXPECT_EQ(joint.Number("n"), -20.0);
  EXPECT_EQ(joint.Get("axis").Vector("xyz"), Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(joint.Find("mimic"));
  EXPECT_TRUE(joint.Has("n"));
  EXPECT_FALSE(joint.Has("m"));
}

TEST_F(UrdfElementTest, NamesTheNearestNamedElement) {
  const UrdfElement joint = Parse("<joint name='j'>\n<axis xyz='1 2'/>\n<limit/><limit/></joint>");
  ExpectInputError([&] { joint.Get("axis").Vector("xyz"); },
                   {"r.urdf:2: ", "'xyz' of <axis> of joint 'j' is '1 2'"});
  ExpectInputError([&] { joint.Get("axis").Number("n"); },
                   {"<axis> of joint 'j' has no attribute"});
  ExpectInputError([&] { joint.Find("limit"); }, {"r.urdf:3: second <limit> in joint 'j'"});
  ExpectInputError([&] { joint.Get("mimic"); }, {"r.urdf:1: joint 'j' has no <mimic>"});
}

TEST_F(UrdfElementTest, TextIsPrintable) {
  const UrdfElement link = Parse("<link name='' other='a&#10;b'/>");
  ExpectInputError([&] { link.Text("name"); }, {"''", "printable"});
  ExpectInputError([&] { link.Text("other"); }, {"'a?b'", "printable"});
}

}  // namespace
}  // namespace elastocal
