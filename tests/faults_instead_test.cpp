// SPDX-License-Identifier: Apache-2.0
// Faults of joints beside what data with a fault may show instead: springs, causes, and a scale of
// the cameras.
#include <gtest/gtest.h>

#include "elastocal/elastocal.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/fault_or_causes.hpp"
#include "elastocal/mistakes/impossible_gears.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/screening/camera_scale.hpp"
#include "elastocal/screening/doubtful_gains.hpp"
#include "tests/faulty_arm.hpp"

namespace elastocal {
namespace {

using FaultsInstead = FaultyArm;

// The error without causes is that of the plain fit to the recording as it is.
TEST_F(FaultsInstead, AreComparedWithThePlainFitOfTheRecordingAsItIs) {
  recorded_.q.col(CoordinateOf("elbow_joint")) *= 1.03;
  Measurements measured;
  measured.calibration = recorded_;
  const auto found = FindWithoutCauses(project_, {}, measured, false);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->fault.kind, FaultKind::kJointGain);
  const CalibrationResult plain = Calibrate(model_, recorded_, base_, kKind, project_.calibration);
  const double error = MarkerError(plain, recorded_, project_.calibration);
  EXPECT_NEAR(found->without_causes, error, 0.02 * error);
  EXPECT_TRUE(ExplainPlainFit(ExplainFault(*found, project_).left, found->without_causes));
}

// 0.3 % is what gears have. 1 % is said, whether it is a gain beside the fit or a gear in it.
TEST_F(FaultsInstead, ADoubtfulGainIsOneThatNoGoodRobotHas) {
  const int elbow = CoordinateOf("elbow_joint");
  const auto doubtful = [&](const ErrorModel& model, ModelKind kind) {
    const BaseParameters base = FindBaseParameters(model, project_.identifiability);
    return FindDoubtfulGains(Calibrate(model, recorded_, base, kind, project_.calibration),
                             recorded_, project_.calibration);
  };
  EXPECT_TRUE(doubtful(model_, kKind).empty());
  const Eigen::VectorXd column = recorded_.q.col(elbow);
  recorded_.q.col(elbow) = 1.003 * column;
  EXPECT_TRUE(doubtful(model_, kKind).empty());
  recorded_.q.col(elbow) = 1.01 * column;
  Project geared = project_;
  geared.elasticity.extra = {"elbow_joint.gear"};
  const ErrorModel with_gear = MakeProjectModel(geared, {});
  for (const auto& found :
       {doubtful(model_, kKind), doubtful(with_gear, ModelKinds(with_gear).back())}) {
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found.front().coordinate, elbow);
    EXPECT_NEAR(found.front().size, 0.01, 5.0 * found.front().sd);
    ExpectIn(DescribeDoubtfulGain(found.front(), project_.tree),
             "elbow_joint: its positions may be 1.0");
  }
}

/// What is said of a gain of the rail that the scale of the lengths in `fit` would explain.
std::string SaidOfRail(const CalibrationResult& fit, int rail, const CalibrationOptions& options) {
  const auto scale = EstimateCommonScale(fit, options);
  if (!scale) return "no scale";
  RecordingFault gain{.coordinate = rail, .size = 1.0 / (1.0 + scale->size) - 1.0, .sd = 1e-4};
  return ScaleOfSlides({gain}, fit, options);
}

// The other lengths say the same of the cameras only if they say it together.
TEST_F(FaultsInstead, AGainOfASlideIsNoScaleOfTheCamerasWhereOneLengthMakesTheScale) {
  const int rail = CoordinateOf("rail_joint");
  const auto fit = [&](const Recording& recording) {
    return Calibrate(model_, recording, base_, kKind, project_.calibration);
  };
  Recording larger = recorded_;
  larger.markers *= 1.05;
  const CalibrationResult of_all = fit(larger);
  ASSERT_FALSE(EstimateCommonScale(of_all, project_.calibration)->of_one_length);
  ExpectIn(SaidOfRail(of_all, rail, project_.calibration), "the cameras' positions seem 1.0");
  RobotTree tree = project_.tree;
  tree.joints[Size(FindJoint(tree, "elbow_joint"))].T_parent_child.translation() *= 1.3;
  const ErrorModel longer = MakeErrorModel(tree, project_.markers, project_.placement);
  const CalibrationResult of_one = fit(Record(longer, base_.kept, 1));
  ASSERT_TRUE(EstimateCommonScale(of_one, project_.calibration)->of_one_length);
  EXPECT_EQ(SaidOfRail(of_one, rail, project_.calibration), "");
}

}  // namespace
}  // namespace elastocal
