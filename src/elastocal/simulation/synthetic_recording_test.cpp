// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/synthetic_recording.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/robot/kinematics.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

TEST(DrawErrors, OnlyTheGivenParametersOfTheGivenKinds) {
  const ErrorModel leg = TalosLegModel();
  const std::vector<int> parameters = MatchParameters(leg.parameters, {"leg_2.*", "marker.*"});
  const Eigen::VectorXd delta = DrawErrors(
      leg, parameters, {{ParameterKind::kTheta, 0.01}, {ParameterKind::kMarker, 1.0}}, 1);
  ASSERT_EQ(delta.size(), leg.parameter_count());
  for (int i = 0; i < leg.parameter_count(); ++i) {
    const Parameter& p = leg.parameters[i];
    const bool drawn = p.name == "leg_2.theta" || p.kind == ParameterKind::kMarker;
    EXPECT_EQ(delta[i] != 0.0, drawn) << p.name;
  }
}

TEST(DrawErrors, HaveTheStandardDeviationOfTheirKind) {
  const ErrorModel leg = TalosLegModel();
  const std::vector<int> markers = MatchParameters(leg.parameters, {"marker.*"});
  double sum = 0.0;
  const int seeds = 1000;
  for (int seed = 0; seed < seeds; ++seed) {
    sum += DrawErrors(leg, markers, {{ParameterKind::kMarker, 0.01}}, seed).squaredNorm();
  }
  const double count = 27.0 * seeds;
  // The tolerance is 5 standard deviations of a mean square of n numbers, sqrt(2 / n) each.
  EXPECT_NEAR(sum / count / 1e-4, 1.0, 5.0 * std::sqrt(2.0 / count));
}

TEST(SyntheticRecording, IsForwardKinematicsWithoutNoise) {
  ErrorModel leg = TalosLegModel();
  leg.T_ref_waist = Offset(1, 2, 3) * RotX(0.3);
  std::vector<int> all = MatchParameters(leg.parameters, {"*"});
  const Eigen::VectorXd delta =
      DrawErrors(leg, all, {{ParameterKind::kTheta, 0.01}, {ParameterKind::kMarker, 0.01}}, 1);
  const Recording recording =
      MakeSyntheticRecording(leg, delta, {.postures = 20, .marker_sd = 0.0});
  ASSERT_EQ(recording.posture_count(), 20);
  ASSERT_EQ(recording.marker_count(), 9);
  EXPECT_EQ(recording.marker_names[3], "SHANK_1");
  const Geometry truth = ApplyErrors(leg, delta);
  for (int i = 0; i < 20; ++i) {
    const Eigen::VectorXd q = recording.q.row(i).transpose();
    const Eigen::Matrix3Xd expected = MarkerPositions(leg, truth, q);
    for (int k = 0; k < 6; ++k) {
      EXPECT_GE(q[k], leg.tree.joints[k].limits.lower);
      EXPECT_LE(q[k], leg.tree.joints[k].limits.upper);
    }
    for (int m = 0; m < 9; ++m) {
      EXPECT_EQ(MarkerPosition(recording, i, m), expected.col(m));
    }
  }
}

TEST(SyntheticRecording, NoiseHasTheGivenLevelAndLeavesThePosturesAlone) {
  const ErrorModel leg = TalosLegModel();
  const Eigen::VectorXd nominal = Eigen::VectorXd::Zero(leg.parameter_count());
  const Recording exact = MakeSyntheticRecording(leg, nominal, {.postures = 400, .marker_sd = 0.0});
  const Recording noisy =
      MakeSyntheticRecording(leg, nominal, {.postures = 400, .marker_sd = 3e-4});
  EXPECT_EQ(exact.q, noisy.q);
  const Eigen::ArrayXXd noise = (noisy.markers - exact.markers).array() / 3e-4;
  const auto count = static_cast<double>(noise.size());
  // Tolerances are 5 standard errors of mean 0 and variance 1.
  EXPECT_NEAR(noise.mean(), 0.0, 5.0 / std::sqrt(count));
  EXPECT_NEAR(noise.square().mean(), 1.0, 5.0 * std::sqrt(2.0 / count));
}

TEST(SyntheticRecording, TheSameSeedGivesTheSameRecording) {
  const ErrorModel leg = TalosLegModel();
  const Eigen::VectorXd nominal = Eigen::VectorXd::Zero(leg.parameter_count());
  const Recording a = MakeSyntheticRecording(leg, nominal, {.seed = 3});
  const Recording b = MakeSyntheticRecording(leg, nominal, {.seed = 3});
  const Recording c = MakeSyntheticRecording(leg, nominal, {.seed = 4});
  EXPECT_EQ(a.markers, b.markers);
  EXPECT_NE(a.markers, c.markers);
  EXPECT_EQ(a.posture_count(), 60);
}

}  // namespace
}  // namespace elastocal
