// SPDX-License-Identifier: Apache-2.0
// Verdicts of the estimator: outliers, unsupported parameters, and comparison of models.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/screening/recording_faults.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "elastocal/validation/model_comparison.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/test_files.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

using Kind = ParameterKind;

class LegEstimation : public ::testing::Test {
 protected:
  Recording Record(const Eigen::VectorXd& delta, int postures, std::uint64_t seed = 1) const {
    return MakeSyntheticRecording(model_, delta, {.postures = postures, .seed = seed});
  }
  CalibrationResult Estimate(const Recording& recording,
                             const CalibrationOptions& options = {}) const {
    return Calibrate(model_, recording, base_, ModelKind::kGeometric, options);
  }
  int Find(const char* name) const { return FindParameter(model_.parameters, name); }

  ErrorModel model_ = TalosLegModel();
  BaseParameters base_ = FindBaseParameters(model_, {});
  Eigen::VectorXd truth_ = DrawErrors(
      model_, base_.kept, {{Kind::kTheta, 0.01}, {Kind::kD, 1e-3}, {Kind::kMarker, 5e-3}}, 2);
};

TEST_F(LegEstimation, OutliersAreNamedAndTheRestIsLeftAlone) {
  const Recording clean = Record(truth_, 30);
  Recording recording = clean;
  recording.markers(4, 3 * 2 + 1) += 3e-3;  // 15 times the noise
  recording.markers(17, 3 * 8) -= 0.5;      // for instance a swapped label
  recording.markers(17, 3 * 7) -= 0.5;
  const CalibrationResult result = Estimate(recording);
  ASSERT_EQ(result.outliers.size(), 3u);
  EXPECT_EQ(result.outliers[0].posture, 4);
  EXPECT_EQ(result.outliers[0].marker, 2);
  EXPECT_NEAR(result.outliers[0].residual, 3e-3, 1e-3);
  EXPECT_EQ(result.outliers[1].marker, 7);
  EXPECT_EQ(result.outliers[2].marker, 8);
  EXPECT_EQ(result.equations, 3 * (30 * 9 - 3));
  EXPECT_FALSE(result.used(4, 2));
  const CalibrationResult without = Estimate(clean);
  for (int i : base_.kept) {
    if (model_.parameters[i].kind == Kind::kWaistPose) continue;
    EXPECT_LT(std::abs(result.delta[i] - without.delta[i]), 0.5 * without.sd[i])
        << model_.parameters[i].name;
  }
}

TEST_F(LegEstimation, FaultsOfARecordingAreNamed) {
  const Recording clean = Record(truth_, 40);
  EXPECT_TRUE(FindRecordingFaults(Estimate(clean), clean, {}).empty());
  const int joint = 3;
  const int coordinate = model_.tree.joints[joint].coordinate;
  Recording gain = clean;
  gain.q.col(coordinate) *= 1.02;
  const std::vector<RecordingFault> of_gain = FindRecordingFaults(Estimate(gain), gain, {});
  ASSERT_FALSE(of_gain.empty());
  EXPECT_EQ(of_gain[0].kind, FaultKind::kJointGain);
  EXPECT_EQ(of_gain[0].coordinate, coordinate);
  EXPECT_NEAR(of_gain[0].size, 0.02, 0.002);
  Recording offset = clean;
  offset.q.col(coordinate).tail(19).array() += 0.02;  // between two of the postures that are tried
  const std::vector<RecordingFault> of_offset = FindRecordingFaults(Estimate(offset), offset, {});
  ASSERT_FALSE(of_offset.empty());
  EXPECT_EQ(of_offset[0].kind, FaultKind::kJointOffset);
  EXPECT_EQ(of_offset[0].coordinate, coordinate);
  EXPECT_EQ(of_offset[0].posture, 21);
  EXPECT_NEAR(of_offset[0].size, 0.02, 0.005);
  const std::string text = DescribeFault(of_offset[0], model_.tree, offset);
  EXPECT_EQ(text.find(model_.tree.joints[joint].name + ": its positions are off by"), 0u) << text;
}

// In one clean recording in a hundred an outlier is named, even if few residuals tell the noise.
// The probability of more than 9 in 300 is one in a thousand.
TEST_F(LegEstimation, CleanRecordingsHaveOutliersAsRarelyAsPromised) {
  int with_outliers = 0;
  for (int seed = 0; seed < 300; ++seed) {
    with_outliers += Estimate(Record(truth_, 5, 100u + seed)).outliers.empty() ? 0 : 1;
  }
  std::printf("outliers in %d of 300 clean recordings\n", with_outliers);
  EXPECT_LE(with_outliers, 9);
}

