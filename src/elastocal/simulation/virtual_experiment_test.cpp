// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/virtual_experiment.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/robot/statics.hpp"
#include "tests/biped.hpp"

namespace elastocal {
namespace {

DescribedRobot DescribedBiped() {
  const Biped biped = MakeBiped();
  DescribedRobot robot{biped.tree, biped.chains, biped.markers, {{"WAIST", {0, 1, 2}}}, {}};
  for (int k = 0; k < static_cast<int>(biped.tree.joints.size()); ++k) {
    robot.torque_sensors.push_back(k);
  }
  return robot;
}

VirtualExperimentOptions Short() {
  VirtualExperimentOptions options;
  options.motion.head_postures = options.motion.leg_postures = 2;
  options.motion.random_postures = 1;
  options.motion.repetitions = 1;
  return options;
}

TEST(VirtualExperimentStudy, TheSameSeedGivesTheSameNumbers) {
  const VirtualExperiment first = PrepareExperiment(DescribedBiped(), Short());
  const VirtualExperiment again = PrepareExperiment(DescribedBiped(), Short());
  RunTrial(again, 0);  // the order of the trials does not matter
  const SimulatedTrial a = RunTrial(first, 1);
  const SimulatedTrial b = RunTrial(again, 1);
  EXPECT_EQ(a.motion.markers, b.motion.markers);
  EXPECT_EQ(a.raw.joints.time_s, b.raw.joints.time_s);
  EXPECT_EQ(a.raw.joints.positions, b.raw.joints.positions);
  EXPECT_EQ(a.raw.joints.torques, b.raw.joints.torques);
  EXPECT_EQ(first.legs[0].compliance.C_foot, again.legs[0].compliance.C_foot);
  // Gaps are NaN, which is not equal to itself.
  EXPECT_TRUE(((a.raw.markers.positions.array() == b.raw.markers.positions.array()) ||
               (a.raw.markers.positions.array().isNaN() && b.raw.markers.positions.array().isNaN()))
                  .all());
  VirtualExperimentOptions options = Short();
  options.seed = 2;
  const VirtualExperiment other = PrepareExperiment(DescribedBiped(), options);
  EXPECT_NE(other.robot.offset, first.robot.offset);
}

TEST(VirtualExperiment, RecordsTheSameRobotAgainWithOtherPostures) {
  const VirtualExperiment first = PrepareExperiment(DescribedBiped(), Short());
  VirtualExperimentOptions options = Short();
  options.seed = 2;
  options.robot_seed = Short().seed;
  const VirtualExperiment again = PrepareExperiment(DescribedBiped(), options);
  EXPECT_EQ(again.robot.offset, first.robot.offset);
  const double late = 0.8 * first.trials[0].motion.duration_s();
  EXPECT_NE(PostureAt(again.trials[0].motion, late), PostureAt(first.trials[0].motion, late));
}

TEST(VirtualExperiment, APerfectRobotFollowsTheForwardKinematics) {
  VirtualExperimentOptions options = Short();
  SwitchOffImperfections(options);
  const DescribedRobot described = DescribedBiped();
  const VirtualExperiment experiment = PrepareExperiment(described, options);
  for (std::size_t trial : {std::size_t{0}, std::size_t{1}}) {
    const SimulatedTrial played = RunTrial(experiment, trial);
    for (Eigen::Index i = 0; i < played.motion.frame_count(); i += 50) {
      // The encoders show the joints during the whole motion, not only at rest.
      const Eigen::VectorXd q = played.raw.joints.positions.row(i).transpose();
      const auto T_waist_link = LinkTransforms(described.tree, q);
      const Transform& T_camera_waist = played.motion.T_camera_waist[static_cast<std::size_t>(i)];
      for (std::size_t m = 0; m < described.markers.size(); ++m) {
        const Marker& marker = described.markers[m];
        const Eigen::Vector3d expected =
            T_camera_waist *
            (T_waist_link[static_cast<std::size_t>(marker.link)] * marker.p_link_marker);
        const Eigen::Vector3d found = played.raw.markers.positions.row(i)
                                          .segment<3>(3 * static_cast<Eigen::Index>(m))
                                          .transpose();
        EXPECT_LT((found - expected).norm(), 5e-8);  // logs are printed to 1e-8 rad
      }
    }
  }
}

// The trial has a rest, a way, and given samples with two rests. The leg is measured in the mean of
// these three rests.
TEST(VirtualExperimentStudy, LegsAreMeasuredInTheMeanOfTheirRests) {
  const DescribedRobot described = DescribedBiped();
  const VirtualExperiment plain = PrepareExperiment(described, Short(), {});
  const Eigen::VectorXd stand = plain.legs[1].posture;
  const int knee = plain.robot.legs[0].joints[3];
  const auto bent = [&](double by) {
    Eigen::VectorXd q = stand;
    q[knee] += by;
    return q;
  };
  PlannedTrial trial;
  trial.name = "on the first leg";
  trial.support = {plain.legs[0].foot_link};
  MotionSegment rest, way, given;
  rest.from = rest.to = way.from = stand;
  way.to = given.from = bent(0.1);
  given.to = bent(0.2);
  given.sample_s = Eigen::VectorXd::LinSpaced(5, 0.0, 1.0);
  given.samples.resize(5, stand.size());
  for (int i = 0; i < 5; ++i) given.samples.row(i) = (i < 2 ? given.from : given.to).transpose();
  trial.motion.segments = {rest, way, given};
  const VirtualExperiment experiment = PrepareExperiment(described, Short(), {trial});
  EXPECT_LT((experiment.legs[0].posture - bent(0.1)).norm(), 1e-12);
  EXPECT_EQ(experiment.legs[1].posture, stand);  // no trial stands on it alone
  trial.kind = TrialKind::kSine;
  EXPECT_EQ(PrepareExperiment(described, Short(), {trial}).legs[0].posture, stand);
}

TEST(VirtualExperimentStudy, ThePhysicsOfALegIsThatOfItsLumpedCompliance) {
  VirtualExperimentOptions options = Short();
  options.truth.leg_geometry_scale = 0.0;
  const VirtualExperiment experiment = PrepareExperiment(DescribedBiped(), options);
  const SimulatedTrial played = RunTrial(experiment, 1);
  const auto found = LargestWaistDeflection(experiment, 1, played.motion);
  // The waist sinks at least as far as the vertical stiffness alone gives way under the weight.
  const double weight = 9.81 * (TotalMass(experiment.robot.tree) - 10.0);
  EXPECT_GT(found.translation, weight * experiment.legs[1].compliance.C_foot(2, 2));
  EXPECT_LT(found.translation, 0.015);
  EXPECT_GT(found.rotation, 5e-4);
}

TEST(VirtualExperiment, TheCamerasSeeTheFloorLevel) {
  const VirtualExperiment experiment = PrepareExperiment(DescribedBiped(), Short());
  for (const Transform& T : experiment.T_camera_world) {
    EXPECT_LT((T.linear().col(2) - Eigen::Vector3d::UnitZ()).norm(), 1e-15);
    EXPECT_EQ(T.translation().z(), 0.0);
  }
}

TEST(VirtualExperiment, ARobotThatStandsFreeOnOneLegFalls) {
  VirtualExperimentOptions options = Short();
  options.physics.standing = Standing::kFree;
  const VirtualExperiment experiment = PrepareExperiment(DescribedBiped(), options);
  try {
    RunTrial(experiment, 1);
    FAIL() << "it should fall";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("trial 'left': the robot fell"), std::string::npos);
  }
}

TEST(VirtualExperiment, RefusesAnUnevenTimeStep) {
  VirtualExperimentOptions options = Short();
  options.physics.time_step_s = 0.003;
  EXPECT_THROW(PrepareExperiment(DescribedBiped(), options), InputError);
}

}  // namespace
}  // namespace elastocal
