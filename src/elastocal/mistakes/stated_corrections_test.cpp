// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/stated_corrections.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/project/project.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

class StatedCorrections : public testing::Test {
 protected:
  StatedCorrections() {
    Recording& recording = measured_.calibration;
    recording.trials = {{"a", TrialKind::kCalibration, {}}, {"b", TrialKind::kCalibration, {}}};
    recording.trial = {0, 1};
    recording.q = Eigen::MatrixXd::Ones(2, project_.tree.coordinate_count());
    recording.markers = Eigen::MatrixXd::Ones(2, 3);
    measured_.validation = recording;
    measured_.validation.trials[0].name = "c";
  }

  int Coordinate() const {
    for (const auto& joint : project_.tree.joints) {
      if (joint.name == "turret_joint") return joint.coordinate;
    }
    return -1;
  }

  std::string Apply(const std::string& name) {
    const auto correction = ParseStatedCorrection(name, project_.tree);
    EXPECT_TRUE(correction.has_value()) << name;
    return ApplyCorrection(*correction, project_.tree, measured_);
  }

  Project project_ = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  Measurements measured_;
};

TEST_F(StatedCorrections, AreDoneWhereTheySay) {
  const int joint = Coordinate();
  EXPECT_EQ(Apply("gain:turret_joint=1.25"),
            "the positions of turret_joint were divided by 1.25: all figures are of positions so "
            "divided; where the robot has this gain, and not the log alone, its controller has to "
            "divide them too");
  EXPECT_DOUBLE_EQ(measured_.calibration.q(0, joint), 0.8);
  EXPECT_DOUBLE_EQ(measured_.validation.q(1, joint), 0.8);
  EXPECT_EQ(Apply("offset:turret_joint@b=-18"),
            "-18 deg were taken from the positions of turret_joint in trial b");
  EXPECT_DOUBLE_EQ(measured_.calibration.q(0, joint), 0.8);
  EXPECT_DOUBLE_EQ(measured_.calibration.q(1, joint), 0.8 + 0.1 * M_PI);
  EXPECT_DOUBLE_EQ(measured_.validation.q(1, joint), 0.8 + 0.1 * M_PI);
  EXPECT_DOUBLE_EQ(measured_.calibration.q(1, joint - 1), 1.0);
  EXPECT_EQ(Apply("scale:c=0.5"), "the cameras' positions in trial c were divided by 0.5");
  EXPECT_DOUBLE_EQ(measured_.validation.markers(0, 1), 2.0);
  EXPECT_DOUBLE_EQ(measured_.validation.markers(1, 1), 1.0);
  EXPECT_DOUBLE_EQ(measured_.calibration.markers(0, 1), 1.0);
  measured_.trials.resize(1);
  measured_.trials[0].scale = MeasuredScale{0.25, 0.01};
  measured_.foot_rests = {{.link = 0, .session = 0, .trial = 0}};
  measured_.foot_rests[0].at = Eigen::Matrix3Xd::Ones(3, 1);
  EXPECT_EQ(Apply("scale=1.25"), "the cameras' positions were divided by 1.25");
  EXPECT_DOUBLE_EQ(measured_.calibration.markers(0, 1), 0.8);
  EXPECT_DOUBLE_EQ(measured_.validation.markers(0, 1), 1.6);
  EXPECT_DOUBLE_EQ(measured_.trials[0].scale->size, 0.0) << "what the reference lengths say then";
  EXPECT_DOUBLE_EQ(measured_.foot_rests[0].at(2, 0), 0.8) << "where the feet stood";
}

