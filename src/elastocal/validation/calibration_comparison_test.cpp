// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/calibration_comparison.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

/// Three joints with theta and d each. The standard deviations are 1 mrad and 1 mm, uncorrelated
/// unless a test changes this.
CalibrationEstimate ThreeJoints(const std::string& source) {
  CalibrationEstimate estimate;
  estimate.source = source;
  estimate.robot = "robot";
  estimate.nominal = "0123456789abcdef";
  estimate.recording = source + ".csv";
  estimate.model = "geometric";
  estimate.interval_factor = StudentQuantile(0.975, 300.0);
  for (const char* joint : {"j1", "j2", "j3"}) {
    for (const char* kind : {"theta", "d"}) {
      estimate.parameters.push_back({.name = std::string(joint) + "." + kind,
                                     .unit = *kind == 't' ? "rad" : "m",
                                     .value = 0.02,
                                     .sd = 1e-3});
      estimate.covariance_names.push_back(estimate.parameters.back().name);
    }
  }
  estimate.parameters.push_back(
      {.name = "marker.M.x", .unit = "m", .external = true, .value = 1.0, .sd = 1e-6});
  estimate.covariance = 1e-6 * Eigen::MatrixXd::Identity(6, 6);
  return estimate;
}

class CalibrationComparisonTest : public ::testing::Test {
 protected:
  CalibrationComparison Compared() const { return CompareCalibrations(a_, b_, {}); }

  CalibrationEstimate a_ = ThreeJoints("A"), b_ = ThreeJoints("B");
};

TEST_F(CalibrationComparisonTest, NothingMoved) {
  b_.parameters[0].value += 1e-3;
  b_.parameters[6].value += 1.0;  // markers are no part of the robot
  const CalibrationComparison comparison = Compared();
  EXPECT_FALSE(comparison.changed);
  EXPECT_TRUE(comparison.suspects.empty());
  EXPECT_TRUE(comparison.warnings.empty());
  ASSERT_EQ(comparison.parameters.size(), 6u);
  for (const JointDifference& joint : comparison.joints) EXPECT_FALSE(joint.moved);
}

TEST_F(CalibrationComparisonTest, IntervalAndTestByHand) {
  b_.parameters[2].value += 6e-3;  // j2.theta
  const CalibrationComparison comparison = Compared();
  const ParameterDifference& theta = comparison.parameters[2];
  EXPECT_EQ(theta.name, "j2.theta");
  EXPECT_NEAR(theta.difference, 6e-3, 1e-15);
  EXPECT_NEAR(theta.sd, std::sqrt(2.0) * 1e-3, 1e-15);
  EXPECT_NEAR(theta.degrees_of_freedom, 600.0, 1e-3);  // of two equal variances with 300 each
  EXPECT_NEAR(theta.half_width, theta.sd * StudentQuantile(0.975, 600.0), 1e-12);
  EXPECT_TRUE(theta.significant());
  const JointDifference& first = comparison.joints[0];
  EXPECT_EQ(first.joint, "j2");
  EXPECT_TRUE(first.moved);
  EXPECT_NEAR(first.test.statistic, 36.0 / 2.0 / 2.0, 1e-9);
  EXPECT_NEAR(first.p_adjusted, 3.0 * FisherUpperTail(9.0, 2, 600.0), 1e-9);
  EXPECT_EQ(first.parameters, (std::vector<int>{2, 3}));
  EXPECT_TRUE(comparison.changed);
  EXPECT_FALSE(comparison.joints[1].moved);
  EXPECT_FALSE(comparison.joints[2].moved);
}

// Each parameter of j1 is within its own interval. Together they contradict their correlation.
TEST_F(CalibrationComparisonTest, AJointIsTestedAsAWhole) {
  for (CalibrationEstimate* side : {&a_, &b_}) {
    side->covariance(0, 1) = side->covariance(1, 0) = 0.99e-6;
  }
  b_.parameters[0].value += 1e-3;
  b_.parameters[1].value -= 1e-3;
  const CalibrationComparison comparison = Compared();
  EXPECT_FALSE(comparison.parameters[0].significant());
  EXPECT_FALSE(comparison.parameters[1].significant());
  EXPECT_EQ(comparison.joints[0].joint, "j1");
  EXPECT_TRUE(comparison.joints[0].moved);
  // Without the covariances of both this cannot be seen.
  a_.covariance_names.clear();
  const CalibrationComparison blind = Compared();
  EXPECT_FALSE(blind.with_covariance);
  EXPECT_FALSE(blind.changed);
  EXPECT_TRUE(std::isnan(blind.joints[0].test.statistic));
  ASSERT_EQ(blind.warnings.size(), 1u);
  EXPECT_NE(blind.warnings[0].find("covariance.csv"), std::string::npos);
}

