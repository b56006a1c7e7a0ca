// SPDX-License-Identifier: Apache-2.0
// The whole body at once, standing on its feet: truths of the estimator's own model are recovered.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "elastocal/calibration/leg_stiffness.hpp"
#include "elastocal/calibration/static_torques.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/screening/recording_faults.hpp"
#include "elastocal/screening/torque_check.hpp"
#include "elastocal/validation/model_comparison.hpp"
#include "tests/dense_problem.hpp"
#include "tests/standing_humanoid.hpp"

namespace elastocal {
namespace {

// Residuals of markers, feet and ties of trials are in mm, and unknowns are of the order of one.
// Loads are constant, as during a solve.
TEST(WholeBody, JacobianEqualsDifferences) {
  const StandingHumanoid robot(2, 5, true);
  const Eigen::VectorXd truth = robot.DrawTruth(6);
  const Recording recording = robot.Record(truth, {.torque_sensors = robot.project.torque_sensors});
  const Placement placement = RegisterPlacement(robot.model, recording, 1e-3);
  const std::vector<int> group = NoiseGroups(robot.model, recording);
  const Selection selection = SelectAll(robot.model, recording);
  const std::vector<PostureLoads> loads =
      ComputeLoads(robot.model, recording, truth, placement, {});
  const Prior prior;
  const Noise noise{Eigen::ArrayXXd::Constant(3, kNoiseSourceCount, 1e-3)};
  const RobustWeights weights;
  const CalibrationOptions options;
  std::vector<int> free(robot.model.parameters.size());
  std::iota(free.begin(), free.end(), 0);
  std::erase_if(free,
                [&](int i) { return robot.model.parameters[i].kind == ParameterKind::kWaistPose; });
  BodyResiduals problem(
      {robot.model, recording, group, selection, loads, prior, noise, weights, options}, free,
      truth, placement);
  Eigen::VectorXd x = problem.Start();
  Random random(7);
  for (double& value : x) value += random.Uniform(0.0, 0.3);
  const Eigen::MatrixXd J = DenseJacobian(problem, x);
  const Eigen::MatrixXd differences = DifferenceJacobian(problem, x, 1e-4);
  for (Eigen::Index u = 0; u < x.size(); ++u) {
    EXPECT_LT((differences.col(u) - J.col(u)).norm(), 1e-6 * (1.0 + J.col(u).norm()))
        << u << " "
        << (u < static_cast<Eigen::Index>(free.size())
                ? robot.model.parameters[free[static_cast<std::size_t>(u)]].name
                : "pose");
  }
}

TEST(WholeBody, NoiseFreeDataGiveBackEveryIdentifiableParameter) {
  const StandingHumanoid robot(24);
  const Eigen::VectorXd truth = robot.DrawTruth(3);
  const Recording recording =
      robot.Record(truth, {.marker_sd = 0.0, .torque_sensors = robot.project.torque_sensors});
  const CalibrationResult result =
      Calibrate(robot.model, recording, robot.base, ModelKind::kFull, {});
  EXPECT_EQ(result.termination, Termination::kConverged) << result.message;
  EXPECT_TRUE(result.outliers.empty());
  EXPECT_TRUE(result.loose_footings.empty());
  std::printf("%d iterations, %.2f s\n", result.iterations, result.solve_seconds);
  int told = 0;
  for (int i = 0; i < robot.model.parameter_count(); ++i) {
    const Parameter& parameter = robot.model.parameters[i];
    if (parameter.kind == ParameterKind::kWaistPose) continue;
    const double scale = ParameterScale(parameter);
    // Masses stay where the nominal link frames are. So the choice between combinations of
    // parameters that markers cannot tell apart changes the loads a little. This is not noise, but
    // a few standard deviations if the noise is a micrometre.
    EXPECT_LT(std::abs(result.delta[i] - truth[i]), 1e-6 * scale + 10.0 * result.sd[i])
        << parameter.name;
    // Turning a foot about the vertical is almost the same as turning the robot. So the compliance
    // about the vertical is determined a hundred times worse.
    if (result.sd[i] < 1e-3 * scale && !parameter.name.ends_with(".compliance_rz")) {
      EXPECT_NEAR(result.delta[i] / scale, truth[i] / scale, 5e-3) << parameter.name;
      ++told;
    }
  }
  EXPECT_GT(told, 100);
}

// The constraint of eq. 14 with the foot as root (above, its pose is a nuisance). With perfect
// data, both give the truth. What this form takes as exact has a standard deviation of a micrometre
// above.
TEST(WholeBody, RootedInTheFootGivesBackTheTruth) {
  const StandingHumanoid robot(10);
  const Eigen::VectorXd truth = robot.DrawTruth(3);
  const Recording recording =
      robot.Record(truth, {.marker_sd = 0.0, .torque_sensors = robot.project.torque_sensors});
  CalibrationOptions options;
  options.support_form = SupportForm::kFootRooted;
  const CalibrationResult result =
      Calibrate(robot.model, recording, robot.base, ModelKind::kFull, options);
  EXPECT_EQ(result.termination, Termination::kConverged) << result.message;
  for (int i = 0; i < robot.model.parameter_count(); ++i) {
    const Parameter& parameter = robot.model.parameters[i];
    if (parameter.kind == ParameterKind::kWaistPose) continue;
    EXPECT_LT(std::abs(result.delta[i] - truth[i]),
              5e-3 * ParameterScale(parameter) + 5.0 * result.sd[i])
        << parameter.name;
  }
}

/// The robot and its recording with usual noise and 16 postures in each trial.
class StandingTest : public ::testing::Test {
 protected:
  Recording Record() const {
    return robot_.Record(
        truth_,
        {.marker_sd = 5e-5, .torque_sd = 0.1, .torque_sensors = robot_.project.torque_sensors});
  }
  CalibrationResult Estimate(const Recording& recording) const {
    return Calibrate(robot_.model, recording, robot_.base, ModelKind::kFull, {});
  }
  /// The largest difference of a joint's parameter or a compliance, in standard deviations.
  double LargestDifference(const CalibrationResult& a, const CalibrationResult& b) const {
    double largest = 0.0;
    for (int i : robot_.base.kept) {
      if (IsExternal(robot_.model.parameters[i].kind)) continue;
      if (a.status[i] != ParameterStatus::kEstimated) continue;
      largest = std::max(largest, std::abs(a.delta[i] - b.delta[i]) / a.sd[i]);
    }
    return largest;
  }

