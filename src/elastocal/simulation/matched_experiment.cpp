// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/matched_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/leg_load.hpp"
#include "elastocal/robot/statics.hpp"
#include "elastocal/simulation/stream_seed.hpp"

namespace elastocal {
namespace {

/// Pose of a foot that lies flat on the floor where the experiment puts the robot down.
Transform FootPose(const MatchedExperiment& experiment, std::size_t index, int foot_link) {
  Transform T_world_foot = Transform::Identity();
  for (const Leg& leg : experiment.plan.robot.legs) {
    if (leg.foot_link == foot_link) T_world_foot.linear() = leg.R_floor_foot;
  }
  return experiment.plan.T_camera_world[index] * T_world_foot;
}

std::vector<int> TorqueSensors(const TrueRobot& robot) {
  std::vector<int> joints;
  for (std::size_t k = 0; k < robot.torque_sensor.size(); ++k) {
    if (robot.torque_sensor[k]) joints.push_back(static_cast<int>(k));
  }
  return joints;
}

/// A motion with names, and with room for the frames.
TrueMotion EmptyMotion(const ErrorModel& model, const Motion& motion) {
  TrueMotion result;
  for (const Marker& marker : model.markers) result.marker_names.push_back(marker.name);
  for (int k : model.tree.coordinate_joint) result.joint_names.push_back(model.tree.joints[k].name);
  const auto frames = static_cast<Eigen::Index>(std::lround(motion.duration_s() * result.rate_hz));
  result.markers.resize(frames, 3 * model.marker_count());
  result.encoders.resize(frames, model.tree.coordinate_count());
  result.torques.resize(frames, model.tree.coordinate_count());
  return result;
}

/// Draws the value of a parameter. `leg_joint` says whether it belongs to a joint of a leg.
double DrawValue(const Parameter& parameter, bool leg_joint, const TruthOptions& options,
                 SeriesRandom& random) {
  constexpr double kLeastForce = 2e-6, kMostForce = 9e-6;    // m/N
  constexpr double kLeastMoment = 2e-6, kMostMoment = 5e-5;  // rad/(N.m)
  const double scale = leg_joint ? options.leg_geometry_scale : options.upper_geometry_scale;
  switch (parameter.kind) {
    case ParameterKind::kWaistPose:
      return 0.0;
    case ParameterKind::kMarker:
      return random.own().Normal(options.marker_sd);
    case ParameterKind::kTorsion:
    case ParameterKind::kBending: {
      const bool slides = parameter.unit == ParameterUnit::kMetrePerNewton;
      const double least = slides      ? options.slide_stiffness_least
                           : leg_joint ? options.leg_stiffness_least
                                       : options.upper_stiffness_least;
      const double most = slides      ? options.slide_stiffness_most
                          : leg_joint ? options.leg_stiffness_most
                                      : options.upper_stiffness_most;
      return (leg_joint ? options.leg_elasticity_scale : options.upper_elasticity_scale) /
             (least * std::pow(most / least, random.Uniform(0.0, 1.0)));
    }
    case ParameterKind::kLegForce:
      return options.leg_elasticity_scale * random.Uniform(kLeastForce, kMostForce);
    case ParameterKind::kLegMoment:
      return options.leg_elasticity_scale * random.Uniform(kLeastMoment, kMostMoment);
    case ParameterKind::kTorqueBias:
      return random.Normal(options.torque_bias_sd);
    case ParameterKind::kTheta:
      if (parameter.unit == ParameterUnit::kMetre) break;
      return scale * random.Normal(leg_joint ? options.leg_offset_sd : options.upper_offset_sd);
    case ParameterKind::kRod:
    case ParameterKind::kMotorZero:
      return scale * random.Normal(parameter.typical);
    default:
      break;
  }
  return scale * random.Normal(parameter.unit == ParameterUnit::kRadian ? options.angle_sd
                                                                        : options.length_sd);
}

}  // namespace

Eigen::VectorXd DrawMatchedTruth(const ErrorModel& model, const std::vector<int>& identifiable,
                                 const std::vector<Leg>& legs, const TruthOptions& options) {
  SeriesRandom random(options.seed, options.series, "matched truth");
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(model.parameter_count());
  for (int i : identifiable) {
    const Parameter& parameter = model.parameters[i];
    const int joint =
        parameter.linkage < 0 ? parameter.joint : model.tree.linkages[parameter.linkage].joints[0];
    const bool leg_joint = joint >= 0 && InLeg(legs, joint);
    truth[i] = DrawValue(parameter, leg_joint, options, random);
  }
  return truth;
}

MatchedExperiment MatchExperiment(VirtualExperiment plan, const ErrorModel& model,
                                  const std::vector<int>& identifiable) {
  MatchedExperiment experiment{std::move(plan), model, {}};
  TrueRobot& robot = experiment.plan.robot;
  experiment.truth =
      DrawMatchedTruth(model, identifiable, robot.legs, experiment.plan.options.truth);
  robot =
      NominalRobot(experiment.plan.described_tree, model.markers, robot.legs, TorqueSensors(robot));
  const Geometry geometry = ApplyErrors(model, experiment.truth);
  for (LegCompliance& leg : experiment.plan.legs) {
    const int own = SupportingLeg(model, {leg.foot_link});
    const Vector6d compliance = own < 0 ? Vector6d(Vector6d::Zero()) : geometry.leg_compliance[own];
    leg.compliance.C_foot = compliance.asDiagonal();
    leg.compliance.stiffness = compliance.cwiseInverse();
  }
  return experiment;
}

TrueMotion PlayMatchedMotion(const MatchedExperiment& experiment, std::size_t index) {
  const ErrorModel& model = experiment.model;
  const PlannedTrial& trial = experiment.plan.trials[index];
  const Geometry geometry = ApplyErrors(model, experiment.truth);
  const std::vector<int> sensors = TorqueSensors(experiment.plan.robot);
  const int leg = SupportingLeg(model, trial.support);
  const int first_foot = trial.support.empty() ? 0 : trial.support[0];
  const Transform T_camera_foot = FootPose(experiment, index, first_foot);
  TrueMotion motion = EmptyMotion(model, trial.motion);
  Eigen::VectorXd last;
  StandingPose pose;
  for (int i = 0; i < motion.frame_count(); ++i) {
    InterruptionPoint();
    const Eigen::VectorXd q = PostureAt(trial.motion, i / motion.rate_hz);
    if (i == 0 || q != last) {
      const std::vector<Transform> T_waist_link = LinkTransforms(model.tree, q);
      const Transform T_camera_waist = T_camera_foot * T_waist_link[first_foot].inverse();
      pose = leg >= 0 ? StandOnLeg(model, geometry, q, leg, T_camera_foot, kGravity, sensors)
                      : HoldWaist(model, geometry, q, T_camera_waist, kGravity, sensors);
      last = q;
      for (std::size_t s = 0; i == 0 && s < trial.support.size(); ++s) {
        motion.T_camera_foot.push_back(T_camera_waist * T_waist_link[trial.support[s]]);
      }
    }
    motion.markers.row(i) = pose.markers.reshaped().transpose();
    motion.encoders.row(i) = q.transpose();
    motion.torques.row(i) = pose.torques(model.tree.coordinate_joint).transpose();
    motion.T_camera_waist.push_back(pose.T_ref_waist);
  }
  return motion;
}

SimulatedTrial RunMatchedTrial(const MatchedExperiment& experiment, std::size_t index) {
  SimulatedTrial result;
  result.motion = PlayMatchedMotion(experiment, index);
  result.raw =
      Measure(experiment.plan.robot, experiment.plan.clusters, experiment.plan.trials, index,
              result.motion, experiment.plan.options.sensors, experiment.plan.options.faults);
  return result;
}

WaistGive LargestMatchedDeflection(const MatchedExperiment& experiment, std::size_t index,
                                   const TrueMotion& motion) {
  const PlannedTrial& trial = experiment.plan.trials[index];
  const int leg = SupportingLeg(experiment.model, trial.support);
  if (leg < 0) return {};
  const Geometry geometry = ApplyErrors(experiment.model, experiment.truth);
  return LargestWaistGive(motion, RestFrames(trial.motion, motion),
                          [&](const Eigen::VectorXd& encoders) {
                            return PlaceLeg(experiment.model, geometry, encoders, leg).T_foot_waist;
                          });
}

}  // namespace elastocal
