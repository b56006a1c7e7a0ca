// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/simulation/standing_pose.hpp"
#include "elastocal/simulation/virtual_experiment.hpp"

namespace elastocal {

/// A virtual experiment whose truth has the form of the estimator's own error model. Motions and
/// sensors are the same, but the robot stands quasi-statically and has errors in the model's
/// parameters only. It shows that the estimator finds what it models, to the last digits. It says
/// nothing about what the estimator does not model (masses, friction, dynamics, how two legs share
/// the load).
struct MatchedExperiment {
  VirtualExperiment plan;  ///< its robot is nominal; only its sensors are used
  ErrorModel model;
  Eigen::VectorXd truth;  ///< errors, one for each parameter of `model`, SI
};

/// Draws errors for the `identifiable` parameters of a model. All others are zero, and so is T0,
/// because the waist has its own pose in every posture. The options give the sizes of joint
/// offsets, lengths and angles, markers, joint springs (bending like torsion) and torque biases.
/// Lumped compliances of legs are uniform between those of stiff and soft legs, 2e-6 to 9e-6 m/N
/// and 2e-6 to 5e-5 rad/(N.m), times the legs' elasticity scale.
Eigen::VectorXd DrawMatchedTruth(const ErrorModel& model, const std::vector<int>& identifiable,
                                 const std::vector<Leg>& legs, const TruthOptions& options);

/// Replaces the robot of an experiment by the model with its errors.
MatchedExperiment MatchExperiment(VirtualExperiment plan, const ErrorModel& model,
                                  const std::vector<int>& identifiable);

/// Plays a motion quasi-statically; encoders follow the commands exactly. If the robot stands on
/// one leg of the model, the foot is where the experiment puts it. Otherwise the waist is where the
/// nominal robot has it above its first foot (without feet, where the experiment puts it).
TrueMotion PlayMatchedMotion(const MatchedExperiment& experiment, std::size_t index);

/// Plays and measures a trial, like RunTrial.
SimulatedTrial RunMatchedTrial(const MatchedExperiment& experiment, std::size_t index);

/// Like LargestWaistDeflection, but against the model without compliances. Zero if the robot does
/// not stand on a leg of the model.
WaistGive LargestMatchedDeflection(const MatchedExperiment& experiment, std::size_t index,
                                   const TrueMotion& motion);

}  // namespace elastocal
