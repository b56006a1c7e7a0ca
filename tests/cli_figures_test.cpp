// SPDX-License-Identifier: Apache-2.0
// Formatting of numbers with uncertainties, and grouping of warnings.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "elastocal/cli/figures.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/cli/warning_groups.hpp"

namespace elastocal::cli {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Figures, StandardDeviationsHaveTwoSignificantDigits) {
  EXPECT_EQ(RoundedSd(0.0123), "0.012");
  EXPECT_EQ(RoundedSd(0.0996), "0.10");  // rounding adds a digit
  EXPECT_EQ(RoundedSd(0.004), "0.0040");
  EXPECT_EQ(RoundedSd(1.0), "1.0");
  EXPECT_EQ(RoundedSd(12.3), "12");
  EXPECT_EQ(RoundedSd(99.7), "100");
  EXPECT_EQ(RoundedSd(1234.0), "1200");
  EXPECT_EQ(RoundedSd(1.234e-12), "1.2e-12");
  EXPECT_EQ(RoundedSd(0.0), "0");
  EXPECT_EQ(RoundedSd(kInfinity), "inf");
  EXPECT_EQ(RoundedSd(kNaN), "-");
}

TEST(Figures, EstimatesEndWhereTheirStandardDeviationEnds) {
  EXPECT_EQ(RoundedTo(-2.34567, 0.0123), "-2.346");
  EXPECT_EQ(RoundedTo(2.0, 0.0123), "2.000");
  EXPECT_EQ(RoundedTo(-0.0001, 0.0123), "0.000");  // zero has no minus sign
  EXPECT_EQ(RoundedTo(17.4, 12.3), "17");
  EXPECT_EQ(RoundedTo(98765.0, 1234.0), "98800");
  EXPECT_EQ(RoundedTo(1.5e-11, 1.234e-12), "0.000000000");
  EXPECT_EQ(RoundedTo(3.14159, 0.0), "3.142");
  EXPECT_EQ(RoundedTo(3.14159, kInfinity), "3.142");
  EXPECT_EQ(RoundedTo(3.14159, kNaN), "3.142");
  EXPECT_EQ(RoundedTo(kNaN, 0.01), "-");
  EXPECT_EQ(RoundedTo(-kInfinity, 0.01), "-inf");
  EXPECT_EQ(RoundedInterval(0.5, 0.0241, 0.0123), "[0.476, 0.524]");
  EXPECT_EQ(RoundedInterval(0.5, kInfinity, kInfinity), "[-inf, inf]");
}

TEST(Figures, ListsAreCutToTheirFirstWords) {
  EXPECT_EQ(FirstOf({"a", "b", "c"}, 3), "a, b, c");
  EXPECT_EQ(FirstOf({"a", "b", "c"}, 2), "a, b and 1 more");
  EXPECT_EQ(FirstOf({}, 2), "");
}

TEST(WarningGroups, TheSameOfSeveralMarkersIsOneLine) {
  const std::vector<std::string> warnings = {
      "trial arm_left: LHAND_1 was lost for 12 % of the time, at most 3.1 s on end",
      "only 40 of 42 parameters are identifiable; see inspect for what is not",
      "trial arm_left: LHAND_2 was lost for 31 % of the time, at most 4.0 s on end",
      "trial head: LHAND_1 was lost for 15 % of the time, at most 3.1 s on end",
      "trial head: not used: the log is empty",
  };
  const std::vector<std::string> expected = {
      "trial arm_left: LHAND_1 was lost for 12 % of the time, at most 3.1 s on end (likewise "
      "LHAND_2, head)",
      warnings[1], warnings[4]};
  EXPECT_EQ(GroupWarnings(warnings), expected);
}

TEST(WarningGroups, ListsOfAnyLengthAreAlike) {
  const std::vector<std::string> expected = {
      "trial a: no torques were logged of j_1, j_2 (likewise b j_3, c j_4 j_5)"};
  EXPECT_EQ(GroupWarnings({"trial a: no torques were logged of j_1, j_2",
                           "trial b: no torques were logged of j_1, j_2, j_3",
                           "trial c: no torques were logged of j_1, j_4, j_5 and 3 more"}),
            expected);
}

TEST(WarningGroups, TheNameOfAFileMayHaveBlanks) {
  EXPECT_EQ(GroupWarnings({"day 2/arm A-B.csv:45: the row comes twice",
                           "day 2/arm A-C.csv:7: the row comes twice"}),
            std::vector<std::string>{
                "day 2/arm A-B.csv:45: the row comes twice (likewise day 2/arm A-C.csv:7)"});
  // The place may be in the middle of the sentence.
  EXPECT_EQ(GroupWarnings({"left out: hand_x in day 2/arm A-B.csv:45 (9 mm)",
                           "left out: hand_x in day 3/arm A-C.csv:7 (8 mm)"}),
            std::vector<std::string>{"left out: hand_x in day 2/arm A-B.csv:45 (9 mm) (likewise "
                                     "day 3/arm A-C.csv:7)"});
  // Words that are no file are compared one by one.
  EXPECT_EQ(GroupWarnings({"joint arm.left: it is late", "joint arm.right: it is late"}),
            std::vector<std::string>{"joint arm.left: it is late (likewise arm.right)"});
}

// Names in a robot need not have digits or underscores.
TEST(WarningGroups, NamesWithDotsAndDashesAreNames) {
  EXPECT_EQ(GroupWarnings({"the axes of L.knee, L.ankle-pitch are no longer parallel (0.6 deg)",
                           "the axes of R.knee, R.ankle-pitch are no longer parallel (0.4 deg)"}),
            std::vector<std::string>{"the axes of L.knee, L.ankle-pitch are no longer parallel "
                                     "(0.6 deg) (likewise R.knee R.ankle-pitch)"});
}

TEST(WarningGroups, RepeatedSentencesAreCounted) {
  EXPECT_EQ(GroupWarnings({"17 outlying positions removed", "12 outlying positions removed"}),
            std::vector<std::string>{"17 outlying positions removed (2 times)"});
  EXPECT_TRUE(GroupWarnings({}).empty());
}

TEST(WarningGroups, OtherSentencesStayApart) {
  const std::vector<std::string> warnings = {"marker A: is it on the right link?",
                                             "marker A: did it stay?", "cluster A: did it stay?"};
  EXPECT_EQ(GroupWarnings(warnings), warnings);
}

}  // namespace
}  // namespace elastocal::cli
