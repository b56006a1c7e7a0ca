// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/utf8.hpp"

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

TEST(Utf8, KnowsTextFromOtherBytes) {
  for (const char* text : {"", "plain", "\u00e9", "\u20ac", "\U0001F916", "\xEF\xBB\xBF(mark)"}) {
    EXPECT_TRUE(IsUtf8(text)) << text;
  }
  // Latin-1, a lone and a missing continuation byte, an overlong '/', half a surrogate pair, and a
  // code point beyond U+10FFFF.
  for (const char* text :
       {"\xe9t\xe9", "\xa9", "\xc3", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80"}) {
    EXPECT_FALSE(IsUtf8(text)) << text;
  }
}

TEST(Utf8, NamesTheLine) {
  RequireUtf8("a\n\u00e9", "f.yaml");
  ExpectInputError([] { RequireUtf8("a: \u00e9\nb: caf\xe9\n", "f.yaml"); },
                   {"f.yaml:2: ", "what follows 'b: caf' is not UTF-8"});
  ExpectInputError([] { RequireUtf8("\xe9,b", "f.csv", 7); }, {"f.csv:7: what follows '' "});
}

TEST(Printable, LeavesTextAndTakesTheRest) {
  EXPECT_EQ(Printable("a\tb\n\u00e9\u20ac\U0001F916"), "a\tb\n\u00e9\u20ac\U0001F916");
  EXPECT_EQ(Printable("caf\xe9!"), "caf\uFFFD!");
  EXPECT_EQ(Printable("\xff\xfe"), "\uFFFD\uFFFD");
  // The first bytes of terminal commands, in 7 and in 8 bits.
  EXPECT_EQ(Printable("\x1b[2J\r\x7f"), "?[2J??");
  EXPECT_EQ(Printable("\u009b2J"), "?2J");
}

}  // namespace
}  // namespace elastocal