// The data tell the difference of j1.theta and j2.theta, but hardly their sum.
TEST_F(CalibrationComparisonTest, SuspectsWhereNoJointCanBeSingledOut) {
  for (CalibrationEstimate* side : {&a_, &b_}) {
    side->covariance(0, 2) = side->covariance(2, 0) = 0.999e-6;
  }
  b_.parameters[0].value += 0.5e-3;
  const CalibrationComparison comparison = Compared();
  EXPECT_TRUE(comparison.changed);
  for (const JointDifference& joint : comparison.joints) EXPECT_FALSE(joint.moved) << joint.joint;
  EXPECT_EQ(comparison.suspects, (std::vector<std::string>{"j1", "j2"}));
}

TEST_F(CalibrationComparisonTest, WithoutCovarianceBonferroniWithinAJoint) {
  a_.covariance_names.clear();
  b_.covariance_names.clear();
  b_.parameters[5].value += 6e-3;
  const CalibrationComparison comparison = Compared();
  EXPECT_EQ(comparison.joints[0].joint, "j3");
  EXPECT_TRUE(comparison.joints[0].moved);
  EXPECT_NEAR(comparison.joints[0].test.p, 2.0 * comparison.parameters[5].p, 1e-15);
  EXPECT_NEAR(comparison.overall.p, 6.0 * comparison.parameters[5].p, 1e-15);
}

TEST_F(CalibrationComparisonTest, Warnings) {
  b_.recording = a_.recording;
  b_.model = "offsets_only";
  b_.parameters[3].status = ParameterStatus::kHeld;
  b_.parameters[3].value = 0.02;
  const CalibrationComparison comparison = Compared();
  ASSERT_EQ(comparison.warnings.size(), 3u);
  EXPECT_NE(comparison.warnings[0].find("A.csv"), std::string::npos);
  EXPECT_NE(comparison.warnings[1].find("offsets_only"), std::string::npos);
  EXPECT_NE(comparison.warnings[2].find("A alone estimates j2.d: "), std::string::npos);
}

// Only B has a cause, which explains 3 mrad of j1.theta. Without this cause, both agree.
TEST_F(CalibrationComparisonTest, UnderWhatBothModelsHave) {
  b_.parameters.push_back({.name = "j1.gear", .unit = "1", .value = 5e-3, .sd = 1e-3});
  b_.covariance_names.emplace_back("j1.gear");
  b_.covariance.conservativeResize(7, 7);
  b_.covariance.row(6).setZero();
  b_.covariance.col(6).setZero();
  b_.covariance(6, 6) = 1e-6;
  b_.covariance(0, 6) = b_.covariance(6, 0) = -0.6e-6;
  b_.parameters[0].value -= 3e-3;
  b_.parameters[1].value += 1e-3;  // does not change: uncorrelated with the cause
  const CalibrationComparison comparison = Compared();
  EXPECT_NEAR(comparison.parameters[0].difference, 0.0, 1e-15);
  const double noise = (300.0 + 25.0) / (300.0 + 1.0);  // with the 5 sd that the cause explained
  EXPECT_NEAR(comparison.parameters[0].sd, std::sqrt(1e-6 + noise * (1.0 - 0.36) * 1e-6), 1e-10);
  EXPECT_NEAR(comparison.parameters[1].difference, 1e-3, 1e-15);
  EXPECT_NEAR(comparison.parameters[1].sd, std::sqrt((1.0 + noise) * 1e-6), 1e-10);
  ASSERT_EQ(comparison.warnings.size(), 1u);
  EXPECT_NE(comparison.warnings[0].find("B alone estimates j1.gear: "), std::string::npos);
  // With both exchanged, differences have the other sign.
  std::swap(a_, b_);
  const CalibrationComparison turned = Compared();
  EXPECT_NEAR(turned.parameters[0].difference, 0.0, 1e-15);
  EXPECT_NEAR(turned.parameters[1].difference, -1e-3, 1e-15);
}