  StandingHumanoid robot_{16};
  Eigen::VectorXd truth_ = robot_.DrawTruth(4);
};

TEST_F(StandingTest, AFootThatSlippedIsNamedAndStandsElsewhereFromThereOn) {
  const Recording clean = Record();
  Recording slipped = clean;
  const int trial = 3;  // the left leg swings while the robot stands on the right one
  ASSERT_EQ(clean.trials[trial].name, "leg_left");
  int posture = 0;
  while (clean.trial[posture] != trial) ++posture;
  posture += 9;
  for (int i = posture; clean.trial[i] == trial; ++i) {
    for (int m = 0; m < clean.marker_count(); ++m) slipped.markers(i, 3 * m) += 3e-3;
  }
  const CalibrationResult result = Estimate(slipped);
  ASSERT_EQ(result.slips.size(), 1u);
  EXPECT_EQ(result.slips[0].trial, trial);
  EXPECT_EQ(result.slips[0].posture, posture);
  EXPECT_NEAR(result.slips[0].distance, 3e-3, 2e-4);
  EXPECT_EQ(robot_.model.legs[result.slips[0].leg].name, "leg_right");
  const CalibrationResult without = Estimate(clean);
  EXPECT_TRUE(without.slips.empty());
  EXPECT_LT(LargestDifference(result, without), 3.0);
}

// The support is known from the data: a leg carries the robot whether it gives way or not.
TEST_F(StandingTest, RigidLegsCarryTheRobotToo) {
  for (int i = 0; i < robot_.model.parameter_count(); ++i) {
    if (robot_.model.parameters[i].leg >= 0) truth_[i] = 0.0;
  }
  const Recording recording = Record();
  Elasticity rigid_legs = robot_.model.elasticity;
  rigid_legs.base = false;
  const ErrorModel model = MakeErrorModel(robot_.project.tree, robot_.model.markers,
                                          robot_.project.placement, rigid_legs);
  EXPECT_EQ(model.leg_count(), 2);
  for (const Parameter& parameter : model.parameters) EXPECT_LT(parameter.leg, 0);
  const CalibrationResult result =
      Calibrate(model, recording, FindBaseParameters(model, robot_.project.identifiability),
                ModelKind::kFull, {});
  EXPECT_EQ(result.placement.footings.size(), 2u);
  EXPECT_TRUE(result.outliers.empty());
  EXPECT_TRUE(result.loose_footings.empty());
  EXPECT_TRUE(AssessLegs(result, recording).empty());
  // The standing leg tells its joints as well as with a model whose compliances do not exist.
  const CalibrationResult elastic = Estimate(recording);
  int compared = 0;
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Parameter& parameter = model.parameters[i];
    if (parameter.joint < 0 || result.status[i] != ParameterStatus::kEstimated) continue;
    for (int k = 0; k < robot_.model.parameter_count(); ++k) {
      if (robot_.model.parameters[k].name != parameter.name) continue;
      EXPECT_LT(result.sd[i], 1.02 * elastic.sd[k]) << parameter.name;
      ++compared;
    }
  }
  EXPECT_GT(compared, 50);
}

// An encoder is off in the second half of a trial, and right again in the next trial.
TEST_F(StandingTest, AnOffsetThatEndsWithItsTrialIsNamed) {
  Recording recording = Record();
  const int joint = FindJoint(robot_.project.tree, "torso_1_joint");
  const int coordinate = robot_.project.tree.joints[joint].coordinate;
  const int trial = 1;  // the left arm; the next trial shows the trunk as well
  ASSERT_EQ(recording.trials[trial].name, "torso_arm_left");
  const auto first = std::find(recording.trial.begin(), recording.trial.end(), trial);
  const auto begin = static_cast<int>(first - recording.trial.begin());
  const auto count = static_cast<int>(std::count(first, recording.trial.end(), trial));
  EXPECT_TRUE(FindRecordingFaults(Estimate(recording), recording, {}).empty());
  recording.q.col(coordinate).segment(begin + count / 2, count - count / 2).array() += 0.05;
  const std::vector<RecordingFault> found = FindRecordingFaults(Estimate(recording), recording, {});
  ASSERT_FALSE(found.empty());
  EXPECT_TRUE(IsInPartOfTrial(found[0], recording));
  EXPECT_EQ(found[0].trial, trial);
  EXPECT_EQ(found[0].posture, begin + count / 2);
  EXPECT_EQ(found[0].coordinate, coordinate);
  EXPECT_NEAR(found[0].size, 0.05, 0.005);
}

// A log in another unit or for another gear. Other trials show the same joint.
TEST_F(StandingTest, AGainInOneTrialIsNoOffset) {
  Recording recording = Record();
  const int joint = FindJoint(robot_.project.tree, "torso_1_joint");
  const int coordinate = robot_.project.tree.joints[joint].coordinate;
  const std::vector<int> trials = TrialsThatMove(recording, coordinate);
  ASSERT_GT(trials.size(), 1u);
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (recording.trial[i] == trials[1]) recording.q(i, coordinate) *= 1.03;
  }
  const std::vector<RecordingFault> found = FindRecordingFaults(Estimate(recording), recording, {});
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].kind, FaultKind::kJointGain);
  EXPECT_EQ(found[0].trial, trials[1]);
  EXPECT_EQ(found[0].coordinate, coordinate);
  EXPECT_NEAR(found[0].size, 0.03, 0.003);
}

