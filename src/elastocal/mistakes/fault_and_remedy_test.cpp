// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "elastocal/mistakes/general_fault.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

class FaultAndRemedyOfASlide : public testing::Test {
 protected:
  FaultAndRemedyOfASlide() {
    AddJoint(tree_, "lift", 0, Transform::Identity(), Eigen::Vector3d::UnitZ(),
             JointType::kPrismatic);
    AddJoint(tree_, "elbow", 1, Offset(0, 0, 0.3), Eigen::Vector3d::UnitY());
    recording_.trials = {{"a", TrialKind::kCalibration, {}}, {"b", TrialKind::kCalibration, {}}};
    recording_.trial = {0, 1};
    recording_.q = Eigen::MatrixXd::Ones(2, 2);
  }

  RobotTree tree_ = MakeRoot();
  Recording recording_;
};

// A wrong scale of the cameras looks like the gain of a slide, in one trial as in all, and beside
// other faults as well.
TEST_F(FaultAndRemedyOfASlide, MayBeTheScaleOfTheCameras) {
  const auto has = [](const std::string& said, const std::string& part) {
    EXPECT_NE(said.find(part), std::string::npos) << said;
  };
  const RecordingFault in_all{FaultKind::kJointGain, 0, -1, 0, 0.005, 1e-4};
  const RecordingFault in_b{FaultKind::kJointGain, 0, 1, 0, 0.005, 1e-4};
  const RecordingFault offset{FaultKind::kJointOffset, 1, 0, 0, 0.02, 1e-4};
  const std::string all = FaultAndRemedy(in_all, tree_, recording_);
  has(all,
      "(--accept gain:lift=1.00500 corrects it; if its scale is right, the cameras' is 0.9950 "
      "times the true one, which --accept scale=0.99502 corrects: measure a known length)");
  const std::string one = FaultAndRemedy(in_b, tree_, recording_);
  has(one,
      "(--accept gain:lift@b=1.00500 corrects it; if its scale is right, the cameras' is "
      "0.9950 times the true one in trial b, which --accept scale:b=0.99502 corrects");
  const std::string two = FaultsAndRemedies({in_b, offset}, tree_, recording_);
  has(two,
      "(--accept gain:lift@b=1.00500 offset:elbow@a=1.1459 corrects them; if lift's scale is "
      "right, the cameras' is 0.9950 times the true one in trial b");
  EXPECT_EQ(FaultAndRemedy(offset, tree_, recording_).find("scale"), std::string::npos);
}

}  // namespace
}  // namespace elastocal