// If a correction applies to all trials that judge, nothing confirms that the robot's log is right
// now.
TEST_F(StatedCorrections, OfAllTrialsThatJudgeConfirmNothing) {
  const auto trials = [&](const std::vector<std::string>& names, TrialKind kind) {
    Recording recording = measured_.calibration;
    recording.trials.clear();
    recording.trial.clear();
    for (const std::string& name : names) {
      recording.trial.insert(recording.trial.end(), 2, static_cast<int>(recording.trials.size()));
      recording.trials.push_back({name, kind, {}});
    }
    const auto rows = static_cast<Eigen::Index>(2 * names.size());
    recording.q = Eigen::MatrixXd::Zero(rows, project_.tree.coordinate_count());
    for (Eigen::Index i = 1; i < rows; i += 2) recording.q.row(i).setConstant(0.5);
    recording.markers = Eigen::MatrixXd::Ones(rows, 3);
    recording.marker_names = {project_.markers.back().name};
    return recording;
  };
  measured_.calibration = trials({"a", "b"}, TrialKind::kCalibration);
  measured_.validation = trials({"c", "d"}, TrialKind::kRandom);
  const auto objections = [&](const std::vector<std::string>& names) {
    return UnconfirmedCorrections(names, project_, measured_);
  };
  const std::string in_c = "offset:turret_joint@c=2", in_d = "offset:turret_joint@d=2";
  const std::vector<std::string> found = objections({in_c, in_d});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].find("turret_joint: its positions are corrected in all trials for validation"),
            0u)
      << found[0];
  EXPECT_NE(found[0].find("(c, d)"), std::string::npos) << found[0];
  EXPECT_TRUE(objections({in_c}).empty());                      // trial d confirms the estimate
  EXPECT_TRUE(objections({"gain:turret_joint=1.05"}).empty());  // a gain is wrong in the whole log
  EXPECT_TRUE(objections({"offset:turret_joint@a=2", "offset:turret_joint@b=2"}).empty());
  EXPECT_TRUE(objections({"sign:turret_joint"}).empty());
  const std::vector<std::string> scale = objections({"scale:c=1.005", "scale:d=1.005"});
  ASSERT_EQ(scale.size(), 1u);
  EXPECT_EQ(scale[0].find("the scale of the cameras is corrected in all trials for validation (c, "
                          "d), and not in those of the estimate (a, b)"),
            0u)
      << scale[0];
  EXPECT_TRUE(objections({"scale:c=1.005"}).empty());  // trial d confirms the estimate
  EXPECT_TRUE(objections({"scale=1.005"}).empty());
  EXPECT_TRUE(objections({"scale:a=0.995", "scale:b=0.995"}).empty());
  measured_.trials.resize(2);
  for (const int k : {0, 1}) {
    measured_.trials[Size(k)].trial.name = k == 0 ? "c" : "d";
    measured_.trials[Size(k)].scale = MeasuredScale{0.0, 1e-4};
  }
  EXPECT_TRUE(objections({"scale:c=1.005", "scale:d=1.005"}).empty()) << "known lengths tell it";
  measured_.validation.markers.bottomRows(2).setConstant(std::nan(""));
  EXPECT_EQ(objections({in_c}).size(), 1u) << "d moves the joint, but no camera sees it there";
}

TEST_F(StatedCorrections, HaveTheNamesThatFaultsAreGiven) {
  const Recording& recording = measured_.calibration;
  const auto name = [&](const RecordingFault& fault) {
    return NameOfCorrection(fault, project_.tree, recording);
  };
  EXPECT_EQ(name({FaultKind::kJointGain, Coordinate(), -1, 0, 0.05}), "gain:turret_joint=1.05000");
  EXPECT_EQ(name({FaultKind::kCameraScale, -1, 1, 0, -0.004}), "scale:b=0.99600");
  const RecordingFault offset{FaultKind::kJointOffset, Coordinate(), 0, 0, 0.1 * M_PI};
  ASSERT_EQ(name(offset), "offset:turret_joint@a=18.0000");
  EXPECT_NEAR(ParseStatedCorrection(*name(offset), project_.tree)->size, offset.size, 1e-12);
}

