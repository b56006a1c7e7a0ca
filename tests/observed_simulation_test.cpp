// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/observation/observed_posture.hpp"
#include "elastocal/planning/design_observations.hpp"
#include "elastocal/planning/simulate_observations.hpp"
#include "elastocal/simulation/level_feet.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

Project TouchProject() { return ReadProject(SourceFile("examples/talos_touch/project.yaml")); }

/// A rigid robot of which the zeros of joints alone are wrong, and perfect instruments.
VirtualExperimentOptions OffsetsAlone() {
  VirtualExperimentOptions options;
  SwitchOffImperfections(options);
  options.truth.upper_geometry_scale = options.truth.leg_geometry_scale = 1.0;
  options.truth.length_sd = options.truth.angle_sd = 0.0;
  options.instruments.table_height_sd = 5e-3;
  return options;
}

/// What the estimator's model with the true values leaves of what MuJoCo's robot shows.
TEST(SimulateObservations, MuJoCoShowsWhatTheModelWithTheTruthPredicts) {
  const Project project = TouchProject();
  const ObservationDesign drawn = DrawObservedPostures(project, 2, 3);
  ASSERT_TRUE(drawn.infeasible.empty()) << drawn.infeasible;
  const ObservedRecording recording = SimulateObservations(project, drawn.postures, OffsetsAlone());
  ASSERT_TRUE(recording.warnings.empty()) << recording.warnings.front();
  ASSERT_EQ(recording.postures.size(), 6u);

  // The right foot stands where the true robot has put it.
  ObservationSetup setup = recording.setup;
  const ObservedPostureSampler stance(project, 0);
  const LevelFeet feet(recording.robot.robot, stance.support(), stance.robot().rest);
  setup.feet[1].T_floor_foot = feet.T_floor_foot()[1];
  const ObservedRobot model = MakeObservedRobot(project.tree, project.placement, setup, {}, {});
  ObservedValues truth{
      Eigen::VectorXd::Zero(model.robot.parameter_count()), recording.quantities, {}};
  for (int i = 0; i < model.robot.parameter_count(); ++i) {
    const Parameter& parameter = model.robot.parameters[Size(i)];
    if (parameter.kind == ParameterKind::kTheta && model.unknown[Size(i)] >= 0) {
      truth.robot[i] = recording.robot.robot.offset[parameter.joint];
    }
  }
  Observations all;
  all.q.resize(6, project.tree.coordinate_count());
  for (int i = 0; i < 6; ++i) {
    const SimulatedPosture& of = recording.postures[Size(i)];
    all.postures.push_back({0, i});
    all.q.row(i) = of.encoders.transpose();
    if (of.plate >= 0) all.all.push_back({i, of.plate, {}, {}});
    for (int n = 0; n < static_cast<int>(of.measured.size()); ++n) {
      if (of.measured[Size(n)].size() > 0) all.all.push_back({i, n, of.measured[Size(n)], {}});
    }
  }
  const std::vector<Eigen::VectorXd> left = LeftOf(model, all, truth);
  int touches = 0, views = 0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    const Instrument& instrument = model.instrument(all.all[i].instrument);
    if (instrument.measured_size() == 0) {
      // The contact gives way by up to a millimetre; offsets of a degree are 10 mm and 20 mrad.
      EXPECT_NEAR(left[i][0], 0.0, 1.5e-3) << instrument.name;
      EXPECT_NEAR(left[i][1], 0.0, 3e-3) << instrument.name;
      EXPECT_NEAR(left[i][2], 0.0, 3e-3) << instrument.name;
      ++touches;
    } else if (instrument.measured_size() == 8) {
      EXPECT_LT(left[i].cwiseAbs().maxCoeff(), 0.3) << instrument.name;  // px; offsets: 10
      ++views;
    } else {
      EXPECT_LT(left[i].cwiseAbs().maxCoeff(), 3e-3) << instrument.name;  // m/s^2; offsets: 0.2
    }
  }
  EXPECT_EQ(touches, 4);
  EXPECT_GT(views, 0);
}

TEST(DesignObservations, ChosenPosturesTellMoreThanRandomOnes) {
  const Project project = TouchProject();
  const ObservationDesign design = DesignObservations(project, {.count = 10, .candidates = 3});
  ASSERT_TRUE(design.infeasible.empty()) << design.infeasible;
  std::size_t count = 0;
  for (const ChainPostures& of : design.postures) {
    count += of.q.size();
    for (const Eigen::VectorXd& q : of.q) {
      EXPECT_TRUE(((q - project.motion.lower).array() >= 0.0).all());
      EXPECT_TRUE(((project.motion.upper - q).array() >= 0.0).all());
    }
  }
  EXPECT_EQ(count, 10u);
  EXPECT_EQ(design.candidates, 30);
  EXPECT_GT(design.information, 1.05 * design.information_at_random);
}

}  // namespace
}  // namespace elastocal
