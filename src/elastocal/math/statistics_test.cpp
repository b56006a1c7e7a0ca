// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/statistics.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

// Printed tables give four or more digits. The tolerance is half a unit of the last one.
TEST(StudentQuantile, AgreesWithTables) {
  EXPECT_NEAR(StudentQuantile(0.975, 1), 12.7062, 5e-5);
  EXPECT_NEAR(StudentQuantile(0.975, 10), 2.2281, 5e-5);
  EXPECT_NEAR(StudentQuantile(0.95, 30), 1.6973, 5e-5);
  EXPECT_NEAR(StudentQuantile(0.025, 10), -2.2281, 5e-5);
  EXPECT_NEAR(StudentQuantile(0.975, 1e9), 1.95996, 5e-6);  // the normal distribution
}

TEST(ChiSquareQuantile, AgreesWithTables) {
  EXPECT_NEAR(ChiSquareQuantile(0.95, 1), 3.8415, 5e-5);
  EXPECT_NEAR(ChiSquareQuantile(0.99, 3), 11.3449, 5e-5);
  EXPECT_NEAR(ChiSquareQuantile(0.95, 10), 18.3070, 5e-5);
  EXPECT_NEAR(ChiSquareQuantile(0.5, 2), 2.0 * std::log(2.0), 1e-12);
}

TEST(FisherUpperTail, AgreesWithTables) {
  EXPECT_NEAR(FisherUpperTail(4.1028, 2, 10), 0.05, 5e-6);
  EXPECT_NEAR(FisherUpperTail(3.8415, 1, std::numeric_limits<double>::infinity()), 0.05, 5e-6);
  EXPECT_NEAR(FisherUpperTail(3.8415, 1, 1e9), 0.05, 5e-6);
  EXPECT_EQ(FisherUpperTail(0.0, 3, 7), 1.0);
}

TEST(StudentTwoSidedTail, CountsBothSidesAndIsTheSquareRootOfFisher) {
  EXPECT_NEAR(StudentTwoSidedTail(2.2281, 10), 0.05, 5e-6);
  EXPECT_NEAR(StudentTwoSidedTail(-1.95996, std::numeric_limits<double>::infinity()), 0.05, 5e-7);
  EXPECT_NEAR(StudentTwoSidedTail(1.7, 12), FisherUpperTail(1.7 * 1.7, 1, 12), 1e-14);
}

TEST(StudentDegreesOfFreedom, InvertsTheQuantile) {
  for (const double freedom : {1.0, 7.5, 300.0, 3e4}) {
    EXPECT_NEAR(StudentDegreesOfFreedom(0.975, StudentQuantile(0.975, freedom)), freedom,
                1e-6 * freedom);
  }
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(StudentDegreesOfFreedom(0.975, StudentQuantile(0.975, infinity)), infinity);
}

TEST(Median, MiddleValueOrMeanOfTheMiddleTwo) {
  EXPECT_EQ(Median(Eigen::Vector3d(5, -1, 2)), 2.0);
  EXPECT_EQ(Median(Eigen::Vector4d(5, -1, 2, 100)), 3.5);
  EXPECT_EQ(Median(Eigen::VectorXd::Constant(1, 7)), 7.0);
  EXPECT_TRUE(std::isnan(Median(Eigen::VectorXd())));
}

TEST(RootMeanSquare, IsNotTheMean) {
  EXPECT_DOUBLE_EQ(RootMeanSquare(Eigen::Vector2d(3, -4)), std::sqrt(12.5));
  EXPECT_TRUE(std::isnan(RootMeanSquare(Eigen::VectorXd())));
}

// By hand: the variance of 1, 2, 3, 6 about their mean 3 is 14 / 3, and that of the mean a quarter.
TEST(StandardErrorOfMean, IsThatOfTheHandValue) {
  EXPECT_DOUBLE_EQ(StandardErrorOfMean(Eigen::Vector4d(1, 2, 3, 6)), std::sqrt(14.0 / 12.0));
  EXPECT_EQ(StandardErrorOfMean(Eigen::Vector2d(2, 2)), 0.0);
  EXPECT_TRUE(std::isinf(StandardErrorOfMean(Eigen::VectorXd::Ones(1))));
}

}  // namespace
}  // namespace elastocal
