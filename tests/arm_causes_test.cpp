// SPDX-License-Identifier: Apache-2.0
// What remains of an arm's errors beside geometry and springs. A laser tracker sees the arm. The
// encoders in the table differ from those that moved it.

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/contact_check.hpp"
#include "elastocal/pipeline/contact_validation.hpp"
#include "elastocal/pipeline/diagnose.hpp"
#include "tests/arm_with_tracker.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

class ArmWithCause : public ArmWithTracker {
 protected:
  static constexpr double kSize = 2e-3;

  /// The postures as an encoder shows them whose disc is off centre.
  Eigen::MatrixXd Shown() const {
    Eigen::MatrixXd shown = q_;
    auto elbow = shown.col(Coordinate("elbow_joint")).array();
    elbow -= kSize * elbow.sin();
    return shown;
  }

  static double ValueOf(const ContactRun& run, const std::string& name) {
    return run.result.delta[FindParameter(run.result.model.parameters, name)];
  }

  CauseReport Study(const Eigen::MatrixXd& q) const {
    const ContactStart start = StartContacts(project_, {Table(q)}, {});
    return StudyObservedCauses(project_, start.model, start.observations,
                               EstimateObserved(start.model, start.observations, {}).fit, 1);
  }
};

TEST_F(ArmWithCause, IsToldByItsPoses) {
  const CauseReport report = Study(Shown());
  ASSERT_TRUE(report.search.accepted);
  ASSERT_EQ(report.search.chosen.size(), 1u);
  const CauseFinding& finding = report.search.chosen[0];
  EXPECT_EQ(finding.cause, "elbow_joint.eccentricity");
  EXPECT_NEAR(finding.estimate[0], kSize, 4.0 * finding.sd[0]);
  EXPECT_NEAR(finding.estimate[1], 0.0, 4.0 * finding.sd[1]);
  EXPECT_LT(finding.sd[0], 0.2 * kSize);
  EXPECT_LT(report.search.nested_error, 0.8 * report.search.error);  // relative to the noise
  ASSERT_FALSE(report.pictures.empty());
  EXPECT_EQ(report.pictures[0].driver, "elbow_joint");
  const std::string words = DescribeDiagnosis(report)[0];
  EXPECT_NE(words.find("standard deviations of noise (nested folds)"), std::string::npos) << words;
}

TEST_F(ArmWithCause, IsTakenByTheCalibrationAndKnownOnAnotherDay) {
  const ContactRun run = Calibrate(Shown());
  ASSERT_TRUE(run.deployable()) << First(run);
  EXPECT_EQ(run.extra, std::vector<std::string>{"elbow_joint.eccentricity"});
  EXPECT_NEAR(ValueOf(run, "elbow_joint.eccentricity_sin"), kSize, 3e-4);
  ASSERT_TRUE(run.causes.has_value());
  ASSERT_TRUE(run.rigid_model.has_value());  // a URDF cannot hold this cause
  EXPECT_TRUE(run.rigid_model->robot.elasticity.corrections.empty());
  EXPECT_LT(ContactRun::Judged(run.calibrated).rows[0].rms,
            0.8 * ContactRun::Judged(*run.geometric).rows[0].rms);
  const nlohmann::json summary = nlohmann::json::parse(MakeContactSummary(run));
  EXPECT_EQ(summary["extra"][0], "elbow_joint.eccentricity");
  EXPECT_EQ(summary["contact"]["kfold"]["decided_once"], nlohmann::json::array({"causes"}));
  EXPECT_EQ(summary["contact"]["holds_with"], "compensation of elbow_joint.eccentricity");
  EXPECT_NE(run.warnings.end(),
            std::find(run.warnings.begin(), run.warnings.end(), NotApplied(run.extra, false)));

  const std::filesystem::path folder = WriteCalibration(run);
  const StoredCalibration stored = ReadCalibration(folder / "calibration.yaml");
  EXPECT_EQ(StoredCauses(project_.tree, stored.joint_errors), run.extra);
  MoveTracker();
  const ContactValidation known = ValidateContacts(project_, folder, {Table(Shown())}, true);
  EXPECT_TRUE(known.better());
  EXPECT_LT(known.calibrated.rows[0].rms, 1.2e-4);
  EXPECT_EQ(CheckStatus(CheckContacts(project_, folder, {Table(Shown())}, {})), "unchanged");
  const ContactRun updated =
      CalibrateContacts(project_, {Table(Shown())}, {.folds = 0, .prior = folder, .days = 0.0});
  EXPECT_EQ(updated.extra, run.extra);
  EXPECT_NEAR(ValueOf(updated, "elbow_joint.eccentricity_sin"), kSize, 3e-4);
}

