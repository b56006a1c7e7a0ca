// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/clock.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

// True clocks: robot time = (1 + 1e-6 drift) camera time - lag.
struct Clocks {
  double lag_s = 4.0;
  double drift_ppm = 50.0;

  double CameraTime(double robot_time) const {
    return (robot_time + lag_s) / (1.0 + 1e-6 * drift_ppm);
  }
  double RobotTime(double camera_time) const {
    return (1.0 + 1e-6 * drift_ppm) * camera_time - lag_s;
  }
};

using Speed = std::function<double(double)>;  // m/s at a camera time

// Speed of a robot that goes to a new posture every 5 s, by minimum-jerk motions of 4 s with
// different speeds. It rests before the first and after `duration`.
Speed Postures(double duration) {
  Random random(11);
  std::vector<double> reach(static_cast<std::size_t>(duration / 5.0) + 1);
  for (double& value : reach) value = random.Uniform(0.05, 0.5);
  return [=](double t) {
    if (t < 0.0 || t >= duration) return 0.0;
    const double u = std::min(1.0, std::fmod(t, 5.0) / 4.0);
    return reach[static_cast<std::size_t>(t / 5.0)] * 30.0 * u * u * (1.0 - u) * (1.0 - u) / 4.0;
  };
}

MeasuredSpeed Measure(const Speed& speed, double duration, double noise, double missing,
                      std::uint64_t seed = 5) {
  Random random(seed);
  MeasuredSpeed measured{100.0, Eigen::VectorXd(static_cast<Eigen::Index>(duration * 100.0))};
  for (Eigen::Index i = 0; i < measured.values.size(); ++i) {
    measured.values[i] = speed(0.01 * static_cast<double>(i)) + random.Normal(noise);
    if (random.Uniform(0.0, 1.0) < missing) measured.values[i] = kNaN;
  }
  return measured;
}

// The speed as logged at 200 Hz from one robot time to another.
PredictedSpeed Predict(const Speed& speed, const Clocks& clocks, double begin, double end) {
  const auto count = static_cast<Eigen::Index>((end - begin) * 200.0);
  PredictedSpeed predicted{Eigen::VectorXd::LinSpaced(count, begin, end), Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    predicted.values[i] = speed(clocks.CameraTime(predicted.time_s[i]));
  }
  return predicted;
}

// Largest error of robot times over a trial, s.
double LargestError(const ClockFit& fit, const Clocks& clocks, double duration) {
  return std::max(std::abs(fit.RobotTime(0.0) - clocks.RobotTime(0.0)),
                  std::abs(fit.RobotTime(duration) - clocks.RobotTime(duration)));
}

TEST(EstimateClock, FindsLagAndDriftInNoise) {
  const Speed speed = Postures(600.0);
  for (const Clocks& clocks : {Clocks{4.0, 50.0}, Clocks{-7.3, -120.0}, Clocks{0.0, 0.0}}) {
    const PredictedSpeed predicted = Predict(speed, clocks, 0.0, 600.0);
    for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
      const ClockFit fit = EstimateClock(Measure(speed, 600.0, 0.005, 0.05, seed), predicted, {});
      EXPECT_EQ(fit.state, ClockState::kReliable) << Describe(fit);
      EXPECT_TRUE(fit.drift_estimated);
      const double error = LargestError(fit, clocks, 600.0);
      EXPECT_LT(error, 2e-3);  // the requirement; the standard deviation is near 0.7 ms
      EXPECT_LT(error, 5.0 * fit.sd_s + 1e-5);
      EXPECT_NEAR(fit.drift_ppm, clocks.drift_ppm, 5.0);  // the standard deviation is 1.9 ppm
      EXPECT_GT(fit.peak, 0.98);
      EXPECT_LT(fit.line_residual_s, 0.002);
    }
  }
}