// Statics tells faults of torque sensors from errors of the robot.
TEST_F(StandingTest, TorquesThatContradictStaticsAreNamed) {
  const Recording clean = Record();
  EXPECT_TRUE(FindContradictoryTorques(robot_.model, clean, 1e-3).empty());
  const int knee = FindJoint(robot_.project.tree, "leg_right_4_joint");
  const int hip = FindJoint(robot_.project.tree, "leg_left_2_joint");
  const auto only = [&](const Recording& recording, int joint, TorqueContradiction kind) {
    const auto found = FindContradictoryTorques(robot_.model, recording, 1e-3);
    ASSERT_FALSE(found.empty());
    ASSERT_EQ(found.size(), 1u) << Describe(found.front(), robot_.project.tree);
    EXPECT_EQ(found[0].joint, joint);
    EXPECT_EQ(static_cast<int>(found[0].kind), static_cast<int>(kind));
  };
  Recording recording = clean;
  recording.torques.col(knee) *= -1.0;
  only(recording, knee, TorqueContradiction::kReversed);
  const int elbow = FindJoint(robot_.project.tree, "arm_left_4_joint");  // carries little
  recording = clean;
  recording.torques.col(elbow) *= -1.0;
  only(recording, elbow, TorqueContradiction::kReversed);
  recording = clean;
  Random random(7);
  for (auto& torque : recording.torques.col(elbow)) torque = random.Normal(0.5);
  only(recording, elbow, TorqueContradiction::kUnrelated);
  recording = clean;
  recording.torques.col(knee) *= 1000.0;
  only(recording, knee, TorqueContradiction::kScaled);
  recording = clean;
  recording.torques.col(knee) *= 1.7;  // only this sensor of its leg
  only(recording, knee, TorqueContradiction::kScaled);
  recording = clean;
  for (int joint : robot_.model.legs[1].joints) recording.torques.col(joint) *= 1.7;
  for (const auto& one : FindContradictoryTorques(robot_.model, recording, 1e-3)) {
    EXPECT_NE(one.kind, TorqueContradiction::kScaled) << one.joint;  // masses may be wrong by this
  }
  recording = clean;
  recording.torques.col(hip).array() += 40.0;
  only(recording, hip, TorqueContradiction::kBiased);
  recording = clean;
  recording.torques.col(knee).swap(recording.torques.col(hip));
  const auto swapped = FindContradictoryTorques(robot_.model, recording, 1e-3);
  ASSERT_EQ(swapped.size(), 2u);
  EXPECT_EQ(swapped[0].other, swapped[1].joint);
  EXPECT_EQ(swapped[1].other, swapped[0].joint);
  HideTorques(swapped, recording);
  EXPECT_TRUE(FindContradictoryTorques(robot_.model, recording, 1e-3).empty());
  // All sensors are reversed, including those of joints whose load varies little.
  recording = clean;
  recording.torques *= -1.0;
  const auto all = FindContradictoryTorques(robot_.model, recording, 1e-3);
  Eigen::Index sensors = 0;
  for (Eigen::Index c = 0; c < clean.torques.cols(); ++c) {
    sensors += clean.torques.col(c).array().isNaN().all() ? 0 : 1;
  }
  EXPECT_EQ(static_cast<Eigen::Index>(all.size()), sensors);
  for (const ContradictoryTorque& one : all) {
    EXPECT_EQ(static_cast<int>(one.kind), static_cast<int>(TorqueContradiction::kReversed));
  }
  // With this factor, no single sensor would be accused, or only some of them.
  for (const double factor : {1.7, 2.0, 0.6}) {
    recording = clean;
    recording.torques *= factor;
    const auto scaled = FindContradictoryTorques(robot_.model, recording, 1e-3);
    EXPECT_EQ(static_cast<Eigen::Index>(scaled.size()), sensors) << factor;
    for (const ContradictoryTorque& one : scaled) {
      EXPECT_EQ(static_cast<int>(one.kind), static_cast<int>(TorqueContradiction::kScaled));
      EXPECT_NEAR(one.slope, factor, 0.1 * factor);
    }
  }
  recording = clean;
  recording.torques *= 1.3;  // masses of a robot description may have such errors
  EXPECT_TRUE(FindContradictoryTorques(robot_.model, recording, 1e-3).empty());
}

