#pragma once

#include <vector>

#include "elastocal/simulation/standing_pose.hpp"
#include "elastocal/simulation/virtual_experiment.hpp"

namespace elastocal {

/// A virtual experiment whose truth is the estimator's own error model: the same motions and
/// sensors, but a robot that stands quasi-statically and is wrong in the model's parameters only.
/// It shows that the estimator finds what it models, to the last digits; it says nothing of what it
/// does not model (masses, friction, dynamics, how two legs share the load).
struct MatchedExperiment {
  VirtualExperiment plan;  ///< its robot is as described: its sensors alone count
  ErrorModel model;
  Eigen::VectorXd truth;  ///< errors, one a parameter of `model`, SI
};

/// Errors for the `identifiable` parameters of a model, zero for all others and for the waist,
/// which has a pose in every posture. Sizes as in the options, as far as the model has the like:
/// joint offsets, lengths and angles, markers, joint springs (bending as torsion), torque biases.
/// Lumped compliances of legs uniform between those of stiff and soft legs, 2e-6 to 9e-6 m/N and
/// 2e-6 to 5e-5 rad/(N.m), times the legs' elasticity scale.
Eigen::VectorXd DrawMatchedTruth(const ErrorModel& model, const std::vector<int>& identifiable,
                                 const std::vector<Leg>& legs, const TruthOptions& options);

/// Puts the model with its errors in the place of an experiment's robot.
MatchedExperiment MatchExperiment(VirtualExperiment plan, const ErrorModel& model,
                                  const std::vector<int>& identifiable);

/// Plays a motion, at rest at every instant. Encoders follow exactly. On one leg of the model the
/// foot is where the experiment puts it; otherwise the waist is where the nominal robot has it
/// above its first foot (without feet: as the experiment puts it).
TrueMotion PlayMatchedMotion(const MatchedExperiment& experiment, std::size_t index);

/// Plays and measures a trial, like RunTrial.
SimulatedTrial RunMatchedTrial(const MatchedExperiment& experiment, std::size_t index);

/// Like LargestWaistDeflection, against the model without compliances; zero without a leg of the
/// model.
WaistGive LargestMatchedDeflection(const MatchedExperiment& experiment, std::size_t index,
                                   const TrueMotion& motion);

}  // namespace elastocal
