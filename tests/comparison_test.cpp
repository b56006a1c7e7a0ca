// SPDX-License-Identifier: Apache-2.0
// Comparison of two calibrations of a simulated robot, by their files: false alarms, detections,
// and whether the named joint is the one that moved.

#include <gtest/gtest.h>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/covariance_file.hpp"
#include "elastocal/validation/calibration_comparison.hpp"
#include "tests/invented_arm.hpp"
#include "tests/scratch_folder.hpp"

namespace elastocal {
namespace {

class ComparisonOfCalibrations : public InventedArm {
 protected:
  static constexpr int kPairs = 40;

  /// Reduces the range of each joint to this part, so that it is badly excited.
  void Narrow(double part) {
    for (Joint& joint : model_.tree.joints) {
      const double middle = 0.5 * (joint.limits.lower + joint.limits.upper);
      const double half = 0.5 * part * (joint.limits.upper - joint.limits.lower);
      joint.limits.lower = middle - half;
      joint.limits.upper = middle + half;
    }
  }

  CalibrationEstimate Calibrated(const Eigen::VectorXd& truth, int postures, int seed) const {
    Recording recording = MakeSyntheticRecording(
        model_, truth, {.postures = postures, .seed = static_cast<std::uint64_t>(seed)});
    recording.source = "recording " + std::to_string(seed);
    const CalibrationResult result = Calibrate(model_, recording, base_, ModelKind::kGeometric, {});
    CalibrationEstimate estimate = ReadEstimate(scratch_.Write(
        "calibration.yaml", MakeCalibrationYaml(result, recording.source, ZeroOffsets::kOrigin)));
    ReadCovariance(scratch_.Write("covariance.csv", MakeCovarianceCsv(result)), estimate);
    return estimate;
  }

  /// Compares kPairs pairs. In each of them, the parameter (empty: none) changes by `change`.
  void CompareAll(int postures, const std::string& parameter, double change) {
    for (int pair = 0; pair < kPairs; ++pair) {
      const Eigen::VectorXd truth = Truth(pair, 2e-3);
      Eigen::VectorXd later = truth;
      if (!parameter.empty()) later[FindParameter(model_.parameters, parameter)] += change;
      const CalibrationComparison comparison = CompareCalibrations(
          Calibrated(truth, postures, 2 * pair + 1), Calibrated(later, postures, 2 * pair + 2), {});
      bool false_alarm = false;
      for (const JointDifference& joint : comparison.joints) {
        const bool is_it = joint.joint + ".theta" == parameter;
        if (is_it && joint.moved) ++found_;
        if (!is_it && joint.moved) false_alarm = true;
      }
      false_alarms_ += false_alarm ? 1 : 0;
      for (const ParameterDifference& one : comparison.parameters) {
        const double truth_difference = one.name == parameter ? change : 0.0;
        covered_ += std::abs(one.difference - truth_difference) <= one.half_width ? 1 : 0;
        ++intervals_;
      }
    }
    RecordProperty("found", found_);
    RecordProperty("false_alarms", false_alarms_);
    RecordProperty("covered_per_mille", 1000 * covered_ / intervals_);
  }

  ScratchFolder scratch_;
  int found_ = 0, false_alarms_ = 0, covered_ = 0, intervals_ = 0;
};

// 2 (5 %) of 40 pairs are expected; the probability of 7 or more is 0.3 %.
constexpr int kMostFalseAlarms = 6;

TEST_F(ComparisonOfCalibrations, UnchangedRobotsAreSeldomCalledChanged) {
  CompareAll(30, "", 0.0);
  EXPECT_LE(false_alarms_, kMostFalseAlarms);
  EXPECT_GE(covered_, 0.94 * intervals_);
}

TEST_F(ComparisonOfCalibrations, TheJointThatMovedIsNamedAndNoOther) {
  CompareAll(30, "elbow_joint.theta", 0.2 * kDegree);
  EXPECT_EQ(found_, kPairs);
  EXPECT_LE(false_alarms_, kMostFalseAlarms);
  EXPECT_GE(covered_, 0.94 * intervals_);
}

// These postures hardly tell joints apart, so that much of the change is attributed to others. They
// are not accused, because the test accounts for the pull of the prior.
TEST_F(ComparisonOfCalibrations, BadlyExcitedJointsAreNotAccused) {
  Narrow(0.05);
  CompareAll(12, "elbow_joint.theta", 2.0 * kDegree);
  EXPECT_EQ(found_, kPairs);
  EXPECT_LE(false_alarms_, kMostFalseAlarms);
}

}  // namespace
}  // namespace elastocal