// Exports that follow the motion apply what depends on the way to a posture.
TEST_F(ArmWithCause, HysteresisIsAppliedAtRunTime) {
  Eigen::MatrixXd shown = q_;
  auto elbow = shown.col(Coordinate("elbow_joint"));
  for (Eigen::Index i = 1; i < q_.rows(); ++i) {
    elbow[i] -= std::copysign(kSize, elbow[i] - q_(i - 1, Coordinate("elbow_joint")));
  }
  const ContactRun run = Calibrate(shown);
  ASSERT_EQ(run.extra, std::vector<std::string>{"elbow_joint.hysteresis"});
  const std::string words = "compensation of elbow_joint.hysteresis";
  EXPECT_EQ(nlohmann::json::parse(MakeContactSummary(run))["contact"]["holds_with"], words);
  ASSERT_FALSE(run.verdict.remarks.empty());
  EXPECT_NE(run.verdict.remarks[0].find(words + ";"), std::string::npos);
}

// Each parameter is one standard deviation from zero. Their sum is known a hundred times better.
TEST(IdleCause, IsJudgedByAllOfItsParametersTogether) {
  CalibrationResult result;
  for (int i = 0; i < 2; ++i) {
    Correction correction;
    correction.cause = "waist.suspension";
    result.model.elasticity.corrections.push_back(correction);
    Parameter parameter;
    parameter.correction = i;
    result.model.parameters.push_back(parameter);
    result.posterior.parameters.push_back(i);
  }
  result.delta = result.sd = Eigen::Vector2d(1.0, 1.0);
  result.posterior.covariance = Eigen::Matrix2d{{1.0, -0.9999}, {-0.9999, 1.0}};
  EXPECT_EQ(IdleCause(result), std::nullopt);
  result.posterior.covariance.setIdentity();
  EXPECT_EQ(IdleCause(result), "waist.suspension");
}

TEST(CompensationInWords, NamesWhatExportsApplyBeforeWhatTheyDoNot) {
  EXPECT_EQ(CompensationInWords(true, {}), "compensation of elasticity");
  EXPECT_EQ(CompensationInWords(true, {"b.gear"}), "compensation of elasticity and b.gear");
  EXPECT_EQ(CompensationInWords(true, {"waist.drift", "b.gear", "waist.suspension"}),
            "compensation of elasticity, b.gear, waist.suspension and of waist.drift, which no "
            "export applies");
  EXPECT_EQ(NeverApplied({"a.hysteresis", "waist.drift", "marker.M.creep"}),
            (std::vector<std::string>{"waist.drift", "marker.M.creep"}));
}

TEST_F(ArmWithCause, IsEstimatedOnlyWhereTheProjectLetsIt) {
  project_.calibration.extra = {.automatic = false, .names = {}};
  EXPECT_TRUE(Calibrate(Shown()).extra.empty());
  project_.calibration.extra.names = {"elbow_joint.ecc*", "elbow_joint.gear"};
  const std::vector<std::string> both = {"elbow_joint.eccentricity", "elbow_joint.gear"};
  const ContactRun run = Calibrate(Shown());
  EXPECT_EQ(run.extra, both);
  EXPECT_FALSE(run.causes.has_value());
  EXPECT_LT(std::abs(ValueOf(run, "elbow_joint.gear")), 1e-3);
  project_.calibration.extra.names = {"elbow_joint.bachlash"};
  EXPECT_THROW(Calibrate(Shown()), InputError);
}

// Without folds, the residuals before and after calibration are those of two models.
TEST_F(ArmWithCause, TheGainWithoutFoldsIsOverTheNominalRobot) {
  project_.calibration.extra = {.automatic = false, .names = {"elbow_joint.eccentricity"}};
  const ContactRun run = CalibrateContacts(project_, {Table(Shown())}, {.folds = 0});
  const ObservationFit& fit = run.calibrated.estimate.fit;
  ASSERT_GT(run.model.robot.parameter_count(), run.uncalibrated.estimate.fit.values.robot.size());
  EXPECT_THROW(LeftOf(run.model, run.observations, run.uncalibrated.estimate.fit.values),
               std::invalid_argument);
  ObservedValues nominal = run.uncalibrated.estimate.fit.values;
  nominal.robot = Eigen::VectorXd::Zero(run.model.robot.parameter_count());
  EXPECT_DOUBLE_EQ(
      run.gain_in_sds,
      GainInSds(run.model, run.observations, LeftOf(run.model, run.observations, nominal),
                LeftOf(run.model, run.observations, fit.values), fit.spread));
}

// A pattern may concern a cause or a spring that a model of the run lacks.
TEST_F(ArmWithCause, IsHeldWhereTheProjectHoldsIt) {
  const ContactRun run = Calibrate(Shown());
  ASSERT_EQ(run.extra, std::vector<std::string>{"elbow_joint.eccentricity"});
  const std::filesystem::path folder = WriteCalibration(run);
  project_.identifiability.hold = {"elbow_joint.eccentricity_cos", "elbow_joint.compliance_z"};
  const ContactRun updated =
      CalibrateContacts(project_, {Table(Shown())}, {.folds = 0, .prior = folder, .days = 0.0});
  EXPECT_EQ(ValueOf(updated, "elbow_joint.eccentricity_cos"), 0.0);
  EXPECT_NEAR(ValueOf(updated, "elbow_joint.eccentricity_sin"), kSize, 3e-4);
  ASSERT_TRUE(updated.rigid_model.has_value());
  const ContactRun anew = Calibrate(Shown());
  EXPECT_EQ(anew.extra, run.extra);
  EXPECT_EQ(ValueOf(anew, "elbow_joint.eccentricity_cos"), 0.0);
  project_.identifiability.hold = {"elbow_joint.eccentricty_cos"};
  ExpectInputError([&] { Calibrate(Shown()); },
                   {"identifiability.hold", "did you mean 'elbow_joint.eccentricity_cos'?"});
}

