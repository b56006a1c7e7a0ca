// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/coverage.hpp"

#include <gtest/gtest.h>

#include "tests/test_files.hpp"

namespace elastocal {
namespace {

class CoverageOfChains : public testing::Test {
 protected:
  /// A trial of one chain that shows its markers and those of the waist.
  Recording Shown(const std::string& chain) const {
    Recording recording;
    recording.trials = {{.name = chain, .chains = {chain}}};
    recording.trial = {0};
    for (const Chain& candidate : project_.chains) {
      if (candidate.name == chain) recording.marker_names = ChainMarkers(project_, candidate);
    }
    recording.q.setZero(1, project_.tree.coordinate_count());
    recording.markers.setZero(1, 3 * recording.marker_count());
    return recording;
  }

  /// The project with another chain that has the joints of the left arm.
  Project WithWholeLeftArm() const {
    Project project = project_;
    const int left = FindLink(project.tree, "left_hand");
    project.chains.push_back({.name = "whole_left_arm", .tip_link = left});
    return project;
  }

  static TrialSummary Refused(const std::string& chain) {
    TrialSummary summary;
    summary.trial = {.name = chain + "_trial", .chains = {chain}};
    summary.refused = "its clock cannot be told";
    return summary;
  }

  const Project project_ = ReadProject(SourceFile("tests/robots/mini_humanoid_project.yaml"));
};

TEST_F(CoverageOfChains, AChainWhoseTrialsAreAllRefusedIsNotDeployed) {
  Measurements measured;
  measured.calibration = Shown("left_arm");
  measured.trials = {Refused("right_arm"), Refused("left_arm")};
  Verdict verdict;
  verdict.objections = {"another"};
  JudgeCoverage(FindCoverage(project_, measured), verdict);
  ASSERT_EQ(verdict.objections.size(), 2u);  // none for the left arm, which another trial shows
  EXPECT_EQ(verdict.objections[0].find("chain right_arm is not calibrated"), 0u);
  EXPECT_NE(verdict.objections[0].find("right_arm_trial: its clock"), std::string::npos);
  EXPECT_TRUE(verdict.remarks.empty());
}

TEST_F(CoverageOfChains, AChainThatOnlyTrialsForValidationExerciseIsNotDeployed) {
  Measurements measured;
  measured.calibration = Shown("left_arm");
  const Recording moved = measured.calibration;
  measured.calibration.trial = {0, 0};
  measured.calibration.q.setZero(2, moved.q.cols());
  measured.calibration.q.row(1).setConstant(0.5);
  measured.calibration.markers.setZero(2, moved.markers.cols());
  TrialSummary validation;
  validation.trial = {.name = "tour", .kind = TrialKind::kRandom, .chains = {"right_arm"}};
  measured.trials = {validation};
  Verdict verdict;
  JudgeCoverage(FindCoverage(project_, measured), verdict);
  ASSERT_EQ(verdict.objections.size(), 1u);
  EXPECT_EQ(verdict.objections[0].find("chain right_arm is not calibrated: trial tour"), 0u);
  EXPECT_NE(verdict.objections[0].find("trial left_arm moves its joints most"), std::string::npos);
}

TEST_F(CoverageOfChains, AChainWhoseJointsOthersExerciseIsCalibrated) {
  const Project project = WithWholeLeftArm();
  Measurements measured;
  measured.calibration = Shown("left_arm");
  TrialSummary validation;
  validation.trial = {.name = "tour", .kind = TrialKind::kRandom, .chains = {"whole_left_arm"}};
  measured.trials = {validation};
  Verdict verdict;
  JudgeCoverage(FindCoverage(project, measured), verdict);
  EXPECT_TRUE(verdict.objections.empty()) << verdict.objections.front();
  measured.calibration = Shown("right_arm");
  JudgeCoverage(FindCoverage(project, measured), verdict);
  EXPECT_EQ(verdict.objections.size(), 1u);
}

TEST_F(CoverageOfChains, StandingOnALegWhoseTrialsAreRefusedIsNotKnown) {
  const int left = FindLink(project_.tree, "left_sole"),
            right = FindLink(project_.tree, "right_sole");
  Measurements measured;
  measured.calibration = Shown("left_leg");
  measured.trials = {Refused("left_leg"), Refused("right_leg")};
  measured.trials[0].trial.support = {right};
  measured.trials[1].trial.support = {left, right};
  const std::vector<std::string> unknown = UnknownStance(project_, measured);
  ASSERT_EQ(unknown.size(), 1u);
  EXPECT_EQ(unknown[0],
            "how the robot bends on right_sole alone is not known, on which it stands in trial "
            "left_leg_trial: no trial for calibration that can be used shows it (trial "
            "left_leg_trial: its clock cannot be told; trial right_leg_trial: its clock cannot be "
            "told)");
  measured.trials.erase(measured.trials.begin());  // the trial that remains stood on both feet
  EXPECT_TRUE(UnknownStance(project_, measured).empty());
  measured.validation = Shown("right_leg");
  measured.validation.trials[0].support = {left};
  EXPECT_EQ(UnknownStance(project_, measured).size(), 1u);
  measured.trials.clear();  // all trials can be used
  EXPECT_EQ(UnknownStance(project_, measured).front(),
            "how the robot bends on left_sole alone is not known, on which it stands in trial "
            "right_leg: no trial for calibration that can be used shows it");
  EXPECT_EQ(WithKnownStance(project_, measured).posture_count(), 0);
  measured.calibration.trials[0].support = {left};  // this trial can be used
  EXPECT_TRUE(UnknownStance(project_, measured).empty());
  EXPECT_EQ(WithKnownStance(project_, measured).posture_count(), 1);
  measured.validation.trials[0].support = {FindLink(project_.tree, "torso")};
  EXPECT_TRUE(UnknownStance(project_, measured).empty());  // held, so that no leg bends
  measured.calibration = {};
  Project rigid = project_;
  rigid.elasticity.base = false;
  EXPECT_TRUE(UnknownStance(rigid, measured).empty());
}

TEST_F(CoverageOfChains, WhatIsNotJudgedIsSaidWhereOthersAre) {
  Measurements measured;
  measured.calibration = Shown("left_arm");
  measured.validation = Shown("right_arm");
  const std::vector<ChainCoverage> coverage = FindCoverage(project_, measured);
  for (const ChainCoverage& of : coverage) {
    EXPECT_EQ(of.calibrated, of.chain == "left_arm") << of.chain;
    EXPECT_EQ(of.judged, of.chain == "right_arm") << of.chain;
  }
  Verdict verdict;
  JudgeCoverage(coverage, verdict);
  EXPECT_TRUE(verdict.objections.empty());
  ASSERT_EQ(verdict.remarks.size(), 1u);
  EXPECT_NE(verdict.remarks[0].find("left_arm"), std::string::npos);
}

TEST_F(CoverageOfChains, AChainThatCannotBePredictedIsNotJudged) {
  Measurements measured;
  measured.calibration = Shown("left_arm");
  measured.validation = Shown("left_arm");
  for (const bool known : {true, false}) {
    const ObservationMask predicted =
        ObservationMask::Constant(1, measured.validation.marker_count(), known);
    for (const ChainCoverage& of : FindCoverage(project_, measured, &predicted)) {
      EXPECT_EQ(of.judged, known && of.chain == "left_arm") << of.chain;
    }
  }
}

// Markers of the hand were lost. The joints that only they show are named.
TEST_F(CoverageOfChains, JointsBeyondAllSeenMarkersAreNamed) {
  Project project = project_;
  Marker upper = project.markers.front();
  upper.name = "UPPER";
  const int hand = FindLink(project.tree, "left_hand");
  const std::vector<int> joints = JointsToBody(project.tree, project.tree.links[hand].body);
  ASSERT_GE(joints.size(), 2u);
  for (std::size_t l = 0; l < project.tree.links.size(); ++l) {
    if (project.tree.links[l].body == joints[joints.size() - 2] + 1) {
      upper.link = static_cast<int>(l);
    }
  }
  project.markers.push_back(upper);
  Measurements measured;
  measured.calibration = Shown("left_arm");
  for (const ChainCoverage& of : FindCoverage(project, measured)) EXPECT_TRUE(of.unseen.empty());
  measured.calibration.marker_names = {"UPPER"};
  measured.calibration.markers.setZero(1, 3);
  Verdict verdict;
  JudgeCoverage(FindCoverage(project, measured), verdict);
  ASSERT_EQ(verdict.remarks.size(), 1u);
  EXPECT_EQ(verdict.remarks[0], "chain left_arm: " + project.tree.joints[joints.back()].name +
                                    " not calibrated, because no marker beyond was seen");
}

// In the trial for validation, the markers of the hand were hidden. Those of the upper arm judge
// the joints before them, and no other.
TEST_F(CoverageOfChains, JointsThatNoHeldOutMarkerShowsAreNamed) {
  Project project = project_;
  Marker upper = project.markers.front();
  upper.name = "UPPER";
  const int hand = FindLink(project.tree, "left_hand");
  const std::vector<int> joints = JointsToBody(project.tree, project.tree.links[hand].body);
  ASSERT_GE(joints.size(), 2u);
  for (std::size_t l = 0; l < project.tree.links.size(); ++l) {
    if (project.tree.links[l].body == joints[joints.size() - 2] + 1) {
      upper.link = static_cast<int>(l);
    }
  }
  project.markers.push_back(upper);
  Measurements measured;
  measured.calibration = Shown("left_arm");
  measured.validation = Shown("left_arm");
  for (const ChainCoverage& of : FindCoverage(project, measured)) {
    EXPECT_TRUE(of.unjudged.empty()) << of.unjudged.front();
  }
  measured.validation.marker_names = {"UPPER"};
  measured.validation.markers.setZero(1, 3);
  const std::vector<ChainCoverage> coverage = FindCoverage(project, measured);
  const std::string last = project.tree.joints[joints.back()].name;
  EXPECT_EQ(NotJudged(coverage), std::vector<std::string>{last});
  Verdict verdict;
  JudgeCoverage(coverage, verdict);
  ASSERT_EQ(verdict.remarks.size(), 1u);
  EXPECT_EQ(verdict.remarks[0], "chain left_arm: " + last +
                                    " not judged on held-out data, because no marker beyond was "
                                    "seen in the trials for validation that exercise it");
}

TEST_F(CoverageOfChains, WhereNoTrialForValidationCanBePredictedThatIsSaid) {
  Measurements measured;
  measured.calibration = Shown("left_arm");
  measured.validation = Shown("left_arm");
  TrialSummary tour;
  tour.trial = {.name = "tour", .kind = TrialKind::kRandom, .chains = {"left_arm"}};
  measured.trials = {tour};
  const ObservationMask none =
      ObservationMask::Constant(1, measured.validation.marker_count(), false);
  const std::vector<ChainCoverage> coverage = FindCoverage(project_, measured, &none);
  EXPECT_EQ(NotJudged(coverage), std::vector<std::string>{"chain left_arm"});
  Verdict verdict;
  JudgeCoverage(coverage, verdict);
  ASSERT_EQ(verdict.remarks.size(), 1u);
  EXPECT_NE(verdict.remarks[0].find("it is not judged on held-out data"), std::string::npos);
}

TEST_F(CoverageOfChains, AChainWhoseJointsOthersMoveInValidationIsJudged) {
  const Project project = WithWholeLeftArm();
  Measurements measured;
  measured.calibration = Shown("left_arm");
  measured.validation = Shown("left_arm");
  measured.validation.trials[0].chains = {"whole_left_arm"};
  for (const ChainCoverage& of : FindCoverage(project, measured)) {
    EXPECT_EQ(of.judged, of.chain == "left_arm" || of.chain == "whole_left_arm") << of.chain;
  }
}

}  // namespace
}  // namespace elastocal
