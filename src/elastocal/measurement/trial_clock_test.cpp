// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/trial_clock.hpp"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/stable_samples.hpp"
#include "tests/test_robots.hpp"
#include "tests/trial_player.hpp"

namespace elastocal {
namespace {

std::vector<int> AllMarkers() {
  std::vector<int> markers(10);
  std::iota(markers.begin(), markers.end(), 0);
  return markers;
}

LoggedSpeeds Predict(const MarkedRobot& robot, const JointLog& log, int standing) {
  return PredictSpeeds(robot, AllMarkers(), {standing}, SmoothLog(log, {}), {0, 1, 2, 3, 4, 5},
                       100.0);
}

TEST(PredictSpeeds, AreThoseThatCamerasSee) {
  const MarkedRobot robot = MarkedTalosLeg();
  for (const int standing : {0, 6}) {
    PlayOptions options{.postures = 5, .marker_sd = 0.0, .standing = standing};
    const ScriptedTrial played = Play(robot, options);
    MarkerTrajectories markers = played.markers;
    SmoothTrajectories({}, markers);
    const Eigen::MatrixXd measured = MarkerSpeeds(markers);
    // The speeds have the cameras' rate, which is every second sample of the log.
    const LoggedSpeeds logged = Predict(robot, played.log, standing);
    EXPECT_NEAR(logged.time_s[1] - logged.time_s[0], 0.01, 1e-12);
    for (Eigen::Index i = 20; i + 20 < logged.time_s.size(); ++i) {
      const auto frame = std::lround(100.0 * logged.time_s[i]);
      // A filtered rotation differs slightly from a rotation by filtered angles. Speeds reach 0.5
      // m/s.
      EXPECT_LT((logged.speeds.row(i) - measured.row(frame)).cwiseAbs().maxCoeff(), 2e-3) << i;
    }
    EXPECT_EQ(logged.speeds.col(9).maxCoeff() > 0.01, standing == 6);
  }
}

// A root link leans and shifts on three legs, each a crane of three axes. The feet turn with it
// about their centres, which do not move.
TEST(PredictSpeeds, TurnAboutTheCentresOfThreeFeet) {
  MarkedRobot robot;
  robot.tree = MakeRoot();
  std::vector<int> feet;
  const Eigen::Matrix3d places{{0.3, -0.2, -0.3}, {0.0, 0.25, -0.25}, {-0.5, -0.5, -0.4}};
  for (int k = 0; k < 3; ++k) {
    int link = 0;
    for (int axis = 0; axis < 3; ++axis) {
      link = AddJoint(robot.tree, "leg_" + std::to_string(3 * k + axis), link, Offset(0, 0, 0),
                      Eigen::Vector3d::Unit(axis), JointType::kPrismatic);
    }
    feet.push_back(link);
  }
  robot.markers.push_back({"ROOT", 0, {0.2, 0.1, 0.3}});
  const auto root_at = [](double time) {
    return Offset(0.03 * std::sin(time), 0.02 * std::sin(2.0 * time), 0.0) *
           RotAxis(Eigen::Vector3d::UnitX(), 0.1 * std::sin(time));
  };
  const auto positions_at = [&](double time) -> Eigen::Matrix3d {
    return root_at(time).inverse() * places;
  };
  JointLog log;
  log.time_s = Eigen::VectorXd::LinSpaced(1001, 0.0, 10.0);
  log.positions.resize(1001, 9);
  log.torques.setConstant(1001, 9, kNaN);
  for (Eigen::Index i = 0; i < 1001; ++i) {
    log.positions.row(i) = positions_at(log.time_s[i]).reshaped().transpose();
  }
  for (int k = 0; k < 9; ++k) log.names.push_back("leg_" + std::to_string(k));
  robot.q_not_logged = positions_at(0.0).reshaped();
  std::vector<int> coordinates(9);
  std::iota(coordinates.begin(), coordinates.end(), 0);
  const LoggedSpeeds logged =
      PredictSpeeds(robot, {0}, feet, SmoothLog(log, {}), coordinates, 100.0);
  for (Eigen::Index i = 100; i + 100 < logged.time_s.size(); ++i) {  // without the filter's ends
    const auto marker = [&](double time) { return root_at(time) * robot.markers[0].p_link_marker; };
    const double time = logged.time_s[i];
    EXPECT_NEAR(logged.speeds(i, 0), (marker(time + 1e-4) - marker(time - 1e-4)).norm() / 2e-4,
                5e-5);
  }
  EXPECT_GT(logged.speeds.maxCoeff(), 0.04);
}

TEST(EstimateTrialClock, IsNotMisledByMarkersThatComeAndGo) {
  const MarkedRobot robot = MarkedTalosLeg();
  ScriptedTrial played = Play(robot, {.postures = 40, .lag_s = 3.0, .drift_ppm = 20.0});
  Random random(3);
  // The markers of the foot, which are the fastest, are missing half of the time, during motions.
  for (int begin = 0; begin + 150 < played.markers.frame_count(); begin += 300) {
    const int late = random.Index(100);
    for (const int marker : {6, 7, 8}) Hide(played.markers, marker, begin + late, 150);
  }
  SmoothTrajectories({}, played.markers);
  const ClockFit clock = EstimateTrialClock(MarkerSpeeds(played.markers), 100.0,
                                            Predict(robot, played.log, 0), std::nullopt, {});
  EXPECT_EQ(clock.state, ClockState::kReliable) << Describe(clock);
  for (const double time : {0.0, 200.0}) {
    EXPECT_LT(std::abs(clock.RobotTime(time) - ((1.0 + 20e-6) * time - 3.0)), 1e-3);
  }
}

TEST(EstimateTrialClock, IsNotMisledByLabelsThatWereExchangedForAWhile) {
  const MarkedRobot robot = MarkedTalosLeg();
  ScriptedTrial played = Play(robot, {.postures = 5, .lag_s = 3.0});
  // The two markers are far apart, so that each jumps. The rest of the trial is short and slow.
  Eigen::MatrixXd& positions = played.markers.positions;
  const Eigen::MatrixXd first = positions.block(900, 3 * 0, 140, 3);
  positions.block(900, 3 * 0, 140, 3) = positions.block(900, 3 * 8, 140, 3);
  positions.block(900, 3 * 8, 140, 3) = first;
  SmoothTrajectories({}, played.markers);
  const ClockFit clock = EstimateTrialClock(MarkerSpeeds(played.markers), 100.0,
                                            Predict(robot, played.log, 0), std::nullopt, {});
  EXPECT_EQ(clock.state, ClockState::kReliable) << Describe(clock);
  EXPECT_NEAR(clock.lag_s, 3.0, 2e-3);
}

TEST(EstimateTrialClock, SearchesAllWaysInWhichCamerasAndLogCanHaveRunTogether) {
  const MarkedRobot robot = MarkedTalosLeg();
  ScriptedTrial played = Play(robot, {.postures = 40, .lag_s = 1e6});
  SmoothTrajectories({}, played.markers);
  const Eigen::MatrixXd speeds = MarkerSpeeds(played.markers);
  const LoggedSpeeds logged = Predict(robot, played.log, 0);
  // The cameras record a minute in the middle of the log's three.
  const Eigen::MatrixXd middle = speeds.middleRows(7000, 6000);
  const ClockFit clock = EstimateTrialClock(middle, 100.0, logged, std::nullopt, {});
  EXPECT_EQ(clock.state, ClockState::kReliable) << Describe(clock);
  EXPECT_NEAR(clock.lag_s, 1e6 - 70.0, 2e-3);
  EXPECT_NE(EstimateTrialClock(middle, 100.0, logged, 1e6, {}).state, ClockState::kReliable);
  EXPECT_EQ(EstimateTrialClock(middle, 100.0, logged, 1e6 - 65.0, {}).state, ClockState::kReliable);
}

TEST(EstimateTrialClock, HasAStateForNoDataAtAll) {
  EXPECT_EQ(EstimateTrialClock({}, 100.0, {}, std::nullopt, {}).state, ClockState::kNoOverlap);
  const Eigen::MatrixXd unseen =
      Eigen::MatrixXd::Constant(100, 2, std::numeric_limits<double>::quiet_NaN());
  const LoggedSpeeds logged{Eigen::VectorXd::LinSpaced(100, 0.0, 1.0),
                            Eigen::MatrixXd::Ones(100, 2)};
  EXPECT_EQ(EstimateTrialClock(unseen, 100.0, logged, std::nullopt, {}).state,
            ClockState::kNoOverlap);
}

}  // namespace
}  // namespace elastocal
