// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/verdict.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

class VerdictTest : public ::testing::Test {
 protected:
  /// Sets a comparison without objections.
  void SetUp() override {
    comparison_.kinds = {ModelKind::kUncalibrated, ModelKind::kOffsetsOnly, ModelKind::kGeometric};
    CalibrationResult& result = comparison_.results[2];
    result.model = TalosLegModel();
    result.delta.setZero(result.model.parameter_count());
    result.termination = Termination::kConverged;
    result.marker_sd = 0.2e-3;
    for (const Marker& marker : result.model.markers) {
      recording_.marker_names.push_back(marker.name);
    }
    recording_.q.setZero(20, 6);
    recording_.markers.setZero(20, 27);
    result.used = SeenMask(recording_);
    excitation_.condition_base = 100.0;
    validation_.folds = 5;
    for (int k = 0; k < 3; ++k) validation_.metrics[k].rmse_3d = 3e-3 - 1e-3 * k;
  }

  Verdict Judged() const {
    return Judge(comparison_, validation_, excitation_, recording_, CalibrationOptions());
  }
  void ExpectObjection(const char* part) const {
    const Verdict verdict = Judged();
    ASSERT_EQ(verdict.objections.size(), 1u);
    EXPECT_NE(verdict.objections[0].find(part), std::string::npos) << verdict.objections[0];
  }

  ModelComparison comparison_;
  CrossValidation validation_;
  Excitation excitation_;
  Recording recording_;
};

TEST_F(VerdictTest, NothingToSay) {
  EXPECT_TRUE(Judged().objections.empty());
  EXPECT_TRUE(Judged().remarks.empty());
}

TEST_F(VerdictTest, FoldsThatPredictNothingDoNotJudge) {
  EXPECT_EQ(ChooseDeployment(comparison_, validation_, nullptr).judged_on, "held-out postures");
  for (ErrorMetrics& metrics : validation_.metrics) {
    metrics.rmse_3d = std::numeric_limits<double>::quiet_NaN();
  }
  validation_.not_predicted = 180;
  const Deployment deployment = ChooseDeployment(comparison_, validation_, nullptr);
  EXPECT_EQ(deployment.judged_on, "the fit");
  EXPECT_TRUE(std::isfinite(deployment.urdf));
  ASSERT_EQ(Judged().remarks.size(), 1u);
  EXPECT_EQ(Judged().remarks[0].find("no held-out posture could be predicted"), 0u)
      << Judged().remarks[0];
}

TEST_F(VerdictTest, NoConvergence) {
  comparison_.results[2].termination = Termination::kNoConvergence;
  ExpectObjection("not converged");
}

TEST_F(VerdictTest, TooManyOutliersToLeaveThemOut) {
  comparison_.results[2].outliers.resize(150);
  comparison_.results[2].too_many_outliers = true;
  ExpectObjection("150 of 180 observations contradict the others");
}

TEST_F(VerdictTest, ImplausibleNoiseNamesTheFurthestParameter) {
  CalibrationResult& result = comparison_.results[2];
  result.marker_sd = 6e-3;
  result.delta[FindParameter(result.model.parameters, "leg_4.theta")] = 0.1;
  result.delta[FindParameter(result.model.parameters, "leg_3.d")] = 2e-3;
  ExpectObjection("6 mm");
  ASSERT_EQ(Judged().remarks.size(), 1u);
  EXPECT_NE(Judged().remarks[0].find("leg_4.theta, 5.73 deg"), std::string::npos);
}

TEST_F(VerdictTest, WhatANamedMistakeDoesToTheFitIsLeftOut) {
  CalibrationResult& result = comparison_.results[2];
  result.marker_sd = 9e-3;
  result.delta[FindParameter(result.model.parameters, "leg_4.theta")] = 0.1;
  Verdict verdict = Judged();
  verdict.objections.emplace_back("another");
  verdict.remarks.emplace_back("a remark");
  ASSERT_EQ(verdict.objections.size(), 2u);
  ASSERT_EQ(verdict.remarks.size(), 2u);
  LeaveOutConsequences(verdict);
  EXPECT_EQ(verdict.objections, std::vector<std::string>{"another"});
  EXPECT_EQ(verdict.remarks, std::vector<std::string>{"a remark"});
}

TEST_F(VerdictTest, PriorAtItsLimit) {
  comparison_.results[2].prior_scale[PriorGroup::kLengths] = MostWidening(PriorGroup::kLengths);
  ExpectObjection("lengths are more than ten times");
}

