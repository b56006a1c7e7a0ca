// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/random.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

constexpr int kCount = 100000;

TEST(Random, FirstUniformNumbersAreThoseOfTheStandardsGenerator) {
  // From its default seed, std::mt19937_64 first gives 14514284786278117030, of which the upper 53
  // bits count.
  EXPECT_EQ(Random(5489).Uniform(0.0, 1.0), std::ldexp(14514284786278117030ull >> 11, -53));
}

TEST(Random, FirstNormalNumbers) {
  // Box and Muller's formula on the generator's first numbers. Other platforms may round sqrt, log
  // and cos differently.
  Random uniform(7), random(7);
  for (int i = 0; i < 10; ++i) {
    const double u1 = uniform.Uniform(0.0, 1.0), u2 = uniform.Uniform(0.0, 1.0);
    EXPECT_NEAR(random.Normal(2.0),
                2.0 * std::sqrt(-2.0 * std::log1p(-u1)) * std::cos(2.0 * M_PI * u2), 1e-14);
  }
}

TEST(Random, SameSeedSameNumbers) {
  Random a(3), b(3), c(4);
  const Eigen::VectorXd values = a.NormalVector(20, 1.0);
  EXPECT_EQ(values, b.NormalVector(20, 1.0));
  EXPECT_NE(values, c.NormalVector(20, 1.0));
}

TEST(Random, UniformMoments) {
  Random random(1);
  Eigen::VectorXd values(kCount);
  for (double& value : values) value = random.Uniform(-1.0, 3.0);
  EXPECT_GE(values.minCoeff(), -1.0);
  EXPECT_LT(values.maxCoeff(), 3.0);
  // Tolerances of 5 standard errors: sd / sqrt(n) for the mean, sqrt(4/5) var / sqrt(n) for the
  // variance.
  const double variance = 16.0 / 12.0;
  EXPECT_NEAR(values.mean(), 1.0, 5.0 * std::sqrt(variance / kCount));
  EXPECT_NEAR((values.array() - 1.0).square().mean(), variance,
              5.0 * std::sqrt(0.8 / kCount) * variance);
}

TEST(Random, NormalMoments) {
  Random random(2);
  const Eigen::ArrayXd values = random.NormalVector(kCount, 3.0).array() / 3.0;
  // The first four moments are 0, 1, 0 and 3; the variances of their estimates are 1, 2, 15 and 96
  // over n. Tolerances are 5 standard errors.
  EXPECT_NEAR(values.mean(), 0.0, 5.0 * std::sqrt(1.0 / kCount));
  EXPECT_NEAR(values.square().mean(), 1.0, 5.0 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(values.cube().mean(), 0.0, 5.0 * std::sqrt(15.0 / kCount));
  EXPECT_NEAR(values.square().square().mean(), 3.0, 5.0 * std::sqrt(96.0 / kCount));
}

TEST(Random, IndexIsUniform) {
  Random random(3);
  std::vector<int> counts(7, 0);
  for (int i = 0; i < kCount; ++i) ++counts.at(random.Index(7));
  // The tolerance is 5 standard deviations of a binomial number.
  const double p = 1.0 / 7.0;
  for (int count : counts) EXPECT_NEAR(count, p * kCount, 5.0 * std::sqrt(p * (1 - p) * kCount));
}

}  // namespace
}  // namespace elastocal
