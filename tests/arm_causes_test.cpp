// SPDX-License-Identifier: Apache-2.0
// What geometry and springs do not explain of an arm that a laser tracker sees: the encoders of the
// table are not those that moved the arm.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/pipeline/diagnose.hpp"
#include "tests/arm_with_tracker.hpp"

namespace elastocal {
namespace {

class ArmWithCause : public ArmWithTracker {
 protected:
  CauseReport Study(const Eigen::MatrixXd& q) const {
    return StudyObservedCauses(project_, ReadObservationTables({Table(q)}, project_), 1);
  }
};

TEST_F(ArmWithCause, IsToldByItsPoses) {
  constexpr double kSize = 2e-3;
  Eigen::MatrixXd shown = q_;
  auto elbow = shown.col(Coordinate("elbow_joint")).array();
  elbow -= kSize * elbow.sin();
  const CauseReport report = Study(shown);
  ASSERT_TRUE(report.search.accepted);
  ASSERT_EQ(report.search.chosen.size(), 1u);
  const CauseFinding& finding = report.search.chosen[0];
  EXPECT_EQ(finding.cause, "elbow_joint.eccentricity");
  EXPECT_NEAR(finding.estimate[0], kSize, 4.0 * finding.sd[0]);
  EXPECT_NEAR(finding.estimate[1], 0.0, 4.0 * finding.sd[1]);
  EXPECT_LT(finding.sd[0], 0.2 * kSize);
  EXPECT_LT(report.search.nested_error, 0.8 * report.search.error);  // in units of the noise
  ASSERT_FALSE(report.pictures.empty());
  EXPECT_EQ(report.pictures[0].driver, "elbow_joint");
  const std::string words = DescribeDiagnosis(report)[0];
  EXPECT_NE(words.find("standard deviations of noise (nested folds)"), std::string::npos) << words;
}

TEST_F(ArmWithCause, WhatExplainsAsMuchIsNamedBesideIt) {
  const int elbow = Coordinate("elbow_joint");
  q_.col(elbow) *= 0.3;  // turns by little: once a turn is almost a line
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

}  // namespace
}  // namespace elastocal
