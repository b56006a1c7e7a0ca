#include "elastocal/io/xml_tags.hpp"

#include <string>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

TEST(XmlTags, FindsPlacesOfNamesAndValues) {
  const std::string text = "ab<joint\n name = 'x>y'\ttype=\"\" />c";
  const auto tag = NextTag(text, 0);
  ASSERT_TRUE(tag);
  EXPECT_EQ(tag->begin, 2u);
  EXPECT_EQ(tag->name, "joint");
  EXPECT_EQ(text.substr(tag->end), "c");
  EXPECT_EQ(text[tag->name_end], '\n');
  EXPECT_TRUE(tag->empty);
  EXPECT_FALSE(tag->closing);
  ASSERT_EQ(tag->attributes.size(), 2u);
  EXPECT_EQ(tag->attributes[0].name, "name");
  EXPECT_EQ(tag->attributes[0].value, "x>y");
  EXPECT_EQ(text.substr(tag->attributes[0].value_begin, 3), "x>y");
  EXPECT_EQ(tag->attributes[1].value, "");
}

TEST(XmlTags, PassesOverWhatIsNoTag) {
  const std::string text = "<?xml <a>?><!DOCTYPE x><!-- <b> --><![CDATA[<c> ]] > ]]><!----></d >";
  const auto tag = NextTag(text, 0);
  ASSERT_TRUE(tag);
  EXPECT_EQ(tag->name, "d");
  EXPECT_TRUE(tag->closing);
  EXPECT_FALSE(NextTag(text, tag->end));
}

TEST(XmlTags, StopsAtMalformedText) {
  for (const char* text : {"", "<", "<a", "<a b", "<a b=", "<a b=c>", "<a b='c>", "<!-- <a>",
                           "<![CDATA[<a>", "<?<a>", "<>", "<a /b>"}) {
    EXPECT_FALSE(NextTag(text, 0)) << text;
  }
}

}  // namespace
}  // namespace elastocal