// A weight that is displaced by 20 mm hides the load of an ankle whose torques vary little. But it
// does not reverse its sign.
TEST_F(StandingTest, AReversedSensorThatVariesLittleIsNamed) {
  const Recording clean = Record();
  const int ankle = FindJoint(robot_.project.tree, "leg_left_5_joint");
  std::vector<double> known;
  for (const double torque : clean.torques.col(ankle)) {
    if (std::isfinite(torque)) known.push_back(torque);
  }
  ASSERT_GT(known.size(), 24u);
  const double middle = Median(
      Eigen::Map<const Eigen::VectorXd>(known.data(), static_cast<Eigen::Index>(known.size())));
  constexpr double kNear = 20.0;  // N.m; less spread than 20 mm would cause, 17 N.m
  Recording recording = clean;
  for (double& torque : recording.torques.col(ankle)) {
    torque = std::abs(torque - middle) < kNear ? torque : std::nan("");
  }
  EXPECT_TRUE(FindContradictoryTorques(robot_.model, recording, 1e-3).empty());
  recording.torques.col(ankle) *= -1.0;
  const auto found = FindContradictoryTorques(robot_.model, recording, 1e-3);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].joint, ankle);
  EXPECT_EQ(static_cast<int>(found[0].kind), static_cast<int>(TorqueContradiction::kReversed));
}

