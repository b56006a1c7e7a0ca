// SPDX-License-Identifier: Apache-2.0
#include "elastocal/tables/text.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

TEST(Text, NumbersAreFiniteAndWhole) {
  EXPECT_EQ(ParseNumber("-1.5e-3"), -1.5e-3);
  EXPECT_EQ(ParseNumber("  +.5\r"), 0.5);
  for (const char* text :
       {"", " ", "nan", "inf", "1e999", "1,5", "1 2", "0x10", "+-1", "+", "1m"}) {
    EXPECT_FALSE(ParseNumber(text)) << text;
  }
}

TEST(Text, WrittenNumbersReadBackExactly) {
  for (double value :
       {0.1, -1.0 / 3.0, 1e-300, 123456789.123456789, std::numeric_limits<double>::denorm_min()}) {
    EXPECT_EQ(ParseNumber(FormatNumber(value)), value);
  }
  EXPECT_EQ(FormatNumber(0.1), "0.1");
  std::string text = "x ";
  AppendFixed(-1.0 / 3.0, 2, text);
  EXPECT_EQ(text, "x -0.33");
}

TEST(Text, QuotesShowWhatIsThereInOneShortLine) {
  EXPECT_EQ(Quote("a b"), "'a b'");
  EXPECT_EQ(Quote("a\n\x01z"), "'a??z'");
  EXPECT_EQ(Quote(std::string(1000, 'x')), "'" + std::string(60, 'x') + "...'");
}

TEST(Text, GapsHaveManyShapes) {
  for (const char* text : {"", "  ", "nan", "NaN", "NULL", " null"})
    EXPECT_TRUE(IsGap(text)) << text;
  for (const char* text : {"0", "n", "nano", "nulls", "inf"}) EXPECT_FALSE(IsGap(text)) << text;
}

TEST(Text, TrimTakesSpacesOfBothEnds) {
  EXPECT_EQ(Trim("\t a b \r\n"), "a b");
  EXPECT_EQ(Trim(" \n"), "");
}

}  // namespace
}  // namespace elastocal