// Even a perfect fit may have such an axis, if the sign of a sliding joint before it is reversed.
TEST_F(VerdictTest, AnAxisTurnedByHalfATurnIsNoRobots) {
  CalibrationResult& result = comparison_.results[2];
  result.delta[FindParameter(result.model.parameters, "leg_3.alpha")] = 3.1;
  ExpectObjection("the axis of leg_3");
  EXPECT_NE(Judged().objections[0].find("leg_2"), std::string::npos) << Judged().objections[0];
}

// A reversed sign turns all axes behind it, so they make one sentence.
TEST_F(VerdictTest, TurnedAxesAreOneObjection) {
  CalibrationResult& result = comparison_.results[2];
  result.delta[FindParameter(result.model.parameters, "leg_3.alpha")] = 3.1;
  result.delta[FindParameter(result.model.parameters, "leg_4.alpha")] = -3.1;
  ExpectObjection("the axes of leg_3, leg_4 seem to be turned");
  ExpectObjection("Check the signs of their positions and of those of the joints before them.");
}

TEST_F(VerdictTest, ParametersThatLeanOnThePriorAlone) {
  excitation_.parameters = {6, 7, 8, 9};
  excitation_.parameter_sd = Eigen::Vector4d(0.1, 0.1, 1e-4, 1e-4);
  EXPECT_TRUE(Judged().objections.empty());  // aligned axes: only their sum is told
  excitation_.parameter_sd[2] = std::numeric_limits<double>::infinity();
  ExpectObjection("do not determine the parameters (3 of 4");
}

TEST_F(VerdictTest, OutliersByNumberAndByMarker) {
  auto& used = comparison_.results[2].used;
  used.col(4).head(10).setConstant(false);  // 10 of 180: 5.6 %, all of one marker
  ASSERT_EQ(Judged().remarks.size(), 2u);
  EXPECT_NE(Judged().remarks[0].find("5 %"), std::string::npos) << Judged().remarks[0];
  EXPECT_NE(Judged().remarks[1].find("SHANK_2: 10 of 20"), std::string::npos);
  EXPECT_TRUE(Judged().objections.empty());
  used.topRows(6).setConstant(false);
  ExpectObjection("outliers");
}

TEST(JudgeDeployment, ObjectsToAUrdfThatIsWorse) {
  Deployment deployment{.judged_on = "held-out postures",
                        .uncalibrated = 3e-3,
                        .urdf = 3.2e-3,
                        .compensated = 1e-3};  // the user of a URDF does not have it
  Verdict verdict;
  JudgeDeployment(deployment, 8e-3, verdict);
  ASSERT_EQ(verdict.objections.size(), 1u);
  EXPECT_NE(verdict.objections[0].find("3.2 mm against 3 mm"), std::string::npos);
  verdict = {};
  deployment.urdf = 3.01e-3;  // the robot was calibrated before
  JudgeDeployment(deployment, 8e-3, verdict);
  EXPECT_TRUE(verdict.objections.empty());
  EXPECT_EQ(verdict.remarks.size(), 1u);
  verdict = {};
  deployment.uncalibrated = 300e-3;
  deployment.urdf = 190e-3;  // better, but not like a calibrated robot
  JudgeDeployment(deployment, 8e-3, verdict);
  ASSERT_EQ(verdict.objections.size(), 1u);
  EXPECT_NE(verdict.objections[0].find("190 mm"), std::string::npos);
  EXPECT_NE(verdict.objections[0].find("8 mm"), std::string::npos);
  verdict = {};
  deployment.uncalibrated = 3e-3;
  deployment.urdf = 4e-3;
  deployment.judged_on = "the fit";
  JudgeDeployment(deployment, 8e-3, verdict);
  EXPECT_TRUE(verdict.objections.empty());
}

TEST(JudgeDeployment, SaysNothingWithoutNumbers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Verdict verdict;
  JudgeDeployment({.judged_on = "held-out postures", .uncalibrated = nan, .urdf = nan}, 8e-3,
                  verdict);
  EXPECT_TRUE(verdict.objections.empty());
  EXPECT_TRUE(verdict.remarks.empty());
}

ErrorTable HeldOutTable(const std::map<ModelKind, double>& rmse) {
  ErrorTableRow row;
  row.group = "leg_left";
  for (const auto& [kind, value] : rmse) row.metrics[kind].rmse_3d = value;
  ErrorTable table;
  table.groups = {row};
  return table;
}