// The uncertainty of a leg's load: if all sensors show a quarter too much, their error is a fifth
// of their values.
TEST_F(StandingTest, TheDisagreementOfSensorsAndStaticsIsAShareOfTheTorques) {
  Recording recording = Record();
  const Placement placement = RegisterPlacement(robot_.model, recording, 1e-3);
  const double clean = TorqueDisagreement(robot_.model, recording, placement, 0);
  EXPECT_LT(clean, 0.06);  // statics uses the nominal geometry
  recording.torques *= 1.25;
  EXPECT_NEAR(TorqueDisagreement(robot_.model, recording, placement, 0), 0.2, clean);
  recording.torques.setConstant(std::nan(""));
  EXPECT_TRUE(std::isinf(TorqueDisagreement(robot_.model, recording, placement, 0)));
}

TEST_F(StandingTest, ATorqueSensorLeftOutIsReplacedByStatics) {
  const Recording clean = Record();
  Recording without_knee = clean;
  const int knee = FindJoint(robot_.project.tree, "leg_right_4_joint");
  without_knee.torques.col(knee).setConstant(std::numeric_limits<double>::quiet_NaN());
  const CalibrationResult result = Estimate(without_knee);
  EXPECT_EQ(result.loads.without_torques, std::vector<int>{knee});
  EXPECT_LT(LargestDifference(result, Estimate(clean)), 3.0);
}

// A straight knee makes the leg's Jacobian singular, so that its torques do not tell the load.
TEST_F(StandingTest, StraightKneesAreReportedAndTheirLoadsTakenFromStatics) {
  for (const char* side : {"left", "right"}) {
    const std::string leg = std::string("leg_") + side;
    const auto coordinate = [&](const char* joint) {
      return robot_.project.tree.joints[FindJoint(robot_.project.tree, leg + joint)].coordinate;
    };
    for (PlayedTrial& played : robot_.trials) {
      if (played.trial.name == leg) continue;
      played.q.col(coordinate("_3_joint")).setConstant(-0.01);
      played.q.col(coordinate("_4_joint")).setConstant(0.02);
      played.q.col(coordinate("_5_joint")).setConstant(-0.01);
    }
  }
  const CalibrationResult result = Estimate(Record());
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_EQ(result.loads.badly_conditioned.size(), 32u);  // all postures of both leg trials
  for (int i : robot_.base.kept) {
    const Parameter& parameter = robot_.model.parameters[i];
    if (parameter.kind != ParameterKind::kLegForce && parameter.kind != ParameterKind::kLegMoment) {
      continue;
    }
    EXPECT_LT(std::abs(result.delta[i] - truth_[i]), 4.0 * result.sd[i]) << parameter.name;
  }
}

}  // namespace
}  // namespace elastocal