TEST(EstimateClockStudy, SaysHowSureItIs) {
  const Speed speed = Postures(300.0);
  const Clocks clocks;
  const PredictedSpeed predicted = Predict(speed, clocks, 0.0, 300.0);
  double square = 0.0;
  double claimed = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const ClockFit fit = EstimateClock(Measure(speed, 300.0, 0.01, 0.0, seed), predicted, {});
    square += std::pow(fit.RobotTime(0.0) - clocks.RobotTime(0.0), 2);
    claimed += fit.sd_s * fit.sd_s;
  }
  // 40 draws tell their scatter to 11 %. `sd_s` is that at the worse end of the trial.
  EXPECT_NEAR(std::sqrt(square / claimed), 0.95, 0.35);
}

TEST(EstimateClock, IsExactWithoutNoise) {
  const Speed speed = Postures(200.0);
  const Clocks clocks;
  const ClockFit fit =
      EstimateClock(Measure(speed, 200.0, 0.0, 0.0), Predict(speed, clocks, 0.0, 200.0), {});
  // Linear interpolation of the log smooths the beginning of the motion by some 1e-5 m/s.
  EXPECT_LT(LargestError(fit, clocks, 200.0), 2e-5);
}

TEST(EstimateClock, TakesALogThatEndsEarlyOrHasAHole) {
  const Speed speed = Postures(600.0);
  const Clocks clocks;
  const MeasuredSpeed measured = Measure(speed, 600.0, 0.005, 0.05);
  const ClockFit early = EstimateClock(measured, Predict(speed, clocks, 0.0, 250.0), {});
  EXPECT_EQ(early.state, ClockState::kReliable) << Describe(early);
  EXPECT_LT(LargestError(early, clocks, 254.0), 2e-3);
  EXPECT_NEAR(early.overlap_s, 250.0 * 0.95, 3.0);

  PredictedSpeed holey = Predict(speed, clocks, 0.0, 600.0);
  const PredictedSpeed whole = holey;
  const Eigen::Index kept = holey.time_s.size() - 20000;  // a gap of 100 s in the middle
  holey.time_s = Eigen::VectorXd(kept);
  holey.values = Eigen::VectorXd(kept);
  holey.time_s << whole.time_s.head(50000), whole.time_s.tail(kept - 50000);
  holey.values << whole.values.head(50000), whole.values.tail(kept - 50000);
  const ClockFit fit = EstimateClock(measured, holey, {});
  EXPECT_EQ(fit.state, ClockState::kReliable) << Describe(fit);
  EXPECT_LT(LargestError(fit, clocks, 600.0), 1e-3);
}

TEST(EstimateClock, TakesTheTimeOfDay) {
  const Speed speed = Postures(200.0);
  const Clocks clocks{-1.7e9, 0.0};
  const PredictedSpeed predicted = Predict(speed, clocks, 1.7e9, 1.7e9 + 200.0);
  const ClockFit fit =
      EstimateClock(Measure(speed, 200.0, 0.002, 0.0), predicted, {.expected_lag_s = -1.7e9 + 3.0});
  EXPECT_EQ(fit.state, ClockState::kReliable) << Describe(fit);
  EXPECT_NEAR(fit.lag_s, -1.7e9, 1e-3);
}

TEST(EstimateClock, TakesAShortTrialWithoutDrift) {
  const Speed speed = Postures(30.0);
  const Clocks clocks{1.0, 0.0};
  const ClockFit fit =
      EstimateClock(Measure(speed, 31.0, 0.002, 0.0), Predict(speed, clocks, -5.0, 31.0), {});
  EXPECT_EQ(fit.state, ClockState::kReliable) << Describe(fit);
  EXPECT_FALSE(fit.drift_estimated);
  EXPECT_EQ(fit.drift_ppm, 0.0);
  EXPECT_NEAR(fit.lag_s, 1.0, 1e-3);
}

TEST(EstimateClock, SaysNoDeviationWhereNoPartTellsTheLag) {
  ClockFit fit;
  fit.state = ClockState::kImprecise;
  fit.lag_s = 4.3;
  EXPECT_EQ(Describe(fit),
            "no part of the trial tells the clock lag, which seems to be near 4.30 s");
}

