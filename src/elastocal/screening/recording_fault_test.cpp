// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/recording_fault.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

/// One joint moves as a sine, with 10 postures a second, followed by as many rests.
Recording SineAndRests(double lag_s) {
  Recording recording;
  Trial sine, rests;
  sine.name = "sine";
  sine.kind = TrialKind::kSine;
  rests.name = "rests";
  recording.trials = {sine, rests};
  recording.q.resize(40, 1);
  recording.time_s.resize(40);
  for (int i = 0; i < 40; ++i) {
    recording.trial.push_back(i < 20 ? 0 : 1);
    recording.time_s[i] = 0.1 * (i % 20);
    recording.q(i, 0) = std::sin(recording.time_s[i] - (i < 20 ? lag_s : 0.0));
  }
  return recording;
}

TEST(RecordingFault, ALagIsUndoneByTheVelocityOfMotions) {
  const RecordingFault lag{.kind = FaultKind::kJointLag, .coordinate = 0, .size = 0.05};
  const Recording without = WithoutFault(SineAndRests(0.05), lag), truth = SineAndRests(0.0);
  // The error is of second order in the lag (0.0013), and at the ends half a step of 0.1 s in the
  // velocity (0.05 / 20).
  EXPECT_LT((without.q - truth.q).cwiseAbs().maxCoeff(), 4e-3);
  EXPECT_EQ(without.q.bottomRows(20), truth.q.bottomRows(20));
  EXPECT_EQ(FactorOf(lag, truth, 25), 0.0);
}

TEST(RecordingFault, ADriftOfATrialIsUndoneThere) {
  RecordingFault drift{.kind = FaultKind::kJointDrift,
                       .coordinate = 0,
                       .trial = 1,
                       .posture = 20,
                       .size = 0.19,
                       .end = 40};
  const Recording recording = SineAndRests(0.0);
  const Eigen::VectorXd undone = recording.q.col(0) - WithoutFault(recording, drift).q.col(0);
  EXPECT_TRUE(undone.head(20).isZero(0.0));
  EXPECT_TRUE(undone.tail(20).isApprox(Eigen::VectorXd::LinSpaced(20, 0.0, 0.19), 1e-12));
  drift.trial = -1;  // in the whole recording, 39 steps
  drift.posture = drift.end = 0;
  EXPECT_NEAR(FactorOf(drift, recording, 13), 1.0 / 3.0, 1e-12);
}

TEST(RecordingFault, AScaleOfOneAxisIsUndoneThere) {
  Recording recording = SineAndRests(0.0);
  recording.marker_names = {"A", "B"};
  recording.markers = Eigen::MatrixXd::Ones(40, 6);
  const RecordingFault scale{.kind = FaultKind::kCameraAxis, .size = 0.25, .axis = 1};
  const Recording without = WithoutFault(recording, scale);
  Eigen::RowVectorXd expected(6);
  expected << 1.0, 0.8, 1.0, 1.0, 0.8, 1.0;
  EXPECT_EQ(Eigen::RowVectorXd(without.markers.row(7)), expected);
}

}  // namespace
}  // namespace elastocal