TEST_F(LegEstimation, ParametersWithoutSupportAreListed) {
  // The ankle's roll joint stands still. Its axis is unknown, and its marker positions absorb its
  // errors.
  Recording recording = Record(truth_, 30);
  ErrorModel still = model_;
  Eigen::MatrixXd& q = recording.q;
  const Geometry geometry = ApplyErrors(still, truth_);
  Random random(3);
  for (int i = 0; i < 30; ++i) {
    q(i, 5) = 0.1;
    recording.markers.row(i) =
        MarkerPositions(still, geometry, q.row(i).transpose()).reshaped().transpose() +
        random.NormalVector(27, 0.2e-3).transpose();
  }
  const CalibrationResult result = Estimate(recording);
  for (const char* name : {"leg_6.alpha", "leg_6.d"}) {
    const int i = Find(name);
    EXPECT_EQ(result.status[i], ParameterStatus::kUnsupported) << name;
    EXPECT_FALSE(Significant(result, i)) << name;
    EXPECT_GT(result.sd[i], 0.5 * CalibrationOptions().prior.Of(model_.tree, model_.parameters[i]))
        << name;
  }
  EXPECT_EQ(result.status[Find("leg_3.theta")], ParameterStatus::kEstimated);
}

// Eight of ten parallel joints stand still. Each of their offsets is uncertain, but their sum is
// measured well. If all were held, the sum would be lost.
TEST(Support, WhatManyParametersShareIsNotHeldAsAWhole) {
  RobotTree tree = MakeRoot();
  for (int k = 0; k < 10; ++k) {
    AddJoint(tree, "joint_" + std::to_string(k), k, Offset(0.1, 0.0, 0.0), {0, 0, 1});
  }
  const ErrorModel model = MakeErrorModel(tree, {{"BASE_1", 0, {0.1, 0.2, 0.1}},
                                                 {"BASE_2", 0, {-0.1, 0.1, 0.2}},
                                                 {"BASE_3", 0, {0.0, -0.2, 0.1}},
                                                 {"TIP_1", 10, {0.1, 0.05, 0.02}},
                                                 {"TIP_2", 10, {0.05, -0.05, 0.06}},
                                                 {"TIP_3", 10, {-0.03, 0.04, 0.05}}});
  const BaseParameters base = FindBaseParameters(model, {});
  const Eigen::VectorXd truth = DrawErrors(model, base.kept, {{Kind::kTheta, 0.01}}, 4);
  Recording recording = MakeSyntheticRecording(model, truth, {.postures = 40});
  recording.q.middleCols(1, 8).setConstant(0.1);
  Random random(5);
  for (int i = 0; i < 40; ++i) {
    recording.markers.row(i) =
        MarkerPositions(model, ApplyErrors(model, truth), recording.q.row(i).transpose())
            .reshaped()
            .transpose() +
        random.NormalVector(18, 0.2e-3).transpose();
  }
  const CalibrationResult result = Calibrate(model, recording, base, ModelKind::kGeometric, {});
  EXPECT_TRUE(result.settled);
  EXPECT_NEAR(result.marker_sd, 0.2e-3, 0.02e-3);
  const Eigen::MatrixXd distances = ResidualNorms(result.model, recording, result.delta);
  EXPECT_NEAR(ComputeMetrics(distances, SeenMask(recording)).rmse_3d, 0.34e-3, 0.04e-3);
}

TEST_F(LegEstimation, EveryParameterHasAStatus) {
  IdentifiabilityOptions options;
  options.hold = {"leg_3.d"};
  base_ = FindBaseParameters(model_, options);
  const Recording recording = Record(truth_, 20);
  const CalibrationResult offsets =
      Calibrate(model_, recording, base_, ModelKind::kOffsetsOnly, {});
  EXPECT_EQ(offsets.status[Find("leg_3.d")], ParameterStatus::kHeld);
  EXPECT_EQ(offsets.status[Find("leg_1.theta")], ParameterStatus::kUnsupported);
  EXPECT_EQ(offsets.status[Find("leg_3.theta")], ParameterStatus::kEstimated);
  EXPECT_EQ(offsets.status[Find("leg_3.alpha")], ParameterStatus::kNotInModel);
  EXPECT_EQ(offsets.delta[Find("leg_3.alpha")], 0.0);
}

// The zero of a sliding joint is a length along its axis.
TEST(Offsets, OfASlideAreLengths) {
  const Project arm = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  const ErrorModel model = MakeErrorModel(arm.tree, arm.markers, arm.placement);
  const Eigen::VectorXd truth = Eigen::VectorXd::Zero(model.parameter_count());
  const CalibrationResult offsets =
      Calibrate(model, MakeSyntheticRecording(model, truth, {.postures = 20}),
                FindBaseParameters(model, arm.identifiability), ModelKind::kOffsetsOnly, {});
  const auto status = [&](const char* name) {
    return offsets.status[static_cast<std::size_t>(FindParameter(model.parameters, name))];
  };
  EXPECT_EQ(status("rail_joint.theta"), ParameterStatus::kNotInModel);
  EXPECT_NE(status("rail_joint.r"), ParameterStatus::kNotInModel);
  EXPECT_NE(status("elbow_joint.theta"), ParameterStatus::kNotInModel);
  EXPECT_EQ(status("elbow_joint.r"), ParameterStatus::kNotInModel);
}

TEST_F(LegEstimation, FewerEquationsThanParametersAreRefused) {
  ExpectInputError([&] { Estimate(Record(truth_, 1)); }, {"27 equations", "33 parameters"});
}