TEST_F(ArmWithCause, NothingIsTakenWhereNothingIs) {
  const ContactRun run = Calibrate(q_);
  EXPECT_TRUE(run.extra.empty());
  EXPECT_TRUE(run.causes.has_value());
  EXPECT_FALSE(run.rigid_model.has_value());
}

// Beside such a large hysteresis, springs alone have no clear gain.
TEST_F(ArmWithCause, SpringsThatItHidesAreFoundBesideIt) {
  MakeElastic(30e-6);
  Eigen::MatrixXd shown = q_;
  const int shoulder = Coordinate("shoulder_joint");
  for (Eigen::Index i = 1; i < q_.rows(); ++i) {
    shown(i, shoulder) -= std::copysign(6e-3, shown(i, shoulder) - q_(i - 1, shoulder));
  }
  const ContactRun run = Calibrate(shown);
  EXPECT_EQ(run.extra, std::vector<std::string>{"shoulder_joint.hysteresis"});
  EXPECT_FALSE(run.model.robot.elasticity.torsion.empty());
  const nlohmann::json summary = nlohmann::json::parse(MakeContactSummary(run));
  const std::vector<std::string> both = {"elasticity", "causes"};
  EXPECT_EQ(summary["contact"]["kfold"]["decided_once"], both);
}

TEST_F(ArmWithCause, SpringsThatTheProjectForbidsAreSaidWhereCausesStandForThem) {
  constexpr const char* kWords = "holds joints rigid";
  const auto warned = [&](const ContactRun& run) {
    return std::any_of(run.warnings.begin(), run.warnings.end(), [&](const std::string& warning) {
      return warning.find(kWords) != std::string::npos;
    });
  };
  project_.elasticity.torsion.emplace();
  const ContactRun rigid = Calibrate(Shown());
  EXPECT_EQ(rigid.extra, std::vector<std::string>{"elbow_joint.eccentricity"});
  EXPECT_FALSE(warned(rigid));
  MakeElastic(60e-6);
  const ContactRun bent = Calibrate(q_);
  EXPECT_FALSE(bent.extra.empty());
  EXPECT_TRUE(warned(bent));
  project_.elasticity.torsion = {"turret_joint"};  // all other joints are held rigid
  const ContactRun partly = Calibrate(q_);
  EXPECT_FALSE(partly.extra.empty());
  EXPECT_TRUE(warned(partly));
}

TEST_F(ArmWithCause, WhatExplainsAsMuchIsNamedBesideIt) {
  const int elbow = Coordinate("elbow_joint");
  q_.col(elbow) *= 0.3;  // moves little, so that a cycle per turn is almost a line
  Measure(model_, truth_);
  Eigen::MatrixXd shown = q_;
  shown.col(elbow).array() -= 3e-3 * shown.col(elbow).array().sin();
  const CauseReport report = Study(shown);
  ASSERT_TRUE(report.search.accepted);
  const CauseFinding& finding = report.search.chosen[0];
  std::vector<std::string> explain = finding.rivals;
  explain.push_back(finding.cause);
  for (const char* cause : {"elbow_joint.eccentricity", "elbow_joint.gear"}) {
    EXPECT_NE(std::find(explain.begin(), explain.end(), cause), explain.end()) << cause;
  }
  const std::string words = DescribeDiagnosis(report)[2];
  EXPECT_NE(words.find("the recording does not tell which it is"), std::string::npos) << words;
}

TEST_F(ArmWithCause, NothingIsNamedWhereNothingIs) {
  const CauseReport report = Study(q_);
  EXPECT_FALSE(report.search.accepted);
  EXPECT_FALSE(report.search.findings.empty());
}

// For good recordings, a message with "by 0.00 mm" would say nothing.
TEST_F(ArmWithCause, SmallErrorsHaveTwoDigits) {
  CauseReport report;
  report.in_metres = true;
  report.search.findings.resize(1);
  report.search.findings[0].p_adjusted = 1.0;
  report.search.findings[0].visible = 4.3e-7;
  const std::string words = DescribeDiagnosis(report)[0];
  EXPECT_NE(words.find("by 0.00043 mm"), std::string::npos) << words;
  report.search.findings[0].visible = 1.234e-3;
  EXPECT_NE(DescribeDiagnosis(report)[0].find("by 1.23 mm"), std::string::npos);
}

}  // namespace
}  // namespace elastocal
