// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/input_error.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

const std::vector<std::string> kJoints = {"leg_left_1_joint", "leg_left_2_joint", "torso_1_joint"};

TEST(EditDistance, CountsInsertionsDeletionsAndSubstitutions) {
  EXPECT_EQ(EditDistance("kitten", "sitting"), 3);
  EXPECT_EQ(EditDistance("flaw", "lawn"), 2);
  EXPECT_EQ(EditDistance("same", "same"), 0);
  EXPECT_EQ(EditDistance("", "abc"), 3);
  EXPECT_EQ(EditDistance("abc", ""), 3);
  EXPECT_EQ(EditDistance("", ""), 0);
  EXPECT_EQ(EditDistance("Same", "sAMe"), 0);
}

TEST(DidYouMean, NamesTheNearest) {
  EXPECT_EQ(DidYouMean("leg_left_2_jont", kJoints), "; did you mean 'leg_left_2_joint'?");
  EXPECT_EQ(DidYouMean("torso_joint", kJoints), "; did you mean 'torso_1_joint'?");
}

TEST(DidYouMean, TheFirstOfTwoEquallyNear) {
  EXPECT_EQ(DidYouMean("leg_left_3_joint", kJoints), "; did you mean 'leg_left_1_joint'?");
}

TEST(DidYouMean, TakesCapitalsForSmallLetters) {
  EXPECT_EQ(DidYouMean("LEG_LEFT_2_JOINT", kJoints), "; did you mean 'leg_left_2_joint'?");
  EXPECT_EQ(DidYouMean("left_j3", std::vector<std::string>{"left_j", "LEFT_J3"}),
            "; did you mean 'LEFT_J3'?");
}

TEST(DidYouMean, IsSilentWhereNothingIsNear) {
  EXPECT_EQ(DidYouMean("gripper", kJoints), "");
  EXPECT_EQ(DidYouMean("x", kJoints), "");
  EXPECT_EQ(DidYouMean("anything", std::vector<std::string>{}), "");
}

}  // namespace
}  // namespace elastocal
