// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/xml_element.hpp"

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

const std::string kSource = "r.urdf";

TEST(XmlElement, ReadsAttributesAndChildren) {
  const std::string text = "<joint name='j' n=' -2e1 '>words<axis xyz='1\n2\t 3'/><limit/></joint>";
  const XmlText xml(text, kSource);
  const XmlElement joint = xml.Root();
  EXPECT_EQ(joint.Text("name"), "j");
  EXPECT_EQ(joint.Number("n"), -20.0);
  EXPECT_EQ(joint.NumberOr("m", 3.0), 3.0);
  EXPECT_EQ(joint.Get("axis").Vector("xyz"), Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(joint.Find("mimic"));
  EXPECT_TRUE(joint.Has("n"));
  EXPECT_FALSE(joint.Has("m"));
  ASSERT_EQ(joint.Children().size(), 2u);
  EXPECT_EQ(joint.Children()[1].Tag(), "limit");
}

TEST(XmlElement, NamesTheNearestNamedElement) {
  const std::string text = "<joint name='j'>\n<axis xyz='1 2'/>\n<limit/><limit/></joint>";
  const XmlText xml(text, kSource);
  const XmlElement joint = xml.Root();
  ExpectInputError([&] { joint.Get("axis").Vector("xyz"); },
                   {"r.urdf:2: ", "'xyz' of <axis> of joint 'j' is '1 2'"});
  ExpectInputError([&] { joint.Get("axis").Number("n"); },
                   {"<axis> of joint 'j' has no attribute"});
  ExpectInputError([&] { joint.Find("limit"); }, {"r.urdf:3: second <limit> in joint 'j'"});
  ExpectInputError([&] { joint.Get("mimic"); }, {"r.urdf:1: joint 'j' has no <mimic>"});
}

TEST(XmlElement, TextIsPrintable) {
  const std::string text = "<link name='' other='a&#10;b'/>";
  const XmlText xml(text, kSource);
  ExpectInputError([&] { xml.Root().Text("name"); }, {"''", "printable"});
  ExpectInputError([&] { xml.Root().Text("other"); }, {"'a?b'", "printable"});
}

TEST(XmlElement, KnowsItsPlaces) {
  const std::string text = "<!-- <a> --><a\n b = \"&lt;x>\" c=''\t/>|";
  const XmlText xml(text, kSource);
  const XmlElement a = xml.Root();
  const auto [begin, length] = a.ValueRange("b");
  EXPECT_EQ(text.substr(begin, length), "&lt;x>");
  EXPECT_EQ(a.ValueRange("c").length, 0u);
  EXPECT_EQ(text[a.NameEnd()], '\n');
  EXPECT_EQ(text.substr(a.StartTagEnd()), "|");
}

TEST(XmlElement, EndsBehindItsOwnEndTag) {
  const std::string text =
      "<r><a n='x'><!-- </a> > --><a t='>'/><![CDATA[</a>]]><?p </a> ?><b><a ></a></b>> '\n</a >"
      "<c/><d></d></r>|";
  const XmlText xml(text, kSource);
  const auto all = [&](const XmlElement& element) {
    return text.substr(element.Begin(), element.End() - element.Begin());
  };
  const std::vector<XmlElement> children = xml.Root().Children();
  ASSERT_EQ(children.size(), 3u);
  EXPECT_EQ(all(children[0]), text.substr(3, text.find("<c/>") - 3));
  EXPECT_EQ(all(children[0].Children()[1]), "<b><a ></a></b>");
  EXPECT_EQ(all(children[1]), "<c/>");
  EXPECT_EQ(all(children[2]), "<d></d>");
  EXPECT_EQ(text.substr(xml.Root().End()), "|");
}

}  // namespace
}  // namespace elastocal