// The offset begins in the second posture of trial a, and applies to all of trial b.
TEST_F(StatedCorrections, OfAnOffsetFromAPostureOnHaveANameForEachTrial) {
  Recording& recording = measured_.calibration;
  recording.trial = {0, 0, 0, 1, 1};
  recording.q = Eigen::MatrixXd::Ones(5, project_.tree.coordinate_count());
  recording.markers = Eigen::MatrixXd::Ones(5, 3);
  const RecordingFault fault{FaultKind::kJointOffset, Coordinate(), -1, 1, 0.1 * M_PI};
  ASSERT_EQ(NameOfCorrection(fault, project_.tree, recording),
            "offset:turret_joint@a:2=18.0000 offset:turret_joint@b=18.0000");
  const RecordingFault in_a{FaultKind::kJointOffset, Coordinate(), 0, 1, 0.1 * M_PI};
  EXPECT_EQ(NameOfCorrection(in_a, project_.tree, recording), "offset:turret_joint@a:2=18.0000");
  EXPECT_NE(DescribeFault(in_a, project_.tree, recording).find("posture 2 to the end of the trial"),
            std::string::npos);
  EXPECT_EQ(Apply("offset:turret_joint@a:2=18"),
            "18 deg were taken from the positions of turret_joint in trial a from posture 2 on");
  Apply("offset:turret_joint@b=18");
  const double left = 1.0 - 0.1 * M_PI;
  Eigen::VectorXd expected(5);
  expected << 1.0, left, left, left, left;
  EXPECT_LT((recording.q.col(Coordinate()) - expected).cwiseAbs().maxCoeff(), 1e-12);
  ExpectInputError([&] { Apply("offset:turret_joint@a:4=1"); }, {"trial 'a'", "3 postures", "4"});
  for (const char* wrong : {"0", "1.5", "x", ""}) {
    ExpectInputError([&] { Apply("offset:turret_joint@a:" + std::string(wrong) + "=1"); },
                     {"of a posture"});
  }
}

TEST_F(StatedCorrections, OfATableAnOffsetIsFromAPostureOn) {
  Recording& table = measured_.calibration;
  table.trials.clear();
  table.trial.clear();
  table.q = Eigen::MatrixXd::Ones(3, project_.tree.coordinate_count());
  table.markers = Eigen::MatrixXd::Ones(3, 3);
  measured_.validation = {};
  const RecordingFault fault{FaultKind::kJointOffset, Coordinate(), -1, 1, 0.1 * M_PI};
  EXPECT_EQ(NameOfCorrection(fault, project_.tree, table), "offset:turret_joint:2=18.0000");
  RecordingFault other = fault;
  other.end = 2;
  EXPECT_EQ(NameOfCorrection(other, project_.tree, table),
            "offset:turret_joint:2=18.0000 offset:turret_joint:3=-18.0000");
  other.kind = FaultKind::kJointDrift;
  EXPECT_FALSE(NameOfCorrection(other, project_.tree, table).has_value());
  EXPECT_EQ(Apply("offset:turret_joint:2=18"),
            "18 deg were taken from the positions of turret_joint from posture 2 on");
  const Eigen::Vector3d expected(1.0, 1.0 - 0.1 * M_PI, 1.0 - 0.1 * M_PI);
  EXPECT_LT((table.q.col(Coordinate()) - expected).norm(), 1e-12);
  ExpectInputError([&] { Apply("offset:turret_joint:4=1"); }, {"the table", "3 postures", "4"});
}

TEST_F(StatedCorrections, NamesThatSayNothingAreRefused) {
  EXPECT_FALSE(ParseStatedCorrection("sign:turret_joint", project_.tree).has_value());
  const auto refused = [&](const std::string& name, const std::string& why) {
    ExpectInputError([&] { Apply(name); }, {why});
  };
  refused("gain:turret_joint", "was expected");
  refused("gain", "was expected");
  refused("gain:arm_9_joint=1.1", "no moving joint 'arm_9_joint'");
  refused("gain:turret_joint=", "'' is not a number");
  refused("gain:turret_joint=2.5", "0.5 to 2");
  refused("scale:a=0", "0.5 to 2");
  refused("scale=3", "0.5 to 2");
  refused("scale=", "'' is not a number");
  refused("offset:turret_joint=1", "error of the robot");
  refused("offset:turret_joint:2=1", "the recording has trials");
  refused("offset:turret_joint@a=61", "-60 to 60 deg");
  refused("offset:turret_joint@d=1", "trials: a, b, c");
}

}  // namespace
}  // namespace elastocal
