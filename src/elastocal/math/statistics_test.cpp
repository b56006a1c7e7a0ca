#include "elastocal/math/statistics.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

// Printed tables give four or more digits; half of the last one.
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

}  // namespace
}  // namespace elastocal