TEST(EstimateClock, RefusesAPeriodicMotion) {
  const Speed speed = [](double t) {
    return 0.3 * std::abs(std::sin(std::numbers::pi * t / 4.0)) + 0.02 * std::sin(t / 40.0);
  };
  const ClockFit fit = EstimateClock(Measure(speed, 120.0, 0.005, 0.05),
                                     Predict(speed, {4.0, 50.0}, 0.0, 120.0), {});
  EXPECT_EQ(fit.state, ClockState::kAmbiguous) << Describe(fit);
  EXPECT_GT(fit.second_peak, 0.95 * fit.peak);
}

TEST(EstimateClock, RefusesWhatDoesNotBelongTogether) {
  const Speed speed = Postures(100.0);
  const MeasuredSpeed measured = Measure(speed, 100.0, 0.005, 0.0);
  const auto state = [&](const PredictedSpeed& predicted) {
    return EstimateClock(measured, predicted, {}).state;
  };
  const Speed other = [&](double t) {
    return std::abs(std::sin(1.3 * t) * std::sin(0.37 * t * t));
  };
  EXPECT_EQ(state(Predict(other, {0.0, 0.0}, 0.0, 100.0)), ClockState::kWeak);
  EXPECT_EQ(state(Predict([](double) { return 0.0; }, {0.0, 0.0}, 0.0, 100.0)), ClockState::kWeak);
  EXPECT_EQ(state(Predict(speed, {-900.0, 0.0}, 900.0, 1000.0)), ClockState::kNoOverlap);
  EXPECT_EQ(state(Predict(speed, {10.5, 0.0}, -10.5, 89.5)), ClockState::kAtTheRim);
}

TEST(EstimateClock, RefusesAClockThatJumps) {
  const Speed speed = Postures(300.0);
  PredictedSpeed predicted = Predict(speed, {2.0, 0.0}, 0.0, 300.0);
  predicted.time_s.tail(predicted.time_s.size() / 2).array() += 0.08;
  const ClockFit fit = EstimateClock(Measure(speed, 300.0, 0.005, 0.0), predicted, {});
  EXPECT_EQ(fit.state, ClockState::kUnsteady) << Describe(fit);
}

TEST(EstimateClock, LeavesOutOneBadWindow) {
  const Speed speed = Postures(300.0);
  const Clocks clocks{2.0, 20.0};
  MeasuredSpeed measured = Measure(speed, 300.0, 0.005, 0.0);
  // For 20 s, the cameras see everything a tenth of a second late.
  const Eigen::VectorXd late = measured.values.segment(8000, 2000);
  measured.values.segment(8010, 1990) = late.head(1990);
  const ClockFit fit = EstimateClock(measured, Predict(speed, clocks, 0.0, 300.0), {});
  EXPECT_EQ(fit.state, ClockState::kReliable) << Describe(fit);
  EXPECT_LT(LargestError(fit, clocks, 300.0), 1e-3);
  EXPECT_EQ(std::count_if(fit.windows.begin(), fit.windows.end(),
                          [](const WindowLag& window) { return !window.used; }),
            1);
}

TEST(EstimateClock, RefusesWrongArguments) {
  const MeasuredSpeed measured{100.0, Eigen::VectorXd::Zero(100)};
  const PredictedSpeed predicted{Eigen::VectorXd::LinSpaced(50, 0.0, 1.0),
                                 Eigen::VectorXd::Zero(50)};
  PredictedSpeed backwards = predicted;
  backwards.time_s[3] = 5.0;
  EXPECT_THROW(EstimateClock({0.0, measured.values}, predicted, {}), std::invalid_argument);
  EXPECT_THROW(EstimateClock(measured, {}, {}), std::invalid_argument);
  EXPECT_THROW(EstimateClock(measured, backwards, {}), std::invalid_argument);
  EXPECT_THROW(EstimateClock(measured, predicted, {.longest_lag_s = 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace elastocal
