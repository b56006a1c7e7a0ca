// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/virtual_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/simulation/balanced_motion.hpp"
#include "elastocal/simulation/driving_base.hpp"
#include "elastocal/simulation/faults.hpp"
#include "elastocal/simulation/standing_feet.hpp"
#include "elastocal/simulation/stream_seed.hpp"

namespace elastocal {
namespace {

/// Draws the poses at which the robot is put down: near one place of the laboratory, roughly in one
/// direction. If a foot stays (PlannedTrial::stays), the robot is not put down anew.
std::vector<Transform> DrawPlaces(std::uint64_t seed, const std::vector<PlannedTrial>& trials) {
  Random random(StreamSeed(seed, "place"));
  const double yaw = random.Uniform(-M_PI, M_PI);
  const Eigen::Vector3d centre(random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0), 0.0);
  std::vector<Transform> places;
  for (const PlannedTrial& trial : trials) {
    const Eigen::Vector3d shift(random.Uniform(-0.1, 0.1), random.Uniform(-0.1, 0.1), 0.0);
    places.push_back(Transform(Eigen::Translation3d(centre + shift)) *
                     RotZ(yaw + random.Uniform(-0.1, 0.1)));
    if (trial.stays) places.back() = places[places.size() - 2];
  }
  return places;
}

/// Postures in which a motion comes to rest: those of its rests, and of given samples those that
/// repeat.
std::vector<Eigen::VectorXd> RestPostures(const Motion& motion) {
  std::vector<Eigen::VectorXd> postures;
  for (const MotionSegment& segment : motion.segments) {
    if (segment.IsRest()) postures.push_back(segment.to);
    bool resting = false;
    for (Eigen::Index i = 1; i < segment.samples.rows(); ++i) {
      const bool rests = segment.samples.row(i) == segment.samples.row(i - 1);
      if (rests && !resting) postures.emplace_back(segment.samples.row(i).transpose());
      resting = rests;
    }
  }
  return postures;
}

/// The mean of the postures in which the robot rests on one foot alone in calibration trials; where
/// there are none, `stand`.
Eigen::VectorXd PostureOn(int foot_link, const std::vector<PlannedTrial>& trials,
                          const Eigen::VectorXd& stand) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(stand.size());
  int count = 0;
  for (const PlannedTrial& trial : trials) {
    if (trial.kind != TrialKind::kCalibration || trial.support != std::vector{foot_link}) continue;
    for (const Eigen::VectorXd& posture : RestPostures(trial.motion)) {
      sum += posture;
      ++count;
    }
  }
  return count > 0 ? Eigen::VectorXd(sum / count) : stand;
}

}  // namespace

void SwitchOffImperfections(VirtualExperimentOptions& options) {
  TruthOptions& truth = options.truth;
  truth.upper_geometry_scale = truth.leg_geometry_scale = truth.marker_sd = 0.0;
  truth.upper_elasticity_scale = truth.leg_elasticity_scale = 0.0;
  truth.mass_sd = truth.com_sd = truth.friction_share = 0.0;
  truth.torque_gain_sd = truth.torque_bias_sd = 0.0;
  SensorOptions& sensors = options.sensors;
  sensors.marker_noise_sd = sensors.gaps_per_minute = 0.0;
  sensors.outlier_share = sensors.swaps_per_minute = 0.0;
  sensors.least_lag_s = sensors.largest_lag_s = sensors.drift_size_ppm = 0.0;
  sensors.encoder_bits = 0;
  sensors.torque_noise_sd = 0.0;
  InstrumentOptions& instruments = options.instruments;
  instruments.length_sd = instruments.rotation_sd = instruments.acceleration_sd = 0.0;
  instruments.pixel_sd = instruments.blur_sd = 0.0;
  instruments.touch_height_sd = instruments.touch_tilt_sd = instruments.table_height_sd = 0.0;
  options.faults = {};
}

