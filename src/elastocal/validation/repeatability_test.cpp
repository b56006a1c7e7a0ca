// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/repeatability.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

const std::vector<int> kWaist = {0, 1};
const std::vector<int> kHand = {2, 3};

/// Adds a posture of one joint, with two markers at the waist about the origin and two about a
/// point that is `distance` away along x.
void Add(Recording& recording, double q, double distance, double time_s) {
  recording.marker_names = {"W_1", "W_2", "H_1", "H_2"};
  const Eigen::Index i = recording.q.rows();
  recording.q.conservativeResize(i + 1, 1);
  recording.q(i, 0) = q;
  recording.markers.conservativeResize(i + 1, 12);
  recording.markers.row(i) << 0, 0.1, 0, 0, -0.1, 0, distance, 0, 0.2, distance, 0, -0.2;
  recording.time_s.conservativeResize(i + 1);
  recording.time_s[i] = time_s;
}

Repeatability Assessed(const Recording& recording) {
  return AssessRepeatability(recording, kWaist, kHand, {});
}

// Posture 0.1 at 1.0 m, then posture 0.5, three times each. One of these repetitions has two
// samples.
Recording ThreeCycles() {
  Recording recording;
  Add(recording, 0.1, 1.000, 0.0);
  Add(recording, 0.5, 0.800, 5.0);
  Add(recording, 0.1, 1.001, 10.0);
  Add(recording, 0.1, 1.003, 10.5);  // the same hold: its mean is 1.002
  Add(recording, 0.5, 0.803, 15.0);
  Add(recording, 0.1, 1.004, 20.0);
  Add(recording, 0.5, 0.800, 25.0);
  Add(recording, 0.9, 0.500, 30.0);  // not repeated
  return recording;
}

TEST(Repeatability, ByHand) {
  const Repeatability result = Assessed(ThreeCycles());
  ASSERT_EQ(result.postures.size(), 2u);
  EXPECT_EQ(result.postures[0].samples, (std::vector<std::vector<int>>{{0}, {2, 3}, {5}}));
  EXPECT_LT((result.postures[0].distances - Eigen::Vector3d(1.0, 1.002, 1.004)).norm(), 1e-15);
  EXPECT_EQ(result.repetitions, 6);
  EXPECT_EQ(result.not_repeated, 1);
  EXPECT_EQ(result.left_out, 0);
  // The deviations in mm are 2, 0, 2 and 1, 2, 1.
  EXPECT_NEAR(result.mean_deviation, 8.0 / 6.0 * 1e-3, 1e-12);
  EXPECT_NEAR(result.sd_deviation, std::sqrt((14.0 - 64.0 / 6.0) / 5.0) * 1e-3, 1e-12);
  EXPECT_NEAR(result.distance_sd, std::sqrt(14.0 / 4.0) * 1e-3, 1e-12);
  // 1 and 3 mm scatter by sqrt(2) mm, and the mean of two by 1 mm. Five of the six repetitions are
  // single samples.
  EXPECT_NEAR(result.noise_sd, std::sqrt(2.0 * (5.0 + 0.5) / 6.0) * 1e-3, 1e-12);
}

TEST(Repeatability, HoldsWithoutMotionBetweenAreToldApartByTime) {
  Recording recording;
  for (const double time : {0.0, 0.5, 1.0, 6.0, 6.5}) Add(recording, 0.1, 1.0, time);
  EXPECT_EQ(Assessed(recording).postures[0].samples,
            (std::vector<std::vector<int>>{{0, 1, 2}, {3, 4}}));
  recording.trial = {0, 1, 1, 1, 1};
  EXPECT_EQ(Assessed(recording).postures[0].samples.size(), 3u);
  recording.time_s.resize(0);
  EXPECT_EQ(Assessed(recording).postures[0].samples.size(), 5u);
}

TEST(Repeatability, OnlyTheGivenJointsCount) {
  Recording recording = ThreeCycles();
  recording.q.conservativeResize(Eigen::NoChange, 2);
  for (int i = 0; i < recording.q.rows(); ++i) recording.q(i, 1) = 0.1 * i;
  EXPECT_TRUE(Assessed(recording).postures.empty());
  EXPECT_EQ(AssessRepeatability(recording, kWaist, kHand, {.coordinates = {0}}).postures.size(),
            2u);
}