TEST_F(LegEstimation, GivenNoiseIsUsedAsItIs) {
  CalibrationOptions options;
  options.marker_sd = 0.4e-3;
  const CalibrationResult result = Estimate(Record(truth_, 20), options);
  EXPECT_EQ(result.noise(0, NoiseSource::kMarker), 0.4e-3);
}

// Offsets are five degrees instead of half a degree. The prior is widened, and the interval holds
// the truth.
TEST_F(LegEstimation, PriorIsWidenedForARobotFarFromNominal) {
  truth_[Find("leg_3.theta")] = 0.09;
  truth_[Find("leg_4.theta")] = -0.08;
  const Recording recording = Record(truth_, 20);
  const CalibrationResult result = Estimate(recording);
  EXPECT_GT(result.prior_scale[PriorGroup::kAngles], 2.0);
  EXPECT_LT(result.prior_scale[PriorGroup::kLengths], 2.0);
  for (const char* name : {"leg_3.theta", "leg_4.theta"}) {
    EXPECT_LT(std::abs(result.delta[Find(name)] - truth_[Find(name)]), 3.0 * result.sd[Find(name)])
        << name;
  }
  EXPECT_EQ(Estimate(recording, {.widen_prior = false}).prior_scale[PriorGroup::kAngles], 1.0);
}

TEST_F(LegEstimation, IterationsThatRunOutAreNotSuccess) {
  CalibrationOptions options;
  options.max_iterations = 1;
  truth_[Find("leg_3.theta")] = 0.5;
  EXPECT_EQ(Estimate(Record(truth_, 20), options).termination, Termination::kNoConvergence);
}

TEST_F(LegEstimation, ModelsAreNestedAndJudgedOnTheSameData) {
  truth_ = DrawErrors(model_, base_.kept,
                      {{Kind::kTheta, 0.01}, {Kind::kD, 2e-3}, {Kind::kAlpha, 5e-3}}, 2);
  Recording recording = Record(truth_, 30);
  recording.markers(3, 0) += 0.1;
  const ModelComparison comparison = CompareModels(model_, recording, base_, {});
  EXPECT_EQ(comparison.metrics[0].observations, 30 * 9 - 1);
  EXPECT_EQ(comparison.metrics[2].observations, 30 * 9 - 1);
  EXPECT_GT(comparison.metrics[0].rmse_3d, comparison.metrics[1].rmse_3d);
  EXPECT_GT(comparison.metrics[1].rmse_3d, comparison.metrics[2].rmse_3d);
  EXPECT_GT(comparison.metrics_all[2].maximum, 0.09);

  std::vector<int> calls;
  const CrossValidation folds =
      CrossValidate(comparison, model_, recording, base_, {}, {.folds = 5},
                    [&](int done, int) { calls.push_back(done); });
  EXPECT_EQ(calls.back(), 5);
  EXPECT_EQ(folds.metrics[2].observations, 30 * 9);
  EXPECT_EQ(folds.metrics_without_outliers[2].observations, 30 * 9 - 1);
  EXPECT_EQ(folds.not_predicted, 0);
  EXPECT_GT(folds.metrics[2].maximum, 0.09);  // the metrics hide nothing
  // Held-out errors consist of noise (0.35 mm in 3-D) and the error of the estimate. In-sample
  // errors are smaller.
  EXPECT_GT(folds.metrics_without_outliers[2].rmse_3d, comparison.metrics[2].rmse_3d);
  EXPECT_LT(folds.metrics_without_outliers[2].rmse_3d, 0.45e-3);
  const CrossValidation again =
      CrossValidate(comparison, model_, recording, base_, {}, {.folds = 5, .threads = 2});
  EXPECT_EQ(again.metrics[2].rmse_3d, folds.metrics[2].rmse_3d);
}

TEST_F(LegEstimation, FoldsMustFitThePostures) {
  const Recording recording = Record(truth_, 10);
  const ModelComparison comparison = CompareModels(model_, recording, base_, {});
  for (int folds : {0, 1, 11}) {
    ExpectInputError(
        [&] { CrossValidate(comparison, model_, recording, base_, {}, {.folds = folds}); },
        {"2 to 10", std::to_string(folds)});
  }
}

TEST_F(LegEstimation, RefittingTheExternalsLeavesTheJointsAlone) {
  const Recording recording = Record(truth_, 20);
  std::map<std::string, double> errors = {{"of_another_joint.theta", 1.0}};
  for (int i : base_.kept) errors[model_.parameters[i].name] = truth_[i];
  const CalibrationResult refit = RefitExternals(model_, recording, base_, {}, errors);
  EXPECT_EQ(refit.delta[Find("leg_3.theta")], truth_[Find("leg_3.theta")]);
  EXPECT_EQ(refit.status[Find("leg_3.theta")], ParameterStatus::kNotInModel);
  const double rmse =
      ComputeMetrics(ResidualNorms(refit.model, recording, refit.delta), refit.used).rmse_3d;
  EXPECT_NEAR(rmse, 0.2e-3 * std::sqrt(3.0), 0.03e-3);
}

}  // namespace
}  // namespace elastocal