// Two markers err by 30 and 40 mm (35.4 mm rms) in some postures among good ones. The robot errs by
// 7 mm.
TEST(JudgePostures, ObjectsWhereManyPosturesAreNoRobots) {
  Recording recording;
  recording.trials.resize(2);
  recording.trials[0].name = "a";
  recording.trials[1].name = "b";
  recording.q.setZero(20, 1);
  recording.trial.assign(20, 0);
  std::fill(recording.trial.begin() + 10, recording.trial.end(), 1);
  Eigen::MatrixXd distances = Eigen::MatrixXd::Constant(20, 2, 1e-3);
  const ObservationMask used = ObservationMask::Constant(20, 2, true);
  const auto judge = [&] {
    Verdict verdict;
    JudgePostures(distances, used, recording, 7e-3, verdict);
    return verdict;
  };
  EXPECT_TRUE(judge().objections.empty() && judge().remarks.empty());
  distances.row(12) << 0.03, 0.04;
  EXPECT_TRUE(judge().objections.empty());  // one may be a slip
  ASSERT_EQ(judge().remarks.size(), 1u);
  distances.row(15) << 0.03, 0.04;
  ASSERT_EQ(judge().objections.size(), 1u);
  const std::string text = judge().objections[0];
  EXPECT_TRUE(text.starts_with("trial b: 2 of 10 postures are off by up to 35.4 mm")) << text;
  distances.row(15) << 0.03, 0.03;  // less than five times 7 mm
  EXPECT_TRUE(judge().objections.empty());
}

TEST(JudgeHeldOut, ObjectsToWhatErrsNoLessThanTheUncalibratedRobot) {
  using enum ModelKind;
  Verdict verdict;
  JudgeHeldOut(HeldOutTable({{kUncalibrated, 2e-3}, {kGeometric, 1.5e-3}, {kFull, 1e-3}}), kFull,
               kGeometric, verdict);
  EXPECT_TRUE(verdict.objections.empty());
  EXPECT_TRUE(verdict.remarks.empty());
  JudgeHeldOut(HeldOutTable({{kUncalibrated, 2e-3}, {kGeometric, 1e-3}, {kFull, 1.005e-3}}), kFull,
               kGeometric, verdict);
  EXPECT_TRUE(verdict.remarks.empty());  // a rigid robot
  JudgeHeldOut(HeldOutTable({{kUncalibrated, 2e-3}, {kGeometric, 0.5e-3}, {kFull, 1e-3}}), kFull,
               kGeometric, verdict);
  EXPECT_TRUE(verdict.objections.empty());
  ASSERT_EQ(verdict.remarks.size(), 1u);  // a simpler model is better: a remark, but deployable
  EXPECT_NE(verdict.remarks[0].find("leg_left"), std::string::npos);
  EXPECT_NE(verdict.remarks[0].find("geometric"), std::string::npos);
  verdict = {};
  JudgeHeldOut(HeldOutTable({{kUncalibrated, 1e-3}, {kGeometric, 2e-3}, {kFull, 1.1e-3}}), kFull,
               kGeometric, verdict);
  ASSERT_EQ(verdict.objections.size(), 1u);
  EXPECT_NE(verdict.objections[0].find("1.1 mm"), std::string::npos) << verdict.objections[0];
  ASSERT_EQ(verdict.remarks.size(), 1u);  // the URDF alone is worse than nominal
  EXPECT_NE(verdict.remarks[0].find("URDF alone"), std::string::npos) << verdict.remarks[0];
}

TEST(JudgeHeldOut, NamesTrialsOfWhichNothingIsPredicted) {
  const auto trial = [](const char* name, double distance) {
    return ComputeTrialErrors(
        {.trial = name,
         .group = "arm",
         .markers = {0},
         .distances = {{ModelKind::kFull, Eigen::MatrixXd::Constant(2, 1, distance)}}});
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ErrorTable table = MakeErrorTable({trial("seen", 1e-3), trial("lost", nan)});
  EXPECT_TRUE(std::isnan(table.trials[1].metrics.at(ModelKind::kFull).maximum));
  EXPECT_EQ(table.groups[0].metrics.at(ModelKind::kFull).maximum, 1e-3);
  Verdict verdict;
  JudgeHeldOut(table, ModelKind::kFull, ModelKind::kGeometric, verdict);
  ASSERT_EQ(verdict.remarks.size(), 1u);
  EXPECT_EQ(
      verdict.remarks[0],
      "lost, a trial for validation, is not judged: the root link could be placed in none of its "
      "postures. Were its markers seen?");
}

TEST(JudgeHeldOut, SaysNothingWithoutObservations) {
  Verdict verdict;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  JudgeHeldOut(HeldOutTable({{ModelKind::kUncalibrated, nan}, {ModelKind::kFull, nan}}),
               ModelKind::kFull, ModelKind::kGeometric, verdict);
  JudgeHeldOut(HeldOutTable({{ModelKind::kUncalibrated, 1e-3}}), ModelKind::kFull,
               ModelKind::kGeometric, verdict);
  EXPECT_TRUE(verdict.objections.empty());
  EXPECT_TRUE(verdict.remarks.empty());
}

}  // namespace
}  // namespace elastocal
