// SPDX-License-Identifier: Apache-2.0
// The spring between the markers of a foot and the floor, for robots that MuJoCo plays.
#include "elastocal/calibration/sole_springs.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/pipeline/known_soles.hpp"
#include "elastocal/robot/statics.hpp"
#include "elastocal/simulation/given_motion.hpp"
#include "elastocal/simulation/virtual_experiment.hpp"
#include "elastocal/simulation/waist_give.hpp"
#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

/// The biped bends its trunk on both feet, on the right one, on the left one, and on both again.
class PlayedSoles : public testing::Test {
 protected:
  JointMotion Programme() const {
    const int left = robot_.left, right = robot_.right;
    const std::vector<std::vector<int>> stances = {{left, right}, {right}, {left}, {left, right}};
    constexpr int kEach = 6;  // samples of each stance, 0.5 s apart
    JointMotion motion;
    motion.source = "programme";
    motion.q.setZero(4 * kEach, robot_.biped.tree.coordinate_count());
    motion.time_s.setLinSpaced(4 * kEach, 0.0, 0.5 * (4 * kEach - 1));
    for (int i = 0; i < 4 * kEach; ++i) {
      motion.support.push_back(stances[static_cast<std::size_t>(i / kEach)]);
      motion.q(i, Coordinate("trunk_pitch")) = 0.1 * std::sin(0.6 * i);
      for (const std::string side : {"left", "right"}) {
        motion.q(i, Coordinate(side + "_3")) = -0.3;
        motion.q(i, Coordinate(side + "_4")) = 0.6;
        motion.q(i, Coordinate(side + "_5")) = -0.3;
      }
    }
    return motion;
  }

  int Coordinate(const std::string& joint) const {
    return robot_.biped.tree.joints[FindJoint(robot_.biped.tree, joint)].coordinate;
  }

  /// Records every fifth frame of a robot by cameras and log, whether it moves or not.
  Recording Record(const VirtualExperiment& experiment) const {
    std::vector<Trial> trials;
    std::vector<Eigen::RowVectorXd> q, markers, torques;
    std::vector<int> trial;
    for (std::size_t t = 0; t < experiment.trials.size(); ++t) {
      const SimulatedTrial played = RunTrial(experiment, t);
      trials.push_back({.name = experiment.trials[t].name,
                        .chains = {},
                        .support = experiment.trials[t].support});
      for (Eigen::Index i = 0; i < played.motion.markers.rows(); i += 5) {
        q.emplace_back(played.motion.encoders.row(i));
        markers.emplace_back(played.raw.markers.positions.row(i));
        torques.emplace_back(
            played.motion.torques.row(i).cwiseProduct(experiment.robot.torque_gain.transpose()) +
            experiment.robot.torque_bias.transpose());
        trial.push_back(static_cast<int>(t));
      }
    }
    Recording recording = robot_.Empty(trials, 0);
    recording.trial = trial;
    recording.q.resize(static_cast<Eigen::Index>(q.size()), q[0].size());
    recording.markers.resize(recording.q.rows(), markers[0].size());
    recording.torques.resize(recording.q.rows(), torques[0].size());
    for (std::size_t i = 0; i < q.size(); ++i) {
      recording.q.row(static_cast<Eigen::Index>(i)) = q[i];
      recording.markers.row(static_cast<Eigen::Index>(i)) = markers[i];
      recording.torques.row(static_cast<Eigen::Index>(i)) = torques[i];
    }
    return recording;
  }

  VirtualExperiment Prepare(const VirtualExperimentOptions& options) const {
    const Biped& biped = robot_.biped;
    return PrepareExperiment(
        {biped.tree, biped.chains, biped.markers, {}, {}}, options,
        PlanGivenMotion(biped.tree, biped.chains, Programme(), options.motion, {}));
  }

  CalibrationResult Nominal() const {
    CalibrationResult result;
    result.model = robot_.model;
    result.delta.setZero(robot_.model.parameter_count());
    return result;
  }

  std::vector<SoleSpring> Estimate(const Recording& recording) const {
    return EstimateSoleSprings(Nominal(),
                               FindFootRests(robot_.biped.tree, robot_.biped.markers, recording),
                               recording.gravity);
  }

