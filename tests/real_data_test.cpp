// SPDX-License-Identifier: Apache-2.0
// The measured left arm of a TALOS (shared data, not part of this repository).

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "elastocal/io/posture_table.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "elastocal/validation/model_comparison.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

class LeftArm : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto file = SharedFile("data/talos_left_arm_mocap/talos_left_arm_02_10_contact.csv");
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
    project_ = ReadProject(SourceFile("examples/talos_left_arm/project.yaml"));
    recording_ = ReadPostureTable(file, project_).recording;
    model_ = MakeErrorModel(project_.tree, project_.markers);
    base_ = FindBaseParameters(model_, project_.identifiability);
  }

  static Transform WaistPose(const CalibrationResult& result) {
    const Eigen::VectorXd q = Eigen::VectorXd::Zero(result.model.tree.coordinate_count());
    return BodyTransforms(result.model, ApplyErrors(result.model, result.delta), q)[0];
  }

  struct Truth {
    Eigen::VectorXd delta;
    Recording recording;
  };

  /// The recorded postures with the markers of a random robot and noise of 0.2 mm.
  Truth Generate(double factor, int seed) const {
    const Prior& prior = project_.calibration.prior;
    std::map<ParameterKind, double> sd;
    for (int kind = 0; kind < kParameterKindCount; ++kind) {
      if (!IsExternal(static_cast<ParameterKind>(kind))) {
        sd[static_cast<ParameterKind>(kind)] = factor * prior.sd[kind];
      }
    }
    std::vector<int> all(model_.parameter_count());
    std::iota(all.begin(), all.end(), 0);
    Truth truth{DrawErrors(model_, all, sd, 500u + seed), recording_};
    const Geometry geometry = ApplyErrors(model_, truth.delta);
    Random random(900u + seed);
    for (int i = 0; i < recording_.posture_count(); ++i) {
      const Eigen::VectorXd q = recording_.q.row(i).transpose();
      truth.recording.markers.row(i) =
          (MarkerPositions(model_, geometry, q).col(0) + random.NormalVector(3, 0.2e-3))
              .transpose();
    }
    return truth;
  }

  Project project_;
  Recording recording_;
  ErrorModel model_;
  BaseParameters base_;
};

TEST_F(LeftArm, ErrorsAreAsSmallAsPromised) {
  EXPECT_EQ(recording_.posture_count(), 61);
  EXPECT_EQ(base_.kept.size(), 39u);
  const ModelComparison comparison = CompareModels(model_, recording_, base_, project_.calibration);
  const CrossValidation folds =
      CrossValidate(comparison, model_, recording_, base_, project_.calibration, {});
  EXPECT_EQ(comparison.largest().termination, Termination::kConverged);
  EXPECT_TRUE(comparison.largest().outliers.empty());
  EXPECT_LE(comparison.metrics[0].rmse_3d, 5.2e-3);
  EXPECT_LE(comparison.metrics[1].rmse_3d, 1.5e-3);
  EXPECT_LE(comparison.metrics[2].rmse_3d, 0.65e-3);
  EXPECT_LE(folds.metrics[2].rmse_3d, 0.80e-3);
}

// In the paper's Table 1, the shoulder's offset is also the largest of the arm: 1.73 degrees, found
// on the same robot with other markers and another recording.
TEST_F(LeftArm, ShoulderOffsetAgreesWithThePaper) {
  const CalibrationResult result =
      Calibrate(model_, recording_, base_, ModelKind::kGeometric, project_.calibration);
  const int shoulder = FindParameter(model_.parameters, "arm_left_1_joint.theta");
  EXPECT_NEAR(result.delta[shoulder], 1.73 * M_PI / 180.0, 2.0 * result.sd[shoulder]);
}

TEST_F(LeftArm, ShiftedDuplicateIsNamedAndChangesNothing) {
  const CalibrationResult clean =
      Calibrate(model_, recording_, base_, ModelKind::kGeometric, project_.calibration);
  std::vector<int> rows(61);
  for (int i = 0; i < 61; ++i) rows[i] = i;
  rows.push_back(10);
  Recording with_outlier = SelectPostures(recording_, rows);
  with_outlier.markers(61, 0) += 95e-3;
  const CalibrationResult result =
      Calibrate(model_, with_outlier, base_, ModelKind::kGeometric, project_.calibration);
  ASSERT_EQ(result.outliers.size(), 1u);
  EXPECT_EQ(result.outliers[0].posture, 61);
  EXPECT_NEAR(result.outliers[0].residual, 95e-3, 1.5e-3);
  for (int i : base_.kept) {
    if (model_.parameters[i].kind == ParameterKind::kWaistPose) continue;
    EXPECT_LT(std::abs(result.delta[i] - clean.delta[i]), 0.5 * clean.sd[i])
        << model_.parameters[i].name;
  }
  // T0 counts from another registration, so the waist itself is compared. To first order, gamma,
  // alpha and theta turn it about z, x and y, and b, d and r move it along z, x and y.
  const Transform T = WaistPose(clean).inverse() * WaistPose(result);
  const Eigen::AngleAxisd turn(T.linear());
  const Eigen::Vector3d rotation = turn.angle() * turn.axis();
  const auto sd = [&](const char* name) {
    return clean.sd[FindParameter(model_.parameters, std::string("waist.T0.") + name)];
  };
  const Eigen::Vector3d rotation_sd(sd("alpha"), sd("theta"), sd("gamma"));
  const Eigen::Vector3d translation_sd(sd("d"), sd("r"), sd("b"));
  EXPECT_LT((rotation.array() / rotation_sd.array()).abs().maxCoeff(), 0.5);
  EXPECT_LT((T.translation().array() / translation_sd.array()).abs().maxCoeff(), 0.5);
}

// Intervals for postures that excite the wrist badly (condition number 5e4). Markers are generated,
// with a truth drawn from the prior or from three times the prior, which must then be widened.
TEST_F(LeftArm, IntervalsHoldOnBadlyExcitedPostures) {
  for (double factor : {1.0, 3.0}) {
    int inside[2] = {0, 0}, all[2] = {0, 0};  // for estimated, for unsupported ones
    for (int seed = 0; seed < 100; ++seed) {
      const Truth truth = Generate(factor, seed);
      const CalibrationResult result =
          Calibrate(model_, truth.recording, base_, ModelKind::kGeometric, project_.calibration);
      for (int i = 0; i < model_.parameter_count(); ++i) {
        if (model_.parameters[i].joint < 0) continue;
        const bool held = result.status[i] == ParameterStatus::kUnsupported;
        inside[held] +=
            std::abs(result.delta[i] - truth.delta[i]) <= result.interval_factor * result.sd[i];
        ++all[held];
      }
    }
    std::printf("truth of %.0f x prior: %.1f %% of %d estimated, %.1f %% of %d held\n", factor,
                100.0 * inside[0] / all[0], all[0], 100.0 * inside[1] / all[1], all[1]);
    EXPECT_GE(inside[0], 0.91 * all[0]);
    EXPECT_LE(inside[0], 0.98 * all[0]);
    EXPECT_GE(inside[1], 0.80 * all[1]);  // known to be too short at the prior: docs/accuracy.md
  }
}

}  // namespace
}  // namespace elastocal
