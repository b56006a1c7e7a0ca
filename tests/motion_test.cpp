// SPDX-License-Identifier: Apache-2.0
// Estimates from moments of a motion, whose model errors are correlated in time.

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/screening/knocks.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "elastocal/validation/model_comparison.hpp"
#include "tests/slow_legs.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

constexpr int kMoments = 300;
constexpr double kRate = 10.0;         // Hz
constexpr double kCorrelation = 0.95;  // of the model error between successive moments
constexpr double kShared = 0.5e-3;     // m, standard deviation of the model error
constexpr double kNoise = 0.1e-3;      // m, noise of each marker
constexpr int kCycles = 10;

/// Number of intervals that hold the truth, and of all, for offsets of joints whose names begin
/// like this.
std::pair<int, int> OffsetsInside(const ErrorModel& model, const Eigen::VectorXd& truth,
                                  const CalibrationResult& result, const std::string& joints = "") {
  std::pair<int, int> inside = {0, 0};
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Parameter& parameter = model.parameters[i];
    if (parameter.kind != ParameterKind::kTheta || !parameter.name.starts_with(joints)) continue;
    if (result.status[i] != ParameterStatus::kEstimated) continue;
    const double error = std::abs(result.delta[i] - truth[i]) / result.sd[i];
    inside.first += error < result.interval_factor ? 1 : 0;
    ++inside.second;
  }
  return inside;
}

/// Numbers of intervals, of those that hold the truth, and of those that do if moments count as
/// independent.
struct Tally {
  int inside = 0, all = 0, independent = 0;

  void Add(std::pair<int, int> as_motion, std::pair<int, int> as_postures) {
    inside += as_motion.first;
    all += as_motion.second;
    independent += as_postures.first;
  }

  void Expect(double least, double most_independent) const {
    std::printf("%d of %d inside; %d as independent postures\n", inside, all, independent);
    EXPECT_GT(inside, least * all);
    EXPECT_LT(independent, most_independent * all);
  }
};

/// An arm that moves slowly and is recorded ten times a second. Each body is displaced by its own
/// model error, a first-order process in time.
struct SlowArm {
  Project project = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  ErrorModel model = MakeErrorModel(project.tree, project.markers, project.placement);
  BaseParameters base = FindBaseParameters(model, project.identifiability);
  Eigen::VectorXd truth = DrawErrors(
      model, base.kept, {{ParameterKind::kTheta, 0.01}, {ParameterKind::kMarker, 5e-3}}, 3);

  Recording Record(std::uint64_t seed) const {
    Random random(seed);
    Recording recording = MakeSyntheticRecording(model, truth, {.postures = kMoments});
    recording.time_s = Eigen::VectorXd::LinSpaced(kMoments, 0.0, (kMoments - 1) / kRate);
    for (const Joint& joint : project.tree.joints) {
      if (joint.coordinate < 0) continue;
      const double middle = 0.5 * (joint.limits.lower + joint.limits.upper);
      const double reach = 0.35 * (joint.limits.upper - joint.limits.lower);
      const double rate = random.Uniform(0.2, 0.6);  // rad/s
      const double phase = random.Uniform(0.0, 2.0 * M_PI);
      recording.q.col(joint.coordinate) =
          middle + reach * (rate * recording.time_s.array() + phase).sin();
    }
    std::vector<Eigen::Matrix3Xd> shared = {DrawShared(random, kShared)};
    for (int i = 1; i < kMoments; ++i) {
      shared.emplace_back(kCorrelation * shared.back() +
                          DrawShared(random, kShared * std::sqrt(1.0 - std::pow(kCorrelation, 2))));
    }
    See(shared, random, recording);
    return recording;
  }

  /// The arm repeats a cycle of 30 moments ten times. The error of a body is drawn for each moment
  /// of the cycle and is the same in each repetition.
  Recording RecordCycles(std::uint64_t seed) const {
    constexpr int kCycle = kMoments / kCycles;
    Random random(seed);
    Recording recording = MakeSyntheticRecording(model, truth, {.postures = kMoments});
    recording.time_s = Eigen::VectorXd::LinSpaced(kMoments, 0.0, (kMoments - 1) / kRate);
    std::vector<Eigen::Matrix3Xd> shared;
    for (int i = 0; i < kMoments; ++i) {
      shared.push_back(i < kCycle ? DrawShared(random, kShared)
                                  : Eigen::Matrix3Xd(shared[i % kCycle]));
      recording.q.row(i) = recording.q.row(i % kCycle);
    }
    See(shared, random, recording);
    return recording;
  }

  /// Draws a displacement of each body, m.
  Eigen::Matrix3Xd DrawShared(Random& random, double sd) const {
    Eigen::Matrix3Xd shared(3, model.tree.body_count());
    for (auto&& of_body : shared.colwise()) of_body = random.NormalVector(3, sd);
    return shared;
  }

  /// Sets the markers to where the recording's positions put them, with the displacements of their
  /// bodies in each moment and with noise.
  void See(const std::vector<Eigen::Matrix3Xd>& shared, Random& random,
           Recording& recording) const {
    const Geometry geometry = ApplyErrors(model, truth);
    for (int i = 0; i < kMoments; ++i) {
      const Eigen::Matrix3Xd positions =
          MarkerPositions(model, geometry, recording.q.row(i).transpose());
      for (int m = 0; m < model.marker_count(); ++m) {
        const int body = model.tree.links[model.markers[m].link].body;
        recording.markers.block<1, 3>(i, 3 * m) =
            (positions.col(m) + shared[i].col(body) + random.NormalVector(3, kNoise)).transpose();
      }
    }
  }

