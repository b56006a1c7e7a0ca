// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/matched_experiment.hpp"

#include <numeric>

#include <gtest/gtest.h>

#include "elastocal/robot/statics.hpp"
#include "tests/biped.hpp"

namespace elastocal {
namespace {

DescribedRobot Described() {
  const Biped biped = MakeBiped();
  DescribedRobot robot{biped.tree, biped.chains, biped.markers, {{"WAIST", {0, 1, 2}}}, {}};
  robot.torque_sensors.resize(biped.tree.joints.size());
  std::iota(robot.torque_sensors.begin(), robot.torque_sensors.end(), 0);
  return robot;
}

VirtualExperimentOptions ShortAndPerfect() {
  VirtualExperimentOptions options;
  options.motion.head_postures = options.motion.leg_postures = 2;
  options.motion.random_postures = options.motion.repetitions = 1;
  SwitchOffImperfections(options);
  return options;
}

/// Both legs are elastic, and so are the trunk's two joints.
ErrorModel Model(const DescribedRobot& robot) {
  return MakeErrorModel(
      robot.tree, robot.markers, {},
      {.torsion = {0, 1},
       .legs = {{"left", robot.chains[1].tip_link}, {"right", robot.chains[2].tip_link}}});
}

std::vector<int> All(const ErrorModel& model) {
  std::vector<int> all(static_cast<std::size_t>(model.parameter_count()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// A vertical spring carries the weight of all but its leg.
TEST(MatchedExperiment, TheWaistSinksByTheWeightOnItsLeg) {
  constexpr double kLeg = 5.0 + 3.0 + 1.5;  // kg
  constexpr double kCompliance = 5e-6;      // m/N
  const DescribedRobot described = Described();
  const ErrorModel model = Model(described);
  MatchedExperiment experiment =
      MatchExperiment(PrepareExperiment(described, ShortAndPerfect()), model, {});
  ASSERT_TRUE(experiment.truth.isZero());
  experiment.truth[FindParameter(model.parameters, "right.compliance_z")] = kCompliance;
  const int foot = described.chains[2].tip_link;
  ASSERT_EQ(experiment.plan.trials[1].support, std::vector<int>{foot});
  const TrueMotion motion = PlayMatchedMotion(experiment, 1);
  const double sinks = kCompliance * 9.81 * (TotalMass(described.tree) - kLeg);
  for (Eigen::Index i = 0; i < motion.frame_count(); i += 50) {
    const Eigen::VectorXd q = motion.encoders.row(i).transpose();
    EXPECT_EQ(q, PostureAt(experiment.plan.trials[1].motion, 0.01 * static_cast<double>(i)));
    Transform expected = motion.T_camera_foot[0] * LinkTransforms(model.tree, q)[foot].inverse();
    expected.translation().z() -= sinks;
    const Transform& found = motion.T_camera_waist[static_cast<std::size_t>(i)];
    // These are differences between sums of forces near 1e3 N, on legs with a condition number of
    // 1e1.
    EXPECT_LT((found.matrix() - expected.matrix()).cwiseAbs().maxCoeff(), 1e-12);
    const Eigen::VectorXd torques =
        StaticTorques(model.tree, q, found.linear().transpose() * Eigen::Vector3d(kGravity), foot);
    EXPECT_LT((motion.torques.row(i).transpose() - torques).cwiseAbs().maxCoeff(), 1e-9);
  }
  EXPECT_NEAR(LargestMatchedDeflection(experiment, 1, motion).translation, sinks, 1e-12);
  EXPECT_EQ(LargestMatchedDeflection(experiment, 0, PlayMatchedMotion(experiment, 0)).translation,
            0.0);
}

// In MuJoCo, the robot at rest with springs in the same joints hangs like ours.
TEST(MatchedExperiment, SpringsOfTheTrunkGiveWayAsInMuJoCo) {
  VirtualExperimentOptions options = ShortAndPerfect();
  options.truth.upper_elasticity_scale = 20.0;
  const DescribedRobot described = Described();
  const ErrorModel model = Model(described);
  const VirtualExperiment physical = PrepareExperiment(described, options);
  const TrueMotion motion = RunTrial(physical, 0).motion;
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(model.parameter_count());
  for (int k : {0, 1}) {
    truth[FindParameter(model.parameters, model.tree.joints[k].name + ".compliance_z")] =
        physical.robot.compliance[k];
  }
  const int last = motion.frame_count() - 1;  // at rest
  const auto hang = [&](const Eigen::VectorXd& errors) {
    return HoldWaist(model, ApplyErrors(model, errors), motion.encoders.row(last).transpose(),
                     motion.T_camera_waist[static_cast<std::size_t>(last)], kGravity,
                     described.torque_sensors);
  };
  for (int m = 3; m < 6; ++m) {
    const Eigen::Vector3d found = motion.markers.row(last).segment<3>(3 * m).transpose();
    EXPECT_GT((hang(0.0 * truth).markers.col(m) - found).norm(), 5e-4) << "nothing gives way";
    // The motion ended 1.5 s before. Remaining oscillation is smaller than this.
    EXPECT_LT((hang(truth).markers.col(m) - found).norm(), 1e-5);
  }
}

TEST(MatchedExperiment, DrawsWhatIsIdentifiableAndNothingElse) {
  const DescribedRobot described = Described();
  const ErrorModel model = Model(described);
  const std::vector<Leg> legs = FindLegs(described.tree, described.chains);
  const Eigen::VectorXd truth = DrawMatchedTruth(model, All(model), legs, {});
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Parameter& parameter = model.parameters[i];
    EXPECT_EQ(truth[i] == 0.0, parameter.kind == ParameterKind::kWaistPose) << parameter.name;
    if (!IsCompliance(parameter.kind)) continue;
    EXPECT_GT(truth[i], 0.0) << parameter.name;
  }
  EXPECT_EQ(DrawMatchedTruth(model, All(model), legs, {}), truth);
  EXPECT_NE(DrawMatchedTruth(model, All(model), legs, {.seed = 2}), truth);
  const Eigen::VectorXd one = DrawMatchedTruth(model, {7}, legs, {});
  EXPECT_EQ((one.array() != 0.0).count(), 1);
  EXPECT_NE(one[7], 0.0);
  EXPECT_TRUE(DrawMatchedTruth(model, All(model), legs, ShortAndPerfect().truth).isZero());
}

}  // namespace
}  // namespace elastocal
