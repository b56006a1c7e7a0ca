// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/yaml_value.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

YamlValue ParseYaml(const std::string& text) { return YamlValue::Parse(text, "p.yaml"); }

void ExpectParseError(const std::string& text, std::initializer_list<std::string> parts) {
  ExpectInputError([&] { ParseYaml(text); }, parts);
}

TEST(YamlValue, ReadsEveryKind) {
  const YamlValue root = ParseYaml(
      "number: -1.5e3\nlist: [a, 2]\nmapping: {x: 1}\nnothing:\ntext: 'a b'\nwhole: 7\nyes: "
      "true\n");
  EXPECT_EQ(root.Get("number").Number(), -1500.0);
  ASSERT_EQ(root.Get("list").Items().size(), 2u);
  EXPECT_EQ(root.Get("list").Items()[0].Text(), "a");
  EXPECT_EQ(root.Get("mapping").Get("x").Integer(0, 1), 1);
  EXPECT_TRUE(root.Get("nothing").Items().empty());
  EXPECT_TRUE(root.Get("nothing").Entries().empty());
  EXPECT_EQ(root.Get("text").Text(), "a b");
  EXPECT_EQ(root.Get("whole").Number(kPositiveOrInfinity), 7.0);
  EXPECT_TRUE(root.Get("yes").Boolean());
  EXPECT_EQ(ParseYaml("sd: .inf").Get("sd").Number(kPositiveOrInfinity),
            std::numeric_limits<double>::infinity());
  EXPECT_FALSE(root.Find("absent"));
  EXPECT_TRUE(ParseYaml("").Entries().empty());
}

TEST(YamlValue, RefusesWhatIsNotUtf8) {
  ExpectParseError("a: \u00e9\nb: caf\xe9\n", {"p.yaml:2: ", "UTF-8"});
}

TEST(YamlValue, NamesFileLineAndPath) {
  const YamlValue root = ParseYaml("outer:\n  inner:\n    - 1\n    - two\n");
  ExpectInputError([&] { root.Get("outer").Get("inner").Items()[1].Number(); },
                   {"p.yaml:4: outer.inner[1]: found 'two'; expected a number"});
  ExpectInputError([&] { root.Get("outer").Get("x"); }, {"p.yaml:2: outer: ", "'x' is missing"});
  ExpectInputError([&] { root.Get("outer").Text(); }, {"outer: found a mapping; expected text"});
  ExpectInputError([&] { root.Get("outer").Get("inner").Entries(); }, {"found a list"});
}

TEST(YamlValue, NamesUnknownKeysWithTheNearestKnownOne) {
  const YamlValue root = ParseYaml("a: {marker: 1,\n  jont: 2}");
  ExpectInputError(
      [&] {
        root.Get("a").ExpectKeys({"marker", "joint"});
      },
      {"p.yaml:2: a: unknown key 'jont'; did you mean 'joint'?"});
  ExpectInputError(
      [&] {
        root.ExpectKeys({"first", "second"});
      },
      {"p.yaml:1: unknown key 'a'", "expected first, second"});
}

TEST(YamlValue, ChecksNumbers) {
  const auto value = [](const std::string& text) { return ParseYaml("x: " + text).Get("x"); };
  for (const char* text : {".nan", ".inf", "1e999", "1 mm", "[1]", "''", ""}) {
    EXPECT_THROW(value(text).Number(), InputError) << text;
  }
  for (const char* text : {"0", "-1", "-.inf", "text"}) {
    EXPECT_THROW(value(text).Number(kPositiveOrInfinity), InputError) << text;
  }
  for (const char* text : {"1.5", "1e3", "0", "11", "99999999999999999999", "ten"}) {
    ExpectInputError([&] { value(text).Integer(1, 10); }, {"p.yaml:1: x: ", "from 1 to 10"});
  }
  EXPECT_THROW(value("yes").Boolean(), InputError);
  EXPECT_THROW(value(std::string(1001, 'a')).Text(), InputError);
}

TEST(YamlValue, NamesMalformedText) {
  ExpectParseError("a: 1\nb: [1, 2\n", {"p.yaml:", "malformed YAML"});
  ExpectParseError("a: 1\n\tb: 2\n", {"p.yaml:2: ", "malformed YAML"});
  ExpectParseError("a: *unknown", {"p.yaml:1: ", "malformed YAML", "anchor"});
  ExpectParseError("a: 1\nb: 2\na: 3\n", {"p.yaml:3: ", "'a' comes twice"});
  ExpectParseError("a: 1\n---\nb: 2\n", {"p.yaml:2: ", "second document"});
  ExpectParseError("? [a]\n: 1\n", {"p.yaml:1: ", "key"});
  ExpectParseError("? {a: 1}\n: 1\n", {"p.yaml:1: ", "key"});
  ExpectParseError("~: 1\n", {"p.yaml:1: ", "empty key"});
}

TEST(YamlValue, RefusesHostileText) {
  // Each alias would stand for ten times the one before it: 10^9 values.
  std::string bomb = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string last = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + last;
    for (int j = 1; j < 10; ++j) bomb += ", " + last;
    bomb += "]\n";
  }
  ExpectParseError(bomb, {"p.yaml:2: ", "aliases"});
  ExpectParseError(std::string(21, '[') + std::string(21, ']'), {"p.yaml:1: ", "20 levels"});
  ExpectParseError(std::string(100000, '['), {"p.yaml:1: "});
  ExpectParseError(std::string(100000, '{'), {"p.yaml:1: "});
  std::string indented;
  for (int i = 0; i < 1000; ++i) indented += std::string(i, ' ') + "a:\n";
  ExpectParseError(indented, {"p.yaml:21: ", "20 levels"});
  ExpectParseError(std::string((1u << 20) + 1, ' '), {"p.yaml", "1 MiB"});
  EXPECT_THROW(ParseYaml(std::string("a: \0", 4)).Get("a").Number(), InputError);
}

TEST(YamlValue, ReadsKeysIntoOptions) {
  const YamlValue root = ParseYaml("a: 2\nb: 7\nc: true\n");
  double number = 1.0, absent = 1.0;
  int whole = 0;
  bool flag = false;
  root.Read("a", number, kPositive, 1e-3);
  root.Read("no", absent, kPositive);
  root.Read("b", whole, 1, 7);
  root.Read("c", flag);
  EXPECT_EQ(number, 2e-3);
  EXPECT_EQ(absent, 1.0);
  EXPECT_EQ(whole, 7);
  EXPECT_TRUE(flag);
  ExpectInputError([&] { root.Read("b", whole, 1, 6); }, {"p.yaml:2: b: ", "from 1 to 6"});
}

TEST(YamlValue, NumberRangesCountTheirBoundsWhereTheySay) {
  const YamlValue one = ParseYaml("1");
  EXPECT_EQ(one.Number(kFractionOrOne), 1.0);
  EXPECT_EQ(one.Number({1.0, 1.0, true, true}), 1.0);
  ExpectInputError([&] { one.Number(kFraction); }, {"found '1'", "above 0 and below 1"});
  ExpectInputError([&] { one.Number({1.0}); }, {"a number above 1"});
  ExpectInputError([&] { one.Number({.lower = 2.0, .with_lower = true}); }, {"of at least 2"});
  ExpectInputError([&] { one.Number({0.0, 0.5, true, true}); }, {"from 0 to 0.5"});
  ExpectInputError([&] { ParseYaml(".inf").Number(kPositive); }, {"found '.inf'"});
}

}  // namespace
}  // namespace elastocal
