// SPDX-License-Identifier: Apache-2.0
#include "elastocal/report/json_reader.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

std::string Nested(int levels) {
  std::string text = "1";
  for (int i = 0; i < levels; ++i) text = "{\"a\":" + text + "}";
  return text;
}

TEST(ParseJsonObject, ReadsAnObject) {
  EXPECT_EQ(ParseJsonObject("a.json", R"({"a": [1, 2]})")["a"][1], 2);
  EXPECT_EQ(ParseJsonObject("a.json", Nested(100)).size(), 1u);
}

TEST(ParseJsonObject, NamesTheFileOfWhatIsNone) {
  for (const char* text : {"", "[]", "null", "3", "{", "{\"a\": 1e999}", "{\"a\": \"\xff\"}"}) {
    ExpectInputError([&] { ParseJsonObject("a.json", text); }, {"a.json: "});
  }
}

// With 100 000 levels, even the destructor would exhaust the stack.
TEST(ParseJsonObject, RefusesDeepNesting) {
  ExpectInputError([] { ParseJsonObject("a.json", Nested(101)); }, {"a.json", "100 levels"});
  const std::string open(100000, '[');
  ExpectInputError([&] { ParseJsonObject("a.json", "{\"a\":" + open); }, {"100 levels"});
}

}  // namespace
}  // namespace elastocal
