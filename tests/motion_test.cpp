// SPDX-License-Identifier: Apache-2.0
// Estimates from moments of a motion, which share their model error with their neighbours in time.

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "elastocal/validation/model_comparison.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

constexpr int kMoments = 300;
constexpr double kRate = 10.0;         // Hz
constexpr double kCorrelation = 0.95;  // of the model error, from one moment to the next
constexpr double kShared = 0.5e-3;     // m, of the model error
constexpr double kNoise = 0.1e-3;      // m, of single markers

/// An arm that moves slowly while it is recorded ten times a second. Each body is displaced by a
/// model error of its own, a first-order process in time.
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
    const Geometry geometry = ApplyErrors(model, truth);
    Eigen::Matrix3Xd shared(3, model.tree.body_count());
    for (Eigen::Index k = 0; k < shared.cols(); ++k)
      shared.col(k) = random.NormalVector(3, kShared);
    for (int i = 0; i < kMoments; ++i) {
      const Eigen::Matrix3Xd positions =
          MarkerPositions(model, geometry, recording.q.row(i).transpose());
      for (int m = 0; m < model.marker_count(); ++m) {
        const int body = model.tree.links[model.markers[m].link].body;
        recording.markers.block<1, 3>(i, 3 * m) =
            (positions.col(m) + shared.col(body) + random.NormalVector(3, kNoise)).transpose();
      }
      for (Eigen::Index k = 0; k < shared.cols(); ++k) {
        shared.col(k) =
            kCorrelation * shared.col(k) +
            random.NormalVector(3, kShared * std::sqrt(1.0 - std::pow(kCorrelation, 2)));
      }
    }
    return recording;
  }

  CalibrationResult Estimate(const Recording& recording) const {
    return Calibrate(model, recording, base, ModelKind::kGeometric, {});
  }

  /// Of the joint offsets: how many of their intervals hold the truth, of how many.
  std::pair<int, int> Inside(const CalibrationResult& result) const {
    std::pair<int, int> inside = {0, 0};
    for (int i = 0; i < model.parameter_count(); ++i) {
      if (model.parameters[i].kind != ParameterKind::kTheta) continue;
      if (result.status[i] != ParameterStatus::kEstimated) continue;
      const double error = std::abs(result.delta[i] - truth[i]) / result.sd[i];
      inside.first += error < result.interval_factor ? 1 : 0;
      ++inside.second;
    }
    return inside;
  }
};

// Taken for independent, the moments promise several times what they hold.
TEST(Motion, IntervalsHoldTheTruthWhereNeighboursShareTheirError) {
  const SlowArm arm;
  int inside = 0;
  int all = 0;
  int inside_independent = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Recording recording = arm.Record(seed);
    const CalibrationResult result = arm.Estimate(recording);
    ASSERT_EQ(result.noise.motion.size(), 1u);
    EXPECT_NEAR(result.noise.motion[0].lag_one, kCorrelation, 0.08);
    EXPECT_GT(result.noise.motion[0].samples_each, 8.0);
    EXPECT_LT(result.noise.motion[0].samples_each, 80.0);
    const auto here = arm.Inside(result);
    inside += here.first;
    all += here.second;
    recording.time_s.resize(0);  // the same numbers, as postures that know nothing of each other
    const CalibrationResult independent = arm.Estimate(recording);
    EXPECT_TRUE(independent.noise.motion.empty());
    inside_independent += arm.Inside(independent).first;
  }
  std::printf("%d of %d inside; %d as independent postures\n", inside, all, inside_independent);
  EXPECT_GT(inside, 0.85 * all);
  EXPECT_LT(inside_independent, 0.7 * all);
}

// What shares its error with a left-out moment is left out as well.
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
