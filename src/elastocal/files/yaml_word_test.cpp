// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/yaml_word.hpp"

#include <gtest/gtest.h>

#include "elastocal/files/yaml_value.hpp"

namespace elastocal {
namespace {

TEST(YamlWord, IsReadBackAsTheSameText) {
  for (const std::string name :
       {"arm_left_1_joint", "1", "on", "Null", "~", "a: b", "a\"b\\c", "1e5", "gelenk-ü"}) {
    const YamlValue read = YamlValue::Parse(YamlWord(name) + ": {is: " + YamlWord(name) + "}", "t");
    ASSERT_EQ(read.Entries().size(), 1u) << name;
    EXPECT_EQ(read.Entries().front().first, name);
    EXPECT_EQ(read.Entries().front().second.Get("is").Text(), name);
  }
}

TEST(YamlWord, LeavesPlainNamesAsTheyAre) {
  EXPECT_EQ(YamlWord("arm_left_1_joint"), "arm_left_1_joint");
  EXPECT_EQ(YamlWord("on"), "\"on\"");  // a truth value in YAML 1.1
  EXPECT_EQ(YamlWord("12"), "\"12\"");
}

}  // namespace
}  // namespace elastocal