  const StandingBiped robot_ = {};
};

TEST_F(PlayedSoles, AreWithinTheirIntervals) {
  int told = 0;
  double normalised = 0.0;
  constexpr int kRobots = 4;
  for (int seed = 1; seed <= kRobots; ++seed) {
    VirtualExperimentOptions options;
    options.seed = static_cast<std::uint64_t>(seed);
    const VirtualExperiment experiment = Prepare(options);
    const std::vector<SoleSpring> soles = Estimate(Record(experiment));
    ASSERT_EQ(soles.size(), 2u);
    for (std::size_t leg = 0; leg < 2; ++leg) {
      const double truth = experiment.robot.foot_compliance[leg][2];
      EXPECT_EQ(soles[leg].changes, 1);
      EXPECT_NEAR(soles[leg].compliance, truth, 3.0 * soles[leg].sd) << seed << soles[leg].leg;
      normalised += std::pow((soles[leg].compliance - truth) / soles[leg].sd, 2);
      told += soles[leg].told();
    }
  }
  EXPECT_EQ(told, 2 * kRobots);
  // The mean square of eight numbers is below 3.3 with a probability of 99.9 %.
  EXPECT_LT(normalised / (2 * kRobots), 3.3);
}

TEST_F(PlayedSoles, OfFirmFeetNoneIsTold) {
  for (std::uint64_t seed : {1u, 2u}) {
    VirtualExperimentOptions options;
    options.seed = seed;
    VirtualExperiment experiment = Prepare(options);
    for (Vector6d& compliance : experiment.robot.foot_compliance) compliance.setZero();
    for (const SoleSpring& sole : Estimate(Record(experiment))) {
      EXPECT_EQ(sole.changes, 1);
      EXPECT_FALSE(sole.told()) << seed << sole.leg << sole.compliance;
      EXPECT_LT(sole.most(), 0.3e-6);
    }
  }
}

TEST_F(PlayedSoles, WrongTorquesTellNothing) {
  const Recording recording = Record(Prepare({}));
  // A crane carries a part of the weight, or the torques are wrong.
  Recording lighter = recording;
  lighter.torques *= 0.6;
  for (const SoleSpring& sole : Estimate(lighter)) EXPECT_TRUE(std::isinf(sole.sd)) << sole.leg;

  // After the recording is read, mistakes are corrected (--accept) and sensors that contradict
  // statics are hidden. The remaining torques give the shares of the weight.
  Measurements measured;
  measured.calibration = recording;
  measured.foot_rests = FindFootRests(robot_.biped.tree, robot_.biped.markers, recording);
  for (const Trial& trial : recording.trials) measured.trials.emplace_back().trial = trial;
  Project project;
  project.tree = robot_.biped.tree;
  project.markers = robot_.biped.markers;
  const std::vector<SoleSpring> sound = Estimate(recording);
  const std::vector<SoleSpring> known = KnownSoles(project, Nominal(), measured, {});
  for (std::size_t leg = 0; leg < 2; ++leg) {
    EXPECT_TRUE(known[leg].told());
    EXPECT_EQ(known[leg].compliance, sound[leg].compliance);
  }
  measured.calibration.torques.col(FindJoint(project.tree, "left_4")).setConstant(NAN);
  for (const SoleSpring& sole : KnownSoles(project, Nominal(), measured, {})) {
    EXPECT_TRUE(std::isinf(sole.sd)) << sole.leg;
  }
}

TEST_F(PlayedSoles, ARobotThatIsPutDownAnewTellsNothing) {
  VirtualExperiment experiment = Prepare({});
  for (std::size_t t = 1; t < experiment.trials.size(); ++t) {
    experiment.T_camera_world[t] =
        Eigen::Translation3d(1e-3, 0.0, -5e-4) * experiment.T_camera_world[t - 1];
  }
  for (const SoleSpring& sole : Estimate(Record(experiment))) EXPECT_TRUE(std::isinf(sole.sd));
}

}  // namespace
}  // namespace elastocal
