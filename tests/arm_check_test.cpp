// SPDX-License-Identifier: Apache-2.0
// A laser tracker sees an arm again on another day, to tell whether a joint has moved.

#include <algorithm>

#include <gtest/gtest.h>

#include "elastocal/io/observation_table.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/pipeline/contact_check.hpp"
#include "elastocal/pipeline/contact_validation.hpp"
#include "tests/arm_with_tracker.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

class CheckedArm : public ArmWithTracker {
 protected:
  CheckedArm() : calibration_(WriteCalibration()) { MoveTracker(); }

  /// Checks eight postures of that day.
  ContactCheck Check(const Eigen::MatrixXd& q, std::size_t first = 0) const {
    return CheckContacts(project_, calibration_, {Table(q, "today.csv", first)});
  }

  std::filesystem::path calibration_;
};

TEST_F(CheckedArm, IsUnchangedWhereverTheTrackerStands) {
  const ContactCheck run = Check(q_.topRows(8));
  EXPECT_EQ(CheckStatus(run), "unchanged");
  EXPECT_TRUE(run.alternatives.empty());
  // Coordinates were measured to 0.1 mm. The first guess was 1 mm.
  EXPECT_GT(run.left_before[0], 5e-5);
  EXPECT_LT(run.left_before[0], 2.5e-4);
  EXPECT_LT(run.calibrated.rows[0].rms, 2e-4);
  EXPECT_GT(run.uncalibrated.rows[0].rms, 1e-3);
}

TEST_F(CheckedArm, TheJointThatMovedIsNamedWithItsSize) {
  Change("elbow_joint.theta", 4e-3);
  const ContactCheck run = Check(q_.topRows(8));
  EXPECT_EQ(CheckStatus(run), "moved");
  ASSERT_EQ(run.check.moved.size(), 1u);
  EXPECT_EQ(run.check.moved[0].joint, "elbow_joint");
  ASSERT_FALSE(run.check.moved[0].changes.empty());
  const ParameterChange& change = run.check.moved[0].changes[0];
  EXPECT_NEAR(change.value, 4e-3, 4.0 * change.sd);
  EXPECT_LT(change.sd, 1e-3);
  EXPECT_LT(run.updated.rows[0].rms, run.calibrated.rows[0].rms);
}

// The tracker stood elsewhere for the second file. Three rows of each file are in the other one.
TEST_F(CheckedArm, RowsInTheFileOfAnotherSessionAreNamed) {
  const std::vector<Eigen::VectorXd> first = poses_;
  MoveTracker();
  const std::vector<Eigen::VectorXd> second = poses_;
  const auto tables = [&](int exchanged) {
    poses_ = first;
    for (int i = 0; i < exchanged; ++i) poses_[Size(i)] = second[Size(i)];
    const std::filesystem::path one = Table(q_.topRows(12), "first.csv");
    poses_ = second;
    for (int i = 12; i < 12 + exchanged; ++i) poses_[Size(i)] = first[Size(i)];
    return std::vector{one, Table(q_.middleRows(12, 12), "second.csv", 12)};
  };
  EXPECT_EQ(CheckStatus(CheckContacts(project_, calibration_, tables(0))), "unchanged");
  const ContactCheck check = CheckContacts(project_, calibration_, tables(3));
  EXPECT_EQ(CheckStatus(check), "recording wrong");
  const auto names_rows = [](const std::vector<std::string>& texts) {
    return std::any_of(texts.begin(), texts.end(), [](const std::string& text) {
      return text.starts_with("6 of 24 rows seem to be of another session") &&
             text.find("first.csv:2, 3, 4 of") != std::string::npos &&
             text.find("second.csv:2, 3, 4 of") != std::string::npos;
    });
  };
  EXPECT_TRUE(names_rows(check.alternatives))
      << (check.alternatives.empty() ? "" : check.alternatives.front());
  const ContactValidation sound = ValidateContacts(project_, calibration_, tables(0), true);
  EXPECT_TRUE(sound.better());
  EXPECT_FALSE(names_rows(sound.warnings));
  const ContactValidation wrong = ValidateContacts(project_, calibration_, tables(3), true);
  EXPECT_TRUE(names_rows(wrong.objections))
      << (wrong.objections.empty() ? "" : wrong.objections.front());
}

