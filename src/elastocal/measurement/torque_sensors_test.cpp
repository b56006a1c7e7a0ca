// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/torque_sensors.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

// A minute at 100 Hz of a joint that goes to a posture in 4 s, rests for a second, and goes back.
// Its torque follows, with noise, and is rounded to `resolution` unless that is 0.
JointLog MakeLog(double noise, double resolution = 0.0) {
  constexpr int kSamples = 6000;
  Random random(1);
  JointLog log;
  log.names = {"a"};
  log.time_s = Eigen::VectorXd::LinSpaced(kSamples, 0.0, 59.99);
  log.positions.resize(kSamples, 1);
  log.torques.resize(kSamples, 1);
  for (int i = 0; i < kSamples; ++i) {
    const double cycle = std::fmod(log.time_s[i], 10.0);
    const double up = std::clamp(cycle / 4.0, 0.0, 1.0) - std::clamp((cycle - 5.0) / 4.0, 0.0, 1.0);
    log.positions(i, 0) = up;
    log.torques(i, 0) = 40.0 * up - 10.0 + random.Normal(noise);
    if (resolution > 0.0)
      log.torques(i, 0) = resolution * std::round(log.torques(i, 0) / resolution);
  }
  return log;
}

std::vector<TorqueFinding> Check(const JointLog& log) { return CheckTorqueSensors(log, {}); }

TEST(CheckTorqueSensors, BelievesWorkingSensors) {
  EXPECT_TRUE(Check(MakeLog(0.2)).empty());
  EXPECT_TRUE(Check(MakeLog(0.2, 0.1)).empty());
  // Without noise, the torque has the same value in each rest, including its extremes.
  EXPECT_TRUE(Check(MakeLog(0.0)).empty());
  EXPECT_TRUE(Check(MakeLog(0.0, 0.1)).empty());
}

TEST(CheckTorqueSensors, FindsADeadSensor) {
  JointLog log = MakeLog(0.2);
  log.torques.setConstant(0.0);
  const auto findings = Check(log);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].fault, TorqueFault::kDead);
  EXPECT_EQ(findings[0].share, 1.0);
  EXPECT_EQ(Describe(findings[0]), "dead (0 throughout)");
}

TEST(CheckTorqueSensors, FindsASensorThatDies) {
  JointLog log = MakeLog(0.2);
  log.torques.col(0).segment(2000, 1500).setConstant(log.torques(1999, 0));
  const auto findings = Check(log);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].fault, TorqueFault::kStuck);
  EXPECT_NEAR(findings[0].begin_s, 19.99, 1e-9);
  EXPECT_NEAR(findings[0].share, 0.25, 1e-3);
}

TEST(CheckTorqueSensors, FindsASaturatedSensorAtEitherEnd) {
  for (const double sign : {1.0, -1.0}) {
    JointLog log = MakeLog(0.2);
    log.torques = sign * log.torques.cwiseMin(22.0);
    const auto findings = Check(log);
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].fault, TorqueFault::kSaturated);
    EXPECT_EQ(findings[0].value, sign * 22.0);
    EXPECT_GT(findings[0].share, 0.2);
    EXPECT_NE(Describe(findings[0]).find("saturated (at"), std::string::npos);
  }
}

TEST(CheckTorqueSensors, PassesOverJointsWithoutSensorsAndRobotsAtRest) {
  JointLog log = MakeLog(0.2);
  log.torques.setConstant(kNaN);
  EXPECT_TRUE(Check(log).empty());
  log = MakeLog(0.2);
  log.torques.col(0).segment(420, 60).setConstant(30.0);  // the joint rests within these samples
  EXPECT_TRUE(Check(log).empty());
  EXPECT_TRUE(Check({}).empty());
}

}  // namespace
}  // namespace elastocal
