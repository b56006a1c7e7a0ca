// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/smoothed_log.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

double Wave(double time_s) { return std::sin(std::numbers::pi * time_s); }  // 0.5 Hz

// A log from 7 s of two joints, of which the first has torques, and of a force-torque sensor.
JointLog MakeLog(Eigen::VectorXd time_s) {
  JointLog log;
  log.source = "j.csv";
  log.names = {"a", "b"};
  log.time_s = std::move(time_s);
  const Eigen::Index rows = log.time_s.size();
  log.positions.resize(rows, 2);
  log.torques.setConstant(rows, 2, kNaN);
  log.wrench_sensors = {{"ft", 0}};
  log.wrenches.setZero(rows, 6);
  for (Eigen::Index i = 0; i < rows; ++i) {
    log.positions.row(i) << Wave(log.time_s[i]), 2.0;
    log.torques(i, 0) = -30.0 * Wave(log.time_s[i]);
    log.wrenches(i, 5) = 4.0 * Wave(log.time_s[i]);
  }
  return log;
}

Eigen::VectorXd Times(int count, double rate_hz) {
  return Eigen::VectorXd::LinSpaced(count, 7.0, 7.0 + (count - 1) / rate_hz);
}

TEST(SmoothLog, KeepsSlowMotionsOfAllSignals) {
  const SmoothedLog log = SmoothLog(MakeLog(Times(2000, 200.0)), {});
  ASSERT_EQ(log.pieces.size(), 1u);
  EXPECT_NEAR(log.pieces[0].rate_hz, 200.0, 1e-9);
  for (const double time : Eigen::VectorXd::LinSpaced(365, 9.5, 14.5)) {
    const Eigen::VectorXd signals = *log.At(time);
    ASSERT_EQ(signals.size(), 10);
    // The filter of fifth order, applied twice, loses 1e-10 at a tenth of the cutoff. Cubic
    // interpolation over 5 ms loses less.
    EXPECT_NEAR(signals[0], Wave(time), 1e-7);
    EXPECT_NEAR(signals[1], 2.0, 1e-12);
    EXPECT_NEAR(signals[2], -30.0 * Wave(time), 3e-6);
    EXPECT_TRUE(std::isnan(signals[3]));
    EXPECT_NEAR(signals[9], 4.0 * Wave(time), 4e-7);
  }
}

TEST(SmoothLog, CoversWhatItKnowsFromBothSides) {
  const SmoothedLog log = SmoothLog(MakeLog(Times(1001, 100.0)), {});
  EXPECT_FALSE(log.At(6.0));
  EXPECT_FALSE(log.At(7.05));  // within half a period of the cutoff from the beginning
  EXPECT_TRUE(log.At(7.15));
  EXPECT_TRUE(log.At(16.85));
  EXPECT_FALSE(log.At(16.95));
  EXPECT_TRUE(log.Covers(8.0));
  EXPECT_FALSE(log.Covers(20.0));
}

TEST(SmoothLog, TakesTimesThatJitter) {
  Random random(3);
  Eigen::VectorXd time_s = Times(2000, 200.0);
  for (double& time : time_s) time += random.Uniform(-2e-3, 2e-3);
  const SmoothedLog log = SmoothLog(MakeLog(time_s), {});
  for (const double time : Eigen::VectorXd::LinSpaced(585, 8.0, 16.0)) {
    // Linear interpolation over at most 9 ms has an error of (0.009 pi)^2 / 8.
    EXPECT_NEAR((*log.At(time))[0], Wave(time), 1e-4);
  }
}

TEST(SmoothLog, DoesNotBridgeHoles) {
  const Eigen::VectorXd whole = Times(1000, 100.0);
  Eigen::VectorXd time_s(900);
  time_s << whole.head(400), whole.tail(490), Eigen::VectorXd::LinSpaced(10, 20.0, 20.09);
  const SmoothedLog log = SmoothLog(MakeLog(time_s), {});
  ASSERT_EQ(log.pieces.size(), 2u);  // the last ten samples are too few to be filtered
  EXPECT_TRUE(log.At(10.8));
  EXPECT_FALSE(log.At(11.2));
  EXPECT_FALSE(log.At(11.6));
  EXPECT_NEAR((*log.At(12.4))[0], Wave(12.4), 1e-4);
  EXPECT_FALSE(log.At(20.05));
}

TEST(SmoothLog, RefusesASlowLog) {
  ExpectInputError([] { SmoothLog(MakeLog(Times(100, 9.0)), {}); },
                   {"j.csv: has 9 samples", "more than 10"});
  for (const auto& [unit, a_second] : {std::pair{"ms", 1e3}, {"us", 1e6}, {"ns", 1e9}}) {
    JointLog log = MakeLog(Times(100, 100.0));
    log.time_s *= a_second;
    ExpectInputError([&] { SmoothLog(log, {}); }, {std::string("is its time in ") + unit});
  }
}

}  // namespace
}  // namespace elastocal