// A compliance turns a joint by its load. If B has other loads than A, it means something else.
TEST_F(CalibrationComparisonTest, SpringsOnlyUnderTheSameLoads) {
  for (CalibrationEstimate* side : {&a_, &b_}) {
    side->parameters[1].name = side->covariance_names[1] = "j1.compliance_z";
  }
  EXPECT_EQ(Compared().parameters.size(), 6u);
  b_.parameters.push_back({.name = "link.mass", .unit = "kg", .value = 0.0, .sd = 1.0});
  b_.covariance_names.emplace_back("link.mass");
  b_.covariance = Eigen::Matrix<double, 7, 1>(1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 1.0).asDiagonal();
  const CalibrationComparison comparison = Compared();
  EXPECT_EQ(comparison.parameters.size(), 5u);
  ASSERT_EQ(comparison.not_compared.size(), 2u);
  EXPECT_EQ(comparison.not_compared[0].name, "link.mass");
  EXPECT_EQ(comparison.not_compared[1].name, "j1.compliance_z");
  EXPECT_NE(comparison.not_compared[1].reason.find("loads"), std::string::npos);
}

/// Adds `count` markers on j3's link. As one piece, they can be exchanged with j3.theta, which
/// moves them along y, and with j2.theta, along x, to 20 mrad. The lever is 100 mm; relative to its
/// joint, each coordinate is known to 0.05 mm.
void AddCluster(CalibrationEstimate& estimate, int count) {
  constexpr double kLever = 0.1, kTold = 5e-5, kTheta = 2e-2;
  const Eigen::Index at = estimate.covariance.rows();
  estimate.covariance.conservativeResize(at + 3 * count, at + 3 * count);
  estimate.covariance.rightCols(3 * count).setZero();
  estimate.covariance.bottomRows(3 * count).setZero();
  for (int m = 0; m < count; ++m) {
    const std::string name = "M" + std::to_string(m);
    estimate.markers.push_back({name, "link3", Eigen::Vector3d(0.0, 0.0, 0.01 * m)});
    for (const char* axis : {"x", "y", "z"}) {
      estimate.parameters.push_back({.name = "marker." + name + "." + axis,
                                     .unit = "m",
                                     .external = true,
                                     .value = 0.01,
                                     .sd = kTold});
      estimate.covariance_names.push_back(estimate.parameters.back().name);
    }
  }
  estimate.covariance.bottomRightCorner(3 * count, 3 * count).diagonal().array() += kTold * kTold;
  for (const auto& [theta, axis] : {std::pair(2, 0), std::pair(4, 1)}) {
    Eigen::VectorXd turned = Eigen::VectorXd::Zero(at + 3 * count);
    turned[theta] = 1.0;
    for (int m = 0; m < count; ++m) turned[at + 3 * m + axis] = -kLever;
    estimate.parameters[static_cast<std::size_t>(theta)].sd = kTheta;
    estimate.covariance(theta, theta) = 0.0;
    estimate.covariance += kTheta * kTheta * turned * turned.transpose();
  }
}

class MarkersOfTwoDays : public CalibrationComparisonTest {
 protected:
  void AddClusters(int count) {
    for (CalibrationEstimate* side : {&a_, &b_}) AddCluster(*side, count);
  }
  double& MarkerInB(int marker, int axis) {
    return b_.parameters[Size(7 + 3 * marker + axis)].value;
  }
  /// Turns j3 by 5 mrad. Each estimate is the most probable one, so that half of the turn appears
  /// in the markers' positions.
  void TurnJoint() {
    b_.parameters[4].value += 2.5e-3;
    for (int m = 0; 7 + 3 * m < std::ssize(b_.parameters); ++m) MarkerInB(m, 1) += 2.5e-4;
  }
};

// All differences are within their intervals. But the markers are unchanged if j3 turned.
TEST_F(MarkersOfTwoDays, ThatStayedTellOfATurnedJoint) {
  AddClusters(3);
  TurnJoint();
  const CalibrationComparison comparison = Compared();
  ASSERT_EQ(comparison.markers.size(), 1u);
  EXPECT_EQ(comparison.markers[0].link, "link3");
  EXPECT_EQ(comparison.markers[0].markers, (std::vector<std::string>{"M0", "M1", "M2"}));
  EXPECT_TRUE(comparison.markers[0].same);
  EXPECT_EQ(comparison.joints[0].joint, "j3");
  EXPECT_TRUE(comparison.joints[0].moved);
  EXPECT_FALSE(comparison.joints[1].moved);
  EXPECT_EQ(comparison.joints[0].or_markers, std::vector<std::string>{"link3"});
  EXPECT_NEAR(comparison.parameters[4].b - comparison.parameters[4].a, 2.5e-3, 1e-12);
  EXPECT_NEAR(comparison.parameters[4].difference, 5e-3, 5e-6);
  EXPECT_NEAR(comparison.parameters[4].sd, std::sqrt((2.0 * 2.5e-9 + 1e-8) / 3.0) / 0.1, 1e-6);
  // If the user states that they were taken off, nothing is known about j3.
  const CalibrationComparison anew = CompareCalibrations(a_, b_, {.new_markers = true});
  EXPECT_TRUE(anew.markers.empty());
  EXPECT_FALSE(anew.changed);
  EXPECT_NEAR(anew.parameters[4].difference, 2.5e-3, 1e-12);
}