  CalibrationResult Estimate(const Recording& recording) const {
    return Calibrate(model, recording, base, ModelKind::kGeometric, {});
  }
};

// If the moments counted as independent, intervals would be several times too short.
TEST(Motion, IntervalsHoldTheTruthWhereNeighboursShareTheirError) {
  const SlowArm arm;
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Recording recording = arm.Record(seed);
    const CalibrationResult result = arm.Estimate(recording);
    ASSERT_EQ(result.noise.motion.size(), 1u);
    EXPECT_NEAR(result.noise.motion[0].bodies.lag_one, kCorrelation, 0.08);
    EXPECT_GT(result.noise.motion[0].bodies.samples_each, 8.0);
    EXPECT_LT(result.noise.motion[0].bodies.samples_each, 80.0);
    recording.time_s.resize(0);  // the same numbers as postures without times
    const CalibrationResult independent = arm.Estimate(recording);
    EXPECT_TRUE(independent.noise.motion.empty());
    tally.Add(OffsetsInside(arm.model, arm.truth, result),
              OffsetsInside(arm.model, arm.truth, independent));
  }
  tally.Expect(0.88, 0.5);
}

// Errors that are drawn for each moment of a cycle are not correlated with their neighbours, but
// with themselves one cycle later.
TEST(Motion, AMotionThatRepeatsItselfTellsNoMoreThanOnce) {
  const SlowArm arm;
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Recording recording = arm.RecordCycles(seed);
    const CalibrationResult result = arm.Estimate(recording);
    EXPECT_NEAR(result.noise.motion[0].bodies.lag_one, 0.0, 0.2);
    EXPECT_GT(result.noise.motion[0].bodies.samples_each, 0.7 * kCycles);
    EXPECT_LT(result.noise.motion[0].bodies.samples_each, 1.8 * kCycles);
    recording.time_s.resize(0);
    tally.Add(OffsetsInside(arm.model, arm.truth, result),
              OffsetsInside(arm.model, arm.truth, arm.Estimate(recording)));
  }
  tally.Expect(0.85, 0.8);
}

// The pose of the waist is unknown in each moment, so that errors of bodies are not correlated. The
// residuals of the standing foot's constraint are.
TEST(Motion, IntervalsOfLegsHoldTheTruthWhereTheConstraintErrsAsItsNeighbours) {
  const SlowLegs legs;
  Tally tally;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Recording recording = legs.Record(seed);
    const auto estimate = [&] {
      return Calibrate(legs.robot.model, recording, legs.robot.base, ModelKind::kFull, {});
    };
    const CalibrationResult result = estimate();
    ASSERT_EQ(result.noise.motion.size(), 3u);  // arms, and each of the legs
    for (const std::size_t leg : {1u, 2u}) {
      EXPECT_NEAR(result.noise.motion[leg].waist.lag_one, SlowLegs::kKept, 0.08);
      EXPECT_GT(result.noise.motion[leg].waist.samples_each, 10.0);
      EXPECT_EQ(result.noise.motion[leg].bodies.samples_each, 1.0);
    }
    for (Trial& trial : recording.trials) trial.moments = false;
    tally.Add(OffsetsInside(legs.robot.model, legs.truth, result, "leg_"),
              OffsetsInside(legs.robot.model, legs.truth, estimate(), "leg_"));
  }
  tally.Expect(0.9, 0.8);
}

// If moments counted as independent, model errors would be taken for knocks.
TEST(Motion, ErrorsThatLastAreNoKnocks) {
  const SlowLegs legs;
  std::vector<LabelCluster> clusters;
  for (const MarkerCluster& cluster : legs.robot.project.clusters) {
    clusters.push_back({cluster.name, cluster.markers});
  }
  const auto find = [&](const Recording& recording) {
    return FindKnocks(legs.robot.model, recording, legs.robot.base, clusters, {});
  };
  int as_motion = 0;
  int as_postures = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Recording recording = RecordWays(legs, 0.6e-3, Eigen::Vector3d::Zero(), seed);
    as_motion += find(recording).empty() ? 0 : 1;
    for (Trial& trial : recording.trials) trial.moments = false;
    as_postures += find(recording).empty() ? 0 : 1;
  }
  EXPECT_LE(as_motion, 1);
  EXPECT_GE(as_postures, 3);

  const Eigen::Vector3d push(0.0, 0.0, 4e-3);
  const std::vector<Knock> knocks = find(RecordWays(legs, 0.1e-3, push, 1));
  ASSERT_EQ(knocks.size(), 1u);
  EXPECT_EQ(knocks[0].cluster, "LSHANK");
  EXPECT_NEAR(knocks[0].posture, 80, 2);
  EXPECT_NEAR(knocks[0].distance, 4e-3, 1e-3);
}

// Moments whose errors are correlated with a left-out moment are left out, too.
TEST(Motion, FoldsLeaveStretchesOut) {
  const SlowArm arm;
  const Recording recording = arm.Record(1);
  const std::vector<int> fold = DealFolds(recording, {.folds = 5});
  int borders = 0;
  for (int i = 1; i < kMoments; ++i) borders += fold[i] != fold[i - 1] ? 1 : 0;
  EXPECT_LE(borders, 6);  // 30 s in stretches of 5 s
  EXPECT_EQ(FoldsFor(recording, 10), 6);
  Recording postures = recording;
  postures.time_s *= 100.0;
  EXPECT_EQ(FoldsFor(postures, 10), 10);
}

}  // namespace
}  // namespace elastocal
