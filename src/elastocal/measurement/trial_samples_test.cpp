// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/trial_samples.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/smooth_step.hpp"
#include "elastocal/measurement/merge_trials.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/standing_leg_trial.hpp"

namespace elastocal {
namespace {

// A sample is the mean of eight filtered frames. The filter passes a tenth of the bandwidth and so
// reduces noise from 0.2 mm at 100 Hz to 0.063 mm a frame. The tolerance is five times that.
constexpr double kMarkerTolerance = 0.3e-3;
constexpr double kTorqueTolerance = 0.2;  // N.m, for noise of 0.1 before filter and mean

// The posture that is held at this time, or the nearest one.
Eigen::Index PostureAt(const ScriptedTrial& played, double time_s) {
  Eigen::Index posture = 0;
  (played.rest_begin_s.array() + 0.75 - time_s).abs().minCoeff(&posture);
  return posture;
}

// Checks that each sample has its own played posture, up to noise.
void ExpectTrue(const TrialSamples& samples, const ScriptedTrial& played, int standing = kFoot) {
  const MarkedRobot robot = WaistAndLeg();
  Eigen::Index last = -1;
  for (Eigen::Index i = 0; i < samples.time_s.size(); ++i) {
    const Eigen::Index posture = PostureAt(played, samples.time_s[i]);
    EXPECT_GT(posture, last);
    last = posture;
    // At the threshold of rest, 5 mm/s, the joints still move a little.
    EXPECT_LT((samples.q.row(i) - played.q.row(posture)).cwiseAbs().maxCoeff(), 2e-3) << i;
    const Eigen::VectorXd positions = PlayedPositions(robot, standing, samples.q.row(i));
    const Eigen::VectorXd torques = PlayedTorques(robot.tree, samples.q.row(i));
    for (Eigen::Index c = 0; c < samples.markers.cols(); ++c) {
      if (std::isnan(samples.markers(i, c))) continue;
      EXPECT_NEAR(samples.markers(i, c), positions[c], kMarkerTolerance) << i << " " << c;
    }
    for (Eigen::Index k = 0; k < samples.torques.cols(); ++k) {
      if (std::isnan(samples.torques(i, k))) continue;
      EXPECT_NEAR(samples.torques(i, k), torques[k], kTorqueTolerance) << i << " " << k;
    }
  }
}

bool Names(const TrialSummary& summary, std::initializer_list<const char*> parts) {
  const std::vector<std::string> findings = Findings(summary);
  return std::any_of(findings.begin(), findings.end(), [&](const std::string& finding) {
    return std::all_of(parts.begin(), parts.end(),
                       [&](const char* part) { return finding.find(part) != std::string::npos; });
  });
}

TEST(SampleTrial, TakesEveryRestOfACleanTrial) {
  const ScriptedTrial played = PlayStanding();
  const TrialSamples samples = Sample(played);
  EXPECT_EQ(samples.summary.refused, "");
  EXPECT_EQ(samples.summary.postures, 24);
  EXPECT_EQ(samples.summary.samples, 24 * 8);
  EXPECT_TRUE(samples.markers.allFinite() && samples.torques.allFinite());
  EXPECT_TRUE(Findings(samples.summary).empty()) << Findings(samples.summary).front();
  EXPECT_EQ(PostureAt(played, samples.time_s[23]), 23);
  ExpectTrue(samples, played);
}

TEST(SampleTrial, HoldsTheRootWhereThereIsNoSupport) {
  const ScriptedTrial played = Play(WaistAndLeg(), {});
  const Trial trial{.name = "swing", .chains = {"leg"}};
  const TrialSamples samples = Sample(played, {}, trial);
  EXPECT_EQ(samples.summary.postures, 24) << samples.summary.refused;
  ExpectTrue(samples, played, 0);
}

/// The trial with the whole robot on a cart that drives to and fro and turns between the rests, but
/// stands still during each of them.
ScriptedTrial OnACart(ScriptedTrial played) {
  Random random(7);
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = from;  // place [m] and direction [rad]
  Eigen::Index posture = 0;
  for (Eigen::Index i = 0; i < played.markers.positions.rows(); ++i) {
    const double time = static_cast<double>(i) / played.markers.rate_hz;
    const bool next =
        posture + 1 < played.rest_begin_s.size() && time >= played.rest_begin_s[posture + 1];
    if (next) {
      ++posture;
      from = to;
      to = 0.4 * random.NormalVector(3, 1.0);
    }
    const double u = (time - played.rest_begin_s[posture] - 1.5) / 3.5;
    const Eigen::Vector3d place = from + SmoothStep(u) * (to - from);
    const Transform T = FromXyzRpy({place.x(), place.y(), 0.0}, {0.0, 0.0, place.z()});
    auto row = played.markers.positions.row(i);
    for (Eigen::Index c = 0; c < row.size(); c += 3) {
      row.segment<3>(c) = (T * row.segment<3>(c).transpose().eval()).transpose();
    }
  }
  return played;
}

// The speeds are then those relative to the waist. Those relative to the laboratory fit no clock.
TEST(SampleTrial, TellsTheClockOfARobotThatDrivesBetweenItsRests) {
  const ScriptedTrial played = OnACart(Play(WaistAndLeg(), {.lag_s = 2.3, .drift_ppm = 20.0}));
  Trial trial{.name = "cart", .chains = {"leg"}, .free_root = true};
  const TrialSamples samples = Sample(played, {}, trial);
  ASSERT_EQ(samples.summary.refused, "");
  EXPECT_EQ(samples.summary.postures, 24);
  for (const double time : {0.0, 110.0}) {
    // Samples are at least 60 ms away from the ends of a rest.
    EXPECT_NEAR(samples.summary.clock.RobotTime(time), (1.0 + 20e-6) * time - 2.3, 5e-3);
  }
  for (Eigen::Index i = 0; i < samples.q.rows(); ++i) {
    const Eigen::Index posture = PostureAt(played, samples.time_s[i]);
    EXPECT_LT((samples.q.row(i) - played.q.row(posture)).cwiseAbs().maxCoeff(), 2e-3) << i;
  }
  trial.free_root = false;
  EXPECT_NE(Sample(played, {}, trial).summary.refused, "");
  // If the waist lacks a marker, motion relative to the thigh tells the clock.
  ScriptedTrial without = played;
  without.markers.positions.leftCols(3).setConstant(kNaN);
  trial.free_root = true;
  EXPECT_EQ(Sample(without, {}, trial).summary.refused, "");
}

TEST(SampleTrialStudy, PositionsTellTheClockWhereSpeedsDoNot) {
  const ScriptedTrial played = PlayStanding();
  MeasurementOptions options;
  const double sd = Sample(played).summary.clock.sd_s;
  ASSERT_GT(sd, 1e-5);
  options.largest_rest_lag_sd_s = sd / 3.0;
  const TrialSummary told = Sample(played, options).summary;
  EXPECT_EQ(told.refused, "");
  EXPECT_LT(told.clock.sd_s, sd / 3.0);
  options.largest_rest_lag_sd_s = 1e-7;
  EXPECT_NE(Sample(played, options).summary.refused.find("too little motion"), std::string::npos);
}

TEST(SampleTrial, FindsLagAndDriftOfTheClock) {
  for (const auto& [lag, drift] : {std::pair{4.0, 20.0}, std::pair{-4.0, -20.0}}) {
    PlayOptions options{.postures = 60, .lag_s = lag, .drift_ppm = drift};
    ScriptedTrial played = PlayStanding(options);
    // The log begins 4 s late, and both clocks begin at 0.
    const Eigen::Index late = 800;
    const Eigen::Index left = played.log.time_s.size() - late;
    played.log.time_s = played.log.time_s.tail(left).eval();
    played.log.positions = played.log.positions.bottomRows(left).eval();
    played.log.torques = played.log.torques.bottomRows(left).eval();
    const TrialSamples samples = Sample(played);
    ASSERT_EQ(samples.summary.refused, "");
    const ClockFit& clock = samples.summary.clock;
    for (const double time : {0.0, 300.0}) {
      EXPECT_LT(std::abs(clock.RobotTime(time) - ((1.0 + 1e-6 * drift) * time - lag)), 2e-3);
    }
    EXPECT_EQ(samples.summary.postures, 59);  // the first rest is over before
    ExpectTrue(samples, played);
  }
}

// Little motion tells the clock badly. Rests need no precise clock, because their samples are away
// from motions.
TEST(SampleTrial, TakesRestsWhoseClockIsRoughlyKnown) {
  const ScriptedTrial played = PlayStanding({.postures = 16, .range = 0.03});
  const TrialSamples samples = Sample(played);
  EXPECT_GT(samples.summary.clock.sd_s, 15e-3);
  EXPECT_EQ(samples.summary.postures, 16) << samples.summary.refused;
  ExpectTrue(samples, played);
}

TEST(SampleTrial, BearsFivePerCentOfSamplesMissing) {
  ScriptedTrial played = PlayStanding();
  Random random(5);
  const auto frames = static_cast<int>(played.markers.positions.rows());
  for (int marker = 0; marker < 12; ++marker) {
    for (int missing = 0; missing < frames / 20;) {
      // Some gaps are shorter and some longer than those that are filled.
      const int size = 1 + random.Index(40);
      Hide(played.markers, marker, random.Index(frames - size), size);
      missing += size;
    }
  }
  const TrialSamples samples = Sample(played);
  EXPECT_EQ(samples.summary.postures, 24) << samples.summary.refused;
  ExpectTrue(samples, played);
  const Eigen::Index missing = samples.markers.array().isNaN().count();
  EXPECT_LT(missing, samples.markers.size() / 20);
  int filled = 0;
  int open = 0;
  for (const MarkerSmoothing& smoothing : samples.summary.smoothing) {
    filled += FrameCount(smoothing.filled);
    open += FrameCount(smoothing.open);
  }
  EXPECT_GT(filled, 0);
  EXPECT_GT(open, 0);
}

TEST(SampleTrial, BearsAMarkerLostForHalfOfTheTrial) {
  ScriptedTrial played = PlayStanding();
  const Eigen::Index half = played.markers.positions.rows() / 2;
  Hide(played.markers, 4, half, half);
  const TrialSamples samples = Sample(played);
  EXPECT_EQ(samples.summary.postures, 24) << samples.summary.refused;
  ExpectTrue(samples, played);
  EXPECT_NEAR(static_cast<double>(samples.summary.postures_seen[4]), 12.0, 1.0);
  EXPECT_EQ(samples.summary.postures_seen[5], 24);
  EXPECT_TRUE(Names(samples.summary, {"THIGH_2", "50 %"}));
}

TEST(SampleTrial, PutsExchangedLabelsRight) {
  ScriptedTrial played = PlayStanding();
  const Eigen::MatrixXd first = played.markers.positions.block(3000, 3 * 6, 2000, 3);
  played.markers.positions.block(3000, 3 * 6, 2000, 3) =
      played.markers.positions.block(3000, 3 * 8, 2000, 3).eval();
  played.markers.positions.block(3000, 3 * 8, 2000, 3) = first;
  const TrialSamples samples = Sample(played);
  EXPECT_EQ(samples.summary.postures, 24) << samples.summary.refused;
  EXPECT_TRUE(samples.markers.allFinite());
  ExpectTrue(samples, played);
  EXPECT_TRUE(Names(samples.summary, {"SHANK_1, SHANK_3", "30.00 s to 50.00 s"}));
}

TEST(SampleTrial, RemovesOutliers) {
  ScriptedTrial played = PlayStanding();
  Random random(9);
  for (int i = 0; i < 100; ++i) {
    const int frame = random.Index(static_cast<int>(played.markers.positions.rows()));
    played.markers.positions.block(frame, 3 * random.Index(12), 1, 3).array() += 0.05;
  }
  const TrialSamples samples = Sample(played);
  EXPECT_EQ(samples.summary.postures, 24) << samples.summary.refused;
  ExpectTrue(samples, played);
  EXPECT_TRUE(Names(samples.summary, {"outlying positions of 12 markers removed"}));
}

TEST(SampleTrial, LeavesBadTorqueSensorsOut) {
  ScriptedTrial played = PlayStanding();
  played.log.torques.col(3).setZero();
  played.log.torques.col(1) = played.log.torques.col(1).cwiseMin(15.0);
  played.log.torques.col(4).tail(played.log.torques.rows() / 3).setConstant(1.5);
  const TrialSamples samples = Sample(played);
  EXPECT_EQ(samples.summary.postures, 24) << samples.summary.refused;
  ExpectTrue(samples, played);
  for (const int joint : {1, 3, 4}) EXPECT_TRUE(samples.torques.col(joint).array().isNaN().all());
  for (const int joint : {0, 2, 5}) EXPECT_TRUE(samples.torques.col(joint).allFinite());
  EXPECT_TRUE(Names(samples.summary, {"leg_2", "saturated", "15"}));
  EXPECT_TRUE(Names(samples.summary, {"leg_4", "dead (0 throughout)"}));
  EXPECT_TRUE(Names(samples.summary, {"leg_5", "stuck", "1.5"}));
}

TEST(SampleTrial, UsesWhatALogThatEndsEarlyCovers) {
  ScriptedTrial played = PlayStanding();
  const Eigen::Index kept = 200 * 71;  // within the 15th posture's rest from 70 s on
  played.log.time_s.conservativeResize(kept);
  played.log.positions.conservativeResize(kept, Eigen::NoChange);
  played.log.torques.conservativeResize(kept, Eigen::NoChange);
  const TrialSamples samples = Sample(played);
  EXPECT_EQ(samples.summary.postures, 15) << samples.summary.refused;
  EXPECT_LT(samples.time_s[14], 71.0);
  ExpectTrue(samples, played);
  EXPECT_NEAR(samples.summary.outside_log, 100 * (116.5 - 71.0), 20);
  EXPECT_TRUE(Names(samples.summary, {"0.0 s to 71.0 s of the marker file's 116.5 s"}));
}

TEST(SampleTrial, TakesMomentsOfASineMotion) {
  PlayOptions options{.postures = 12, .move_s = 2.0, .rest_s = 0.0};
  options.standing = kFoot;
  const MarkedRobot robot = WaistAndLeg();
  const PlayedMotion motion(robot.tree, options);
  const ScriptedTrial played = Play(robot, options);
  const TrialSamples samples = Sample(played, {}, Standing(TrialKind::kSine));
  ASSERT_EQ(samples.summary.refused, "");
  EXPECT_NEAR(samples.summary.postures, 220, 5);
  for (Eigen::Index i = 1; i < samples.time_s.size(); ++i) {
    EXPECT_NEAR(samples.time_s[i] - samples.time_s[i - 1], 0.1, 1e-9);
    // The filter smooths both motions alike. What remains is the difference between postures of
    // filtered angles and filtered postures.
    const Eigen::VectorXd q = motion.At(samples.time_s[i]);
    EXPECT_LT((samples.q.row(i).transpose() - q).cwiseAbs().maxCoeff(), 5e-3);
    const Eigen::VectorXd markers = PlayedPositions(robot, kFoot, samples.q.row(i));
    EXPECT_LT((samples.markers.row(i).transpose() - markers).cwiseAbs().maxCoeff(), 2e-3);
  }
}

TEST(SampleTrial, RefusesAnotherRobotsLog) {
  ScriptedTrial played = PlayStanding();
  played.log = PlayStanding({.seed = 77}).log;
  played.log.positions = played.log.positions.rowwise().reverse().eval() * 0.01;
  const TrialSamples samples = Sample(played);
  EXPECT_EQ(samples.summary.postures, 0);
  EXPECT_TRUE(samples.frames.empty());
  EXPECT_NE(samples.summary.clock.state, ClockState::kReliable);
  EXPECT_TRUE(Names(samples.summary, {"trial stand: not used: "}));
}

TEST(SampleTrial, RefusesRatesThatTheFilterCannotTake) {
  const MarkedRobot robot = WaistAndLeg();
  ScriptedTrial slow = PlayStanding({.postures = 3, .frame_rate_hz = 9.0});
  ExpectInputError([&] { Sample(slow); }, {"played.tsv", "9 frames a second", "10"});
  ScriptedTrial slow_log = PlayStanding({.postures = 3, .log_rate_hz = 20.0});
  EXPECT_NO_THROW(Sample(slow_log));
}

TEST(SampleTrial, ReportsMarkersItDoesNotFindOrKnow) {
  ScriptedTrial played = PlayStanding();
  played.markers.names[7] = "NEW_0001";
  Hide(played.markers, 11, 0, played.markers.positions.rows());
  const TrialSamples samples = Sample(played);
  EXPECT_EQ(samples.summary.postures, 24) << samples.summary.refused;
  EXPECT_EQ(samples.summary.markers_missing, (std::vector<std::string>{"SHANK_2", "FOOT_3"}));
  EXPECT_EQ(samples.summary.markers_unknown, std::vector<std::string>{"NEW_0001"});
  EXPECT_TRUE(samples.markers.middleCols(3 * 7, 3).array().isNaN().all());
  played.markers.names.assign(12, "x");
  EXPECT_NE(Sample(played).summary.refused.find("none of its markers"), std::string::npos);
}

TEST(SampleTrial, NamesTheLabelThatIsNearlyThatOfAMissingMarker) {
  ScriptedTrial played = PlayStanding({.postures = 3});
  played.markers.names[7] = "robot:SHNK_2";
  EXPECT_TRUE(Names(Sample(played).summary, {"never seen: SHANK_2", "'robot:SHNK_2' for SHANK_2"}));
  played.markers.names[7] = "NEW_0001";
  EXPECT_TRUE(Names(Sample(played).summary, {"never seen: SHANK_2"}));
  EXPECT_FALSE(Names(Sample(played).summary, {"NEW_0001"}));
}

TEST(MergeTrials, PutsTrialsBelowEachOther) {
  const MarkedRobot robot = WaistAndLeg();
  const ScriptedTrial played = PlayStanding({.postures = 6});
  TrialSamples first =
      SampleTrial(robot, Standing(), {0, 1, 2, 9, 10, 11}, played.markers, played.log, {});
  TrialSamples second = SampleTrial(robot, Standing(TrialKind::kRandom), {0, 1, 2, 3},
                                    played.markers, played.log, {.rest = {.samples_per_run = 3}});
  second.summary.trial.name = "second";
  second.wrench_links = {kFoot};
  second.wrenches = Eigen::MatrixXd::Constant(6, 6, 7.0);
  const Recording recording = MergeTrials(robot, {first, second}, "folder");
  EXPECT_EQ(recording.source, "folder");
  ASSERT_EQ(recording.posture_count(), 12);
  EXPECT_EQ(recording.marker_names,
            (std::vector<std::string>{"WAIST_1", "WAIST_2", "WAIST_3", "THIGH_1", "FOOT_1",
                                      "FOOT_2", "FOOT_3"}));
  EXPECT_EQ(recording.trials[1].name, "second");
  EXPECT_EQ(recording.trial, (std::vector<int>{0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1}));
  EXPECT_EQ(recording.frames[5], 8);
  EXPECT_EQ(recording.frames[6], 3);
  EXPECT_FALSE(Seen(recording, 0, 3));
  EXPECT_TRUE(Seen(recording, 6, 3));
  EXPECT_EQ(MarkerPosition(recording, 2, 4), Eigen::Vector3d(first.markers.block<1, 3>(2, 27)));
  EXPECT_EQ(recording.q.row(7), second.q.row(1));
  EXPECT_EQ(recording.torques.rows(), 12);
  EXPECT_EQ(recording.wrench_links, std::vector<int>{kFoot});
  EXPECT_TRUE(recording.wrenches.topRows(6).array().isNaN().all());
  EXPECT_EQ(recording.wrenches(6, 5), 7.0);
}

}  // namespace
}  // namespace elastocal
