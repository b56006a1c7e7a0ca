// SPDX-License-Identifier: Apache-2.0
#include "elastocal/fleet/family.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

constexpr double kSd = 1e-4;  // rad, standard deviation of an estimate

/// A robot of two joints.
FleetMember MakeMember(const std::string& robot, double first, double second,
                       const std::string& batch = "", std::optional<double> day = {}) {
  FleetMember member{.session = robot, .robot = robot, .batch = batch, .day = day, .estimate = {}};
  member.urdf_error = 1e-3;
  CalibrationEstimate& estimate = member.estimate;
  estimate.source = robot;
  estimate.robot = "two";
  estimate.model = "geometric";
  for (const auto& [name, value] :
       {std::pair{"one.theta", first}, std::pair{"two.theta", second}}) {
    estimate.parameters.push_back({.name = name, .unit = "rad", .value = value, .sd = kSd});
    estimate.covariance_names.emplace_back(name);
  }
  estimate.covariance = Eigen::Vector2d(kSd * kSd, kSd * kSd).asDiagonal();
  return member;
}

std::vector<FleetMember> DrawFleet(int robots, std::uint64_t seed) {
  Random random(seed);
  std::vector<FleetMember> fleet;
  for (int r = 0; r < robots; ++r) {
    const double one = random.Normal(5e-3) + random.Normal(kSd);
    fleet.push_back(MakeMember("r" + std::to_string(r), one, 1e-2 + random.Normal(2e-3)));
  }
  return fleet;
}

TEST(Family, ARobotUnlikeTheOthersIsNamedAndAFleetAlikeIsNot) {
  int false_alarms = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    std::vector<FleetMember> fleet = DrawFleet(20, seed);
    false_alarms += StudyFamily(fleet).out_of_family.empty() ? 0 : 1;
    fleet[7].estimate.parameters[0].value = 0.06;
    const FleetFamily family = StudyFamily(fleet);
    ASSERT_FALSE(family.out_of_family.empty()) << seed;
    EXPECT_EQ(family.out_of_family[0].robot, "r7");
    EXPECT_EQ(family.out_of_family[0].parameter, "one.theta");
    const auto& workshop = family.workshop;
    EXPECT_NE(std::find(workshop.begin(), workshop.end(), "r7"), workshop.end());
  }
  EXPECT_LE(false_alarms, 20);  // 10 (5 %) are expected; the probability of 21 or more is 0.1 %
}

TEST(Family, ScatterBetweenRobotsIsWithoutThatOfTheirCalibrations) {
  // The values are 1, 2 and 3 mrad. Their variance is 1e-6, of which 1e-8 belongs to the estimates.
  const FleetFamily family = StudyFamily(
      {MakeMember("a", 1e-3, 0.0), MakeMember("b", 2e-3, 0.0), MakeMember("c", 3e-3, 0.0)});
  ASSERT_EQ(family.parameters.size(), 2u);
  EXPECT_NEAR(family.parameters[0].mean, 2e-3, 1e-15);
  EXPECT_NEAR(family.parameters[0].sd, std::sqrt(1e-6 - 1e-8), 1e-12);
  EXPECT_EQ(family.parameters[0].robots, 3);
  EXPECT_EQ(family.parameters[1].sd, 0.0);
}

TEST(Family, ABatchUnlikeTheOthersIsNamed) {
  std::vector<FleetMember> fleet = DrawFleet(24, 3);
  for (std::size_t r = 0; r < fleet.size(); ++r) {
    fleet[r].batch = r % 2 == 0 ? "spring" : "autumn";
    if (r % 2 == 0) fleet[r].estimate.parameters[1].value += 8e-3;
  }
  const FleetFamily family = StudyFamily(fleet);
  ASSERT_EQ(family.batches.size(), 2u);  // each batch against the other
  EXPECT_EQ(family.batches[0].parameter, "two.theta");
  EXPECT_NEAR(std::abs(family.batches[0].difference), 8e-3, 3e-3);
}

TEST(Family, DriftIsALineThroughTheSessions) {
  std::vector<FleetMember> sessions;
  for (int month = 0; month < 4; ++month) {
    sessions.push_back(MakeMember("a", 1e-3 + 2e-4 * month, 0.0, "", 30.0 * month));
    sessions.push_back(MakeMember("b", 1e-3, 0.0, "", 30.0 * month));
  }
  const FleetFamily family = StudyFamily(sessions);
  ASSERT_EQ(family.drifts.size(), 1u);
  EXPECT_EQ(family.drifts[0].robot, "a");
  EXPECT_NEAR(family.drifts[0].per_day, 2e-4 / 30.0, 1e-12);
  // The days are -45, -15, 15 and 45 from their mean.
  EXPECT_NEAR(family.drifts[0].sd, kSd / std::sqrt(2.0 * (45.0 * 45.0 + 15.0 * 15.0)), 1e-12);
  EXPECT_EQ(LastSessions(sessions).size(), 2u);
  EXPECT_EQ(LastSessions(sessions)[0].day, 90.0);
}

TEST(Family, PriorIsMeanUncertaintyAndScatter) {
  const std::vector<FleetMember> robots = {MakeMember("a", 1e-3, 0.0), MakeMember("b", 2e-3, 0.0),
                                           MakeMember("c", 3e-3, 0.0)};
  const CalibrationEstimate prior = FleetPrior(robots, 0.0);
  ASSERT_EQ(prior.covariance_names.size(), 2u);
  EXPECT_NEAR(prior.parameters[0].value, 2e-3, 1e-15);
  EXPECT_NEAR(prior.covariance(0, 0), 1e-8 + 2e-6 / 3.0, 1e-15);
  EXPECT_NEAR(prior.covariance(1, 1), 1e-8, 1e-20);
  // The prior counts like four more robots: both thetas scatter by a third of 1e-6 on average.
  EXPECT_NEAR(FleetPrior(robots, 4.0).covariance(1, 1), 1e-8 + 4.0 / 7.0 * 1e-6 / 3.0, 1e-15);
  EXPECT_THROW(FleetPrior({robots[0], robots[1]}), InputError);
}

}  // namespace
}  // namespace elastocal