TEST_F(MarkersOfTwoDays, GluedAnewTellNothing) {
  AddClusters(3);
  TurnJoint();
  MarkerInB(1, 0) += 1.2e-3;  // ten standard deviations
  const CalibrationComparison comparison = Compared();
  ASSERT_EQ(comparison.markers.size(), 1u);
  EXPECT_FALSE(comparison.markers[0].same);
  EXPECT_LT(comparison.markers[0].p, 1e-6);
  EXPECT_FALSE(comparison.joints[0].moved);
  EXPECT_NEAR(comparison.parameters[4].difference, 2.5e-3, 1e-12);
}

// j2 and j3 might have turned together, but one cluster that moved explains this alone.
TEST_F(MarkersOfTwoDays, MayHaveMovedAsOnePiece) {
  AddClusters(3);
  TurnJoint();
  b_.parameters[2].value += 2.5e-3;
  for (int m = 0; m < 3; ++m) MarkerInB(m, 0) += 2.5e-4;
  const CalibrationComparison comparison = Compared();
  EXPECT_FALSE(comparison.changed);
  ASSERT_EQ(comparison.markers.size(), 1u);
  EXPECT_FALSE(comparison.markers[0].same);
  EXPECT_TRUE(comparison.markers[0].as_one_piece);
  EXPECT_NEAR(comparison.parameters[2].difference, 2.5e-3, 1e-12);
}

TEST_F(MarkersOfTwoDays, ThreeOnALinkAreNeeded) {
  AddClusters(2);
  TurnJoint();
  EXPECT_TRUE(Compared().markers.empty());
  EXPECT_FALSE(Compared().changed);
}

// The second project has a marker at another place, and its estimate is relative to that place.
TEST_F(MarkersOfTwoDays, AreComparedWhereTheyAre) {
  AddClusters(3);
  TurnJoint();
  b_.markers[2].nominal.z() += 0.02;
  MarkerInB(2, 2) -= 0.02;
  EXPECT_TRUE(Compared().markers[0].same);
  EXPECT_TRUE(Compared().joints[0].moved);
  b_.markers[2].link = "link2";
  EXPECT_TRUE(Compared().markers.empty());
}

// A gauge that fixes markers leaves no uncertainty to some combinations.
TEST_F(MarkersOfTwoDays, MayDefineTheFrame) {
  AddClusters(3);
  for (CalibrationEstimate* side : {&a_, &b_}) {
    side->covariance.row(7) = side->covariance.row(6);
    side->covariance.col(7) = side->covariance.col(6);
    side->covariance(6, 7) = side->covariance(7, 6) = side->covariance(7, 7) =
        side->covariance(6, 6);
  }
  const CalibrationComparison comparison = Compared();
  ASSERT_EQ(comparison.markers.size(), 1u);
  EXPECT_TRUE(comparison.markers[0].same);
  EXPECT_FALSE(comparison.changed);
}

TEST_F(CalibrationComparisonTest, WhatCannotBeCompared) {
  const auto compare = [&] { Compared(); };
  b_.robot = "other robot";
  b_.nominal = "f";
  ExpectInputError(compare, {"A", "'robot'", "B", "'other robot'", "nominal"});
  b_ = ThreeJoints("B");
  b_.gauge = "link j1_link";
  ExpectInputError(compare, {"A has the gauge 'prior'", "B 'link j1_link'", "root link"});
  b_ = ThreeJoints("B");
  for (ParameterEstimate& parameter : b_.parameters) parameter.name = "left_" + parameter.name;
  ExpectInputError(compare, {"A", "B", "nothing"});
  b_ = ThreeJoints("B");
  b_.covariance_names[2] = "other";
  ExpectInputError(compare, {"B", "'j2.theta'"});
  b_ = ThreeJoints("B");
  b_.covariance(0, 1) = b_.covariance(1, 0) = 3e-6;
  ExpectInputError(compare, {"A, B", "positive definite"});
}

}  // namespace
}  // namespace elastocal