TEST_F(CheckedArm, AWrongGainOrScaleOrRowIsNoRobotThatChanged) {
  Eigen::MatrixXd q = q_.topRows(8);
  q.col(Coordinate("elbow_joint")) *= 1.03;
  const ContactCheck gain = Check(q);
  EXPECT_EQ(CheckStatus(gain), "recording wrong");
  ASSERT_EQ(gain.alternatives.size(), 1u);
  EXPECT_NE(gain.alternatives[0].find("--accept gain:elbow_joint=1.0"), std::string::npos)
      << gain.alternatives[0];

  const std::vector<Eigen::VectorXd> sound = poses_;
  for (Eigen::VectorXd& pose : poses_) pose.head<3>() *= 1.01;
  const ContactCheck scale = Check(q_.topRows(8));
  EXPECT_EQ(CheckStatus(scale), "recording wrong");
  ASSERT_EQ(scale.alternatives.size(), 1u);
  EXPECT_NE(scale.alternatives[0].find("--accept scale=1.0"), std::string::npos)
      << scale.alternatives[0];

  poses_ = sound;
  poses_[3][0] += 0.01;
  const ContactCheck row = Check(q_.topRows(8));
  EXPECT_EQ(CheckStatus(row), "recording wrong");
  ASSERT_EQ(row.alternatives.size(), 1u);
  EXPECT_NE(row.alternatives[0].find("today.csv:5: "), std::string::npos) << row.alternatives[0];
}

// The warning is the only consequence.
TEST_F(CheckedArm, ARowThatIsFarOffIsAWarning) {
  EXPECT_TRUE(Check(q_.topRows(8)).warnings.empty());
  poses_[3][0] += 3e-3;
  const ContactCheck run = Check(q_.topRows(8));
  EXPECT_EQ(CheckStatus(run), "unchanged");
  ASSERT_EQ(run.warnings.size(), 1u);
  EXPECT_NE(run.warnings[0].find("today.csv:5: 'tool' is further off"), std::string::npos)
      << run.warnings[0];
  EXPECT_NE(run.warnings[0].find("(position -"), std::string::npos) << run.warnings[0];
}

TEST_F(CheckedArm, AnotherRobotIsNotExplained) {
  Random random(99);
  for (Eigen::VectorXd& pose : poses_) pose.head<3>() += random.NormalVector(3, 0.05);
  const ContactCheck run = Check(q_.topRows(8));
  EXPECT_EQ(CheckStatus(run), "unexplained");
  EXPECT_FALSE(run.FarRows(run.updated).empty());
}

// Ten postures with the estimate of thirty earlier ones are better than ten alone. Knowledge of a
// joint that has moved is forgotten.
TEST_F(CheckedArm, AFewPosturesUpdateACalibration) {
  Change("elbow_joint.theta", 0.02);
  const auto calibrate = [&](const std::filesystem::path& prior) {
    return CalibrateContacts(project_, {Table(q_.topRows(10), "ten.csv")},
                             {.folds = 0, .prior = prior, .days = 0.0});
  };
  const ContactRun updated = calibrate(calibration_);
  const ContactRun alone = calibrate({});
  const auto left = [&](const ContactRun& run) {
    const ObservedValues& values = run.calibrated.estimate.fit.values;
    ObservationTables tables =
        ReadObservationTables({Table(q_.bottomRows(15), "others.csv", 15)}, project_);
    return MakeFigures(run.model, tables.observations,
                       LeftAfterRegistration(run.model, tables.observations, values,
                                             run.calibrated.estimate.fit.spread))
        .rows[0]
        .rms;
  };
  EXPECT_LT(left(updated), 2e-4);
  EXPECT_LT(left(updated), 0.7 * left(alone));
  const bool told =
      std::any_of(updated.warnings.begin(), updated.warnings.end(), [](const std::string& text) {
        return text.find("elbow_joint: has moved since") != std::string::npos;
      });
  EXPECT_TRUE(told);
  const auto warns = [](const ContactRun& run) {
    return std::any_of(run.warnings.begin(), run.warnings.end(), [](const std::string& text) {
      return text.find("counts twice") != std::string::npos;
    });
  };
  EXPECT_FALSE(warns(updated));
  EXPECT_TRUE(warns(CalibrateContacts(project_, {folder_.path() / "table.csv"},
                                      {.folds = 0, .prior = calibration_})));
}

TEST_F(CheckedArm, RefusesWhatDoesNotBelongTogether) {
  ExpectInputError([&] { Check(q_.topRows(3)); }, {"today.csv", "3 postures", "at least 4"});
  std::filesystem::remove(calibration_ / "covariance.csv");
  ExpectInputError([&] { Check(q_.topRows(8)); }, {"covariance.csv"});
}

}  // namespace
}  // namespace elastocal