// If a marker is missing once, the mean of the others would move the centre by 20 cm.
TEST(Repeatability, CentresAreOfTheSameMarkers) {
  Recording recording = ThreeCycles();
  recording.markers.row(5).segment(9, 3).setConstant(kNaN);
  const Repeatability result = Assessed(recording);
  EXPECT_EQ(result.postures[0].effector_markers, std::vector<int>{2});
  EXPECT_EQ(result.postures[1].effector_markers, kHand);
  EXPECT_NEAR(result.postures[0].distances[2] - result.postures[0].distances[0],
              std::hypot(1.004, 0.2) - std::hypot(1.0, 0.2), 1e-12);
  // It suffices that one sample of the hold shows the marker.
  recording = ThreeCycles();
  recording.markers.row(3).segment(9, 3).setConstant(kNaN);
  EXPECT_EQ(Assessed(recording).postures[0].effector_markers, kHand);
}

TEST(Repeatability, RepetitionsWithoutAClusterAreLeftOut) {
  Recording recording = ThreeCycles();
  recording.markers.row(0).head(6).setConstant(kNaN);
  const Repeatability result = Assessed(recording);
  EXPECT_EQ(result.left_out, 1);
  EXPECT_EQ(result.postures[0].waist_markers, kWaist);
  EXPECT_EQ(result.postures[0].distances.size(), 2);
}

TEST(Repeatability, NothingRepeatedIsNotPerfect) {
  Recording recording;
  Add(recording, 0.1, 1.0, 0.0);
  Add(recording, 0.5, 1.0, 5.0);
  Recording empty;
  empty.marker_names = recording.marker_names;
  for (const Repeatability& result : {Assessed(recording), Assessed(empty)}) {
    EXPECT_TRUE(result.postures.empty());
    EXPECT_TRUE(std::isnan(result.mean_deviation));
    EXPECT_TRUE(std::isnan(result.sd_deviation));
    EXPECT_TRUE(std::isnan(result.distance_sd));
    EXPECT_TRUE(std::isnan(result.noise_sd));
  }
  EXPECT_EQ(Assessed(recording).not_repeated, 2);
  EXPECT_THROW(AssessRepeatability(recording, {}, kHand, {}), std::invalid_argument);
  EXPECT_THROW(AssessRepeatability(recording, kWaist, {4}, {}), std::invalid_argument);
}

// The noise is 0.2 mm a coordinate, with ten samples a hold and two markers a cluster. So the
// distance scatters by 0.2 sqrt(2 / 20) mm, and the robot adds 0.05 mm. 400 repetitions tell this
// to 4 % (one standard deviation).
TEST(Repeatability, NoiseIsToldFromTheRobot) {
  constexpr double kNoise = 0.2e-3;
  constexpr double kRobot = 0.05e-3;
  Random random(1);
  Recording recording;
  for (int cycle = 0; cycle < 400; ++cycle) {
    const double distance = 1.0 + random.Normal(kRobot);
    for (int k = 0; k < 10; ++k) {
      Add(recording, cycle % 2 == 0 ? 0.1 : 0.5, distance, 5.0 * cycle + 0.1 * k);
      recording.markers.bottomRows<1>() += random.NormalVector(12, kNoise).transpose();
    }
  }
  const Repeatability result = Assessed(recording);
  EXPECT_EQ(result.repetitions, 400);
  const double noise = kNoise * std::sqrt(2.0 / 20.0);
  const double total = std::hypot(noise, kRobot);
  EXPECT_NEAR(result.noise_sd, noise, 0.05 * noise);  // 3600 degrees of freedom: 1.2 %
  EXPECT_NEAR(result.distance_sd, total, 0.12 * total);
  EXPECT_NEAR(result.mean_deviation, total * std::sqrt(2.0 / M_PI), 0.15 * total);
}

}  // namespace
}  // namespace elastocal
