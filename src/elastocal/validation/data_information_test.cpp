// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/data_information.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

constexpr double kA = 4.0, kY = 1.5;  // one unknown: measured 1.5, variance 1/4

double ByHand(double mean, double variance) {
  return -0.5 * std::pow(kY - mean, 2) / (variance + 1.0 / kA) - 0.5 * std::log1p(kA * variance) +
         0.5 * kA * kY * kY;
}

TEST(LogEvidence, OfOneUnknownByHand) {
  DataInformation data;
  data.information = Eigen::MatrixXd::Constant(1, 1, kA);
  data.vector = Eigen::VectorXd::Constant(1, kA * kY);
  for (const auto& [mean, variance] :
       {std::pair(0.0, 1.0), std::pair(1.4, 1e-4), std::pair(-2.0, 9.0)}) {
    EXPECT_NEAR(LogEvidence(data, Eigen::VectorXd::Constant(1, mean),
                            Eigen::MatrixXd::Constant(1, 1, variance)),
                ByHand(mean, variance), 1e-12);
  }
}

// The data tell only the sum of two unknowns. Its covariance counts.
TEST(LogEvidence, OfACombination) {
  DataInformation data;
  data.information = Eigen::MatrixXd::Constant(2, 2, kA);
  data.vector = Eigen::VectorXd::Constant(2, kA * kY);
  Eigen::Matrix2d covariance;
  covariance << 2.0, -1.0, -1.0, 1.5;
  EXPECT_NEAR(LogEvidence(data, Eigen::Vector2d(0.3, 0.4), covariance), ByHand(0.7, 1.5), 1e-12);
}

}  // namespace
}  // namespace elastocal
