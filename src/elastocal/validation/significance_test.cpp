// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/significance.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Differences TwoCorrelated(double freedom) {
  Differences d;
  d.values = Eigen::Vector2d(2.0, 0.0);
  d.covariance_a = 0.25 * Eigen::Matrix2d::Identity();
  d.covariance_b.setZero(2, 2);
  d.covariance_b << 0.75, 0.6, 0.6, 0.75;
  d.freedom_a = d.freedom_b = freedom;
  return d;
}

TEST(TestDifferences, MahalanobisDistanceByHand) {
  // The sum has unit variances and correlation 0.6. Its inverse has 1 / 0.64 on the diagonal.
  const DifferenceTest test = TestDifferences(TwoCorrelated(kInfinity), {0, 1});
  EXPECT_NEAR(test.statistic, 4.0 / 0.64 / 2.0, 1e-12);
  EXPECT_EQ(test.parameters, 2);
  EXPECT_NEAR(test.p, std::exp(-0.5 * 4.0 / 0.64), 1e-12);  // chi-square, two degrees
  const DifferenceTest alone = TestDifferences(TwoCorrelated(kInfinity), {0});
  EXPECT_NEAR(alone.p, StudentTwoSidedTail(2.0, kInfinity), 1e-12);
}

// If the first may have any value, it explains the second, which is 0.6 times the first. Nothing
// remains.
TEST(TestDifferences, FreeOnesExplainWhatTheyCan) {
  const DifferenceTest rest = TestDifferences(TwoCorrelated(kInfinity), {0, 1}, {0});
  EXPECT_EQ(rest.parameters, 1);
  EXPECT_NEAR(rest.statistic, 0.0, 1e-12);
  EXPECT_NEAR(TestDifferences(TwoCorrelated(kInfinity), {0, 1}, {1}).statistic, 4.0, 1e-12);
}

// The variances are 1 and the correlation is 0.6. If the first is known to be 0, the second is less
// by 0.6 times the first's 2, and its variance is 1 - 0.36.
TEST(GivenNone, ConditionalNormalByHand) {
  const Differences given = GivenNone(TwoCorrelated(kInfinity), {1}, {0});
  EXPECT_NEAR(given.values[0], -1.2, 1e-12);
  EXPECT_NEAR(given.covariance_a(0, 0) + given.covariance_b(0, 0), 0.64, 1e-12);
  EXPECT_NEAR(given.covariance_a(0, 0), 0.25 * (1.0 + 0.36), 1e-12);  // of A, uncorrelated
  const Differences all = GivenNone(TwoCorrelated(kInfinity), {1, 0}, {});
  EXPECT_EQ(all.values, Eigen::Vector2d(0.0, 2.0));
  EXPECT_NEAR(all.covariance_b(0, 1), 0.6, 1e-15);
}

TEST(TestDifferences, UnitsDoNotMatter) {
  Differences d = TwoCorrelated(8.0);
  const double p = TestDifferences(d, {0, 1}).p;
  const Eigen::Vector2d units(1e-8, 1e3);
  d.values = units.cwiseProduct(d.values);
  d.covariance_a = units.asDiagonal() * d.covariance_a * units.asDiagonal();
  d.covariance_b = units.asDiagonal() * d.covariance_b * units.asDiagonal();
  EXPECT_NEAR(TestDifferences(d, {0, 1}).p, p, 1e-12);
}

TEST(TestDifferences, SingularCovarianceIsRefused) {
  Differences d = TwoCorrelated(kInfinity);
  d.covariance_a.setZero();
  d.covariance_b.setOnes();
  EXPECT_THROW(TestDifferences(d, {0, 1}), std::invalid_argument);
  d.covariance_b.setZero();
  EXPECT_THROW(TestDifferences(d, {0}), std::invalid_argument);
}

TEST(PooledFreedom, IsWelchs) {
  Differences d;
  d.freedom_a = 10.0;
  d.freedom_b = 20.0;
  EXPECT_NEAR(PooledFreedom(d, 1.0), 10.0, 1e-12);
  EXPECT_NEAR(PooledFreedom(d, 0.0), 20.0, 1e-12);
  EXPECT_NEAR(PooledFreedom(d, 0.5), 4.0 / (1.0 / 10.0 + 1.0 / 20.0), 1e-12);
  d.freedom_a = d.freedom_b = kInfinity;
  EXPECT_EQ(PooledFreedom(d, 0.3), kInfinity);
}

// The covariances are known up to a factor, which is estimated with few degrees of freedom.
// Chi-square would reject 12 %. The share of 20000 trials has a standard deviation of 0.15 %.
TEST(TestDifferences, FiveInAHundredWithoutAChange) {
  Random random(1);
  const double freedom = 8.0;
  Eigen::Matrix3d root;
  root << 1.0, 0.0, 0.0, 0.9, 0.3, 0.0, -0.2, 0.5, 2.0;
  int rejected = 0;
  constexpr int kTrials = 20000;
  for (int trial = 0; trial < kTrials; ++trial) {
    Differences d;
    d.values = root * random.NormalVector(3, 1.0);
    const double scale = random.NormalVector(8, 1.0).squaredNorm() / freedom;
    d.covariance_a = scale * root * root.transpose();
    d.covariance_b.setZero(3, 3);
    d.freedom_a = freedom;
    d.freedom_b = 1.0;  // has no weight
    rejected += TestDifferences(d, {0, 1, 2}).p <= 0.05 ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(rejected) / kTrials, 0.05, 0.005);
}

TEST(HolmAdjusted, ByHand) {
  const std::vector<double> adjusted = HolmAdjusted({0.03, 0.01, 0.02, 0.9});
  EXPECT_DOUBLE_EQ(adjusted[1], 0.04);
  EXPECT_DOUBLE_EQ(adjusted[2], 0.06);
  EXPECT_DOUBLE_EQ(adjusted[0], 0.06);
  EXPECT_DOUBLE_EQ(adjusted[3], 0.9);
  EXPECT_EQ(HolmAdjusted({0.7, 0.8}), (std::vector<double>{1.0, 1.0}));
  EXPECT_TRUE(HolmAdjusted({}).empty());
}

}  // namespace
}  // namespace elastocal
