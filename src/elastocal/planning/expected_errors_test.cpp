// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/expected_errors.hpp"

#include <map>

#include <gtest/gtest.h>

#include "tests/runtime_calibration.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// TALOS at rest on its left foot, with one uncertain parameter.
class ExpectedErrors : public testing::Test {
 protected:
  std::map<std::string, ExpectedAtLimb> Expect(const std::string& parameter, double sd) const {
    CalibrationEstimate estimate;
    estimate.covariance_names = {"marker.LHAND_1.x", parameter};  // a marker's is ignored
    estimate.covariance = Eigen::Vector2d(1.0, sd * sd).asDiagonal();
    JointMotion motion;
    motion.q = project_.motion.rest.transpose();
    motion.support = {{FindLink(project_.tree, "left_sole_link")}};
    std::map<std::string, ExpectedAtLimb> expected;
    for (const ExpectedAtLimb& one :
         ExpectErrors(project_, RandomCalibration(project_, 1), estimate, motion)) {
      expected.emplace(one.limb, one);
    }
    return expected;
  }

  const Project project_ = ReadProject(SourceFile("models/talos/project.yaml"));
};

TEST_F(ExpectedErrors, OfAStandingFootAreThoseOfAllThatItCarries) {
  const auto expected = Expect("leg_left_6_joint.r", 2e-3);
  EXPECT_EQ(expected.count("leg_left"), 0u);  // all errors are relative to this foot
  for (const char* limb : {"head_trunk", "arm_left", "arm_right", "leg_right", "base_link"}) {
    ASSERT_EQ(expected.count(limb), 1u) << limb;
    EXPECT_NEAR(expected.at(limb).position, 2e-3, 1e-8) << limb;
    EXPECT_NEAR(expected.at(limb).attitude, 0.0, 1e-8) << limb;
  }
}

TEST_F(ExpectedErrors, OfTheZeroOfAWristAreThoseOfItsHand) {
  const auto expected = Expect("arm_left_7_joint.theta", 0.01);
  EXPECT_NEAR(expected.at("arm_left").attitude, 0.01, 1e-6);
  EXPECT_GT(expected.at("arm_left").position, 0.0);
  for (const char* limb : {"head_trunk", "arm_right", "leg_right", "base_link"}) {
    EXPECT_NEAR(expected.at(limb).position, 0.0, 1e-9) << limb;
    EXPECT_NEAR(expected.at(limb).attitude, 0.0, 1e-9) << limb;
  }
}

// A robot with soles may be held while its arms move.
TEST_F(ExpectedErrors, AreSeenFromTheRootLinkWhereNoFootStands) {
  JointMotion motion;
  motion.q = project_.motion.rest.transpose().replicate(2, 1);
  EXPECT_TRUE(IsSeenFromAFoot(project_, motion));
  motion.support = {{}, {}};
  EXPECT_FALSE(IsSeenFromAFoot(project_, motion));
  motion.support[1] = {FindLink(project_.tree, "left_sole_link")};
  EXPECT_TRUE(IsSeenFromAFoot(project_, motion));
}

TEST_F(ExpectedErrors, AreNotKnownWithoutACovariance) {
  JointMotion motion;
  motion.q = project_.motion.rest.transpose();
  EXPECT_TRUE(ExpectErrors(project_, RandomCalibration(project_, 1), {}, motion).empty());
}

}  // namespace
}  // namespace elastocal
