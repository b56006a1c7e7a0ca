// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/earlier_calibration.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

JointCheck Moved(int moved, int joints) {
  JointCheck check;
  for (int k = 0; k < joints; ++k) {
    JointSuspect joint;
    joint.joint = "j" + std::to_string(k);
    (k < moved ? check.moved : check.joints).push_back(joint);
  }
  return check;
}

// Nobody repairs most joints of a robot at once, so the calibration must be that of another robot.
TEST(EarlierCalibration, MostJointsThatMovedMayBeAnotherRobot) {
  const std::vector<std::string> texts = DescribeForgotten(Moved(16, 18), "calA");
  ASSERT_EQ(texts.size(), 17U);
  EXPECT_EQ(texts[0].find("16 of 18 joints have moved since calA: another robot, or joints that"),
            0U);
  EXPECT_NE(texts[0].find("leave out --prior"), std::string::npos);
  EXPECT_EQ(texts[1].find("j0: has moved since calA"), 0U);
}

TEST(EarlierCalibration, FewJointsThatMovedAreNamedAlone) {
  EXPECT_EQ(DescribeForgotten(Moved(2, 18), "calA").size(), 2U);
  EXPECT_EQ(DescribeForgotten(Moved(2, 3), "calA").size(), 2U);
  EXPECT_EQ(AskWhereMostMoved(9, 18), "");
}

}  // namespace
}  // namespace elastocal
