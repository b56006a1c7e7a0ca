// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/encoder_starts.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

constexpr double kEncoderStep = 2.0 * M_PI / 144000.0;

/// Readings of a joint that moves by a few steps. `homed` is its offset after each start, in steps.
Eigen::VectorXd HomedReadings(const std::vector<int>& start, const std::vector<double>& homed,
                              Random& random) {
  Eigen::VectorXd readings(static_cast<Eigen::Index>(start.size()));
  for (std::size_t row = 0; row < start.size(); ++row) {
    readings[static_cast<Eigen::Index>(row)] =
        kEncoderStep * (random.Index(5) - 2 + homed[static_cast<std::size_t>(start[row])]);
  }
  return readings;
}

std::vector<int> Runs(const std::vector<int>& lengths) {
  std::vector<int> start;
  for (std::size_t s = 0; s < lengths.size(); ++s) {
    start.insert(start.end(), static_cast<std::size_t>(lengths[s]), static_cast<int>(s));
  }
  return start;
}

TEST(EncoderStarts, AreToldByTheRemaindersOfAStep) {
  Random random(3);
  const std::vector<int> start = Runs({4, 9, 3, 14});
  Eigen::MatrixXd readings(30, 3);
  readings.col(0) = HomedReadings(start, {0.13, 0.61, 0.27, 0.92}, random);
  // Two more joints: one was not homed, one moves far and is read without steps.
  readings.col(1) = HomedReadings(start, {0.4, 0.4, 0.4, 0.4}, random);
  for (Eigen::Index row = 0; row < 30; ++row) readings(row, 2) = random.Uniform(-1.0, 1.0);
  const EncoderStarts starts = FindEncoderStarts(readings);
  EXPECT_EQ(starts.start, start);
  EXPECT_EQ(starts.columns, std::vector<int>{0});
  ASSERT_EQ(starts.steps.size(), 1u);
  EXPECT_NEAR(starts.steps[0], kEncoderStep, 1e-9 * kEncoderStep);  // rounding errors
  EXPECT_EQ(starts.count(), 4);
}

TEST(EncoderStarts, SeveralColumnsTellMoreThanOne) {
  Random random(4);
  Eigen::MatrixXd readings(30, 2);
  readings.col(0) = HomedReadings(Runs({10, 20}), {0.0, 0.3}, random);
  readings.col(1) = HomedReadings(Runs({22, 8}), {0.45, 0.8}, random);
  EXPECT_EQ(FindEncoderStarts(readings).start, Runs({10, 12, 8}));
}

TEST(EncoderStarts, OneThatComesAgainIsTheSame) {
  Random random(5);
  std::vector<int> start = Runs({8, 8});
  const std::vector<int> again = Runs({8});
  start.insert(start.end(), again.begin(), again.end());
  EXPECT_EQ(FindEncoderStarts(HomedReadings(start, {0.1, 0.72}, random)).start, start);
}

/// Nothing is found in 300 columns of joints that were not homed: noise rounded to printed digits,
/// commanded positions, and a coarse encoder that sometimes shows a step between.
TEST(EncoderStarts, NothingIsFoundWhereNothingWasHomed) {
  Random random(6);
  for (int table = 0; table < 100; ++table) {
    Eigen::MatrixXd readings(40, 3);
    for (Eigen::Index row = 0; row < 40; ++row) {
      readings(row, 0) = 1e-6 * std::round(random.Normal(2e-6) / 1e-6);
      readings(row, 1) = 0.1 * random.Index(7);
      readings(row, 2) = kEncoderStep * (2 * random.Index(2) + (random.Index(12) == 0 ? 1 : 0));
    }
    for (Eigen::Index c = 0; c < 3; ++c) {
      EXPECT_EQ(FindEncoderStarts(readings.col(c)).count(), 0) << "table " << table << ", " << c;
    }
  }
}

TEST(EncoderStarts, ColumnsThatAreNoNumbersTellNothing) {
  Random random(7);
  Eigen::MatrixXd readings = HomedReadings(Runs({10, 10}), {0.1, 0.72}, random);
  ASSERT_EQ(FindEncoderStarts(readings).count(), 2);
  readings(3, 0) = std::nan("");
  EXPECT_EQ(FindEncoderStarts(readings).count(), 0);
  EXPECT_EQ(FindEncoderStarts(Eigen::MatrixXd(0, 2)).count(), 0);
}

}  // namespace
}  // namespace elastocal