VirtualExperiment PrepareExperiment(const DescribedRobot& described,
                                    const VirtualExperimentOptions& options) {
  MotionOptions motion = options.motion;
  motion.seed = options.seed;
  return PrepareExperiment(described, options,
                           PlanTrials(described.tree, described.chains, motion));
}

VirtualExperiment PrepareExperiment(const DescribedRobot& described,
                                    const VirtualExperimentOptions& options,
                                    std::vector<PlannedTrial> trials) {
  const double steps = 0.01 / options.physics.time_step_s;
  if (std::abs(steps - std::round(steps)) > 1e-6) {
    throw InputError("the time step " + std::to_string(options.physics.time_step_s) +
                     " s: a hundredth of a second must be a whole number of steps");
  }
  VirtualExperiment experiment;
  experiment.options = options;
  experiment.options.truth.seed = options.robot_seed.value_or(options.seed);
  experiment.options.motion.seed = options.seed;
  experiment.options.sensors.seed = options.seed;
  experiment.described_tree = described.tree;
  experiment.clusters = described.clusters;
  const std::vector<Leg> legs = FindLegs(described.tree, described.chains);
  experiment.robot =
      DrawTrueRobot(NominalRobot(described.tree, described.markers, legs, described.torque_sensors),
                    experiment.options.truth);
  experiment.trials = std::move(trials);
  if (legs.empty() && options.physics.standing == Standing::kFree) {
    throw InputError("robot '" + described.tree.name + "' has no legs to stand on freely");
  }
  CheckFaults(options.faults, experiment.robot, experiment.clusters, experiment.trials);
  experiment.T_camera_world = DrawPlaces(options.seed, experiment.trials);
  const PostureSampler sampler(described.tree, legs, options.motion.postures,
                               StreamSeed(options.seed, "stand"));
  for (const Leg& leg : legs) {
    const Eigen::VectorXd posture = PostureOn(leg.foot_link, experiment.trials, sampler.stand());
    experiment.legs.push_back(
        {leg.chain, leg.foot_link, posture,
         LumpedWaistCompliance(experiment.robot, leg, posture, options.physics)});
  }
  return experiment;
}

SimulatedTrial RunTrial(const VirtualExperiment& experiment, std::size_t index) {
  const PlannedTrial& trial = experiment.trials[index];
  SimulatedTrial result;
  try {
    const PhysicsOptions& physics = experiment.options.physics;
    const Transform& T_camera_world = experiment.T_camera_world[index];
    result.motion =
        CountBalls(trial.support, physics) >= kBallsThatStand
            ? PlayBalanced(experiment.robot, experiment.described_tree, trial.support, trial.motion,
                           T_camera_world, physics)
            : PlayMotion(experiment.robot, trial.support, trial.motion, T_camera_world, physics);
  } catch (const InputError& error) {
    throw InputError("trial '" + trial.name + "': " + error.what());
  }
  if (experiment.options.free_root && trial.support.empty()) {
    DriveBase(trial.motion, experiment.T_camera_world[index],
              StreamSeed(experiment.options.seed, "drive " + trial.name), result.motion);
  }
  result.raw = Measure(experiment.robot, experiment.clusters, experiment.trials, index,
                       result.motion, experiment.options.sensors, experiment.options.faults);
  return result;
}

WaistGive LargestWaistDeflection(const VirtualExperiment& experiment, std::size_t index,
                                 const TrueMotion& motion) {
  const PlannedTrial& trial = experiment.trials[index];
  // Balls turn where they stand, so that they do not tell the pose of the waist.
  const PhysicsOptions& physics = experiment.options.physics;
  if (trial.support.empty() || CountBalls(trial.support, physics) > 0) return {};
  const auto foot = static_cast<std::size_t>(trial.support[0]);
  return LargestWaistGive(
      motion, RestFrames(trial.motion, motion), [&](const Eigen::VectorXd& encoders) -> Transform {
        return TrueLinkTransforms(experiment.robot,
                                  TrueJointPositions(experiment.robot, encoders))[foot]
            .inverse();
      });
}

}  // namespace elastocal
