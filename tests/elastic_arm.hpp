// SPDX-License-Identifier: Apache-2.0
// A small robot for tests of the run-time library alone: an elastic arm of six joints.
#pragma once

#include <cmath>
#include <string>

#include "elastocal/runtime/core_poses.h"
#include "elastocal/runtime/runtime_model.hpp"

namespace elastocal {

/// A pose that is turned about x.
inline ec_pose TurnedAboutX(double angle, double x, double z) {
  ec_pose pose;
  ec_identity(&pose);
  pose.R[4] = pose.R[8] = std::cos(angle);
  pose.R[7] = std::sin(angle);
  pose.R[5] = -pose.R[7];
  pose.p[0] = x;
  pose.p[2] = z;
  return pose;
}

/// An arm of six joints and 3 kg a link, whose zeros are off by 5 mrad. Compliances in rad/(N.m).
inline RuntimeModel ElasticArm(double compliance = 1e-4) {
  constexpr double kQuarter = 0.5 * M_PI, kLimit = 3.0;
  const double turn[6] = {0.0, kQuarter, 0.0, kQuarter, -kQuarter, kQuarter};
  const double x[6] = {0.0, 0.3, 0.3, 0.05, 0.05, 0.05};
  const double z[6] = {0.3, 0.05, 0.05, 0.3, 0.05, 0.05};
  RuntimeModel model;
  model.robot = "arm";
  model.calibration = "drawn";
  model.fingerprint = "none";
  for (int k = 0; k < 6; ++k) {
    ec_joint joint{};
    joint.parent = joint.coordinate = k;
    joint.multiplier = 1.0;
    joint.twisted = TurnedAboutX(turn[k], x[k], z[k]);
    ec_identity(&joint.body);
    model.nominal.push_back(joint);
    joint.theta = k % 2 != 0 ? 5e-3 : -5e-3;
    for (double& value : joint.compliance) value = compliance;
    model.calibrated.push_back(joint);
    model.joint_names.push_back("joint" + std::to_string(k));
    model.lower.push_back(-kLimit);
    model.upper.push_back(kLimit);
  }
  model.coordinate_names = model.joint_names;
  model.mass.assign(7, 3.0);
  model.moment.assign(21, 0.0);
  for (std::size_t body = 1; body < 7; ++body) model.moment[3 * body] = 3.0 * 0.15;
  model.leg_of_body.assign(7, -1);
  ec_tip tip{};
  tip.frame = {6, TurnedAboutX(0.0, 0.0, 0.1)};
  tip.foot = -1;
  model.tips = {tip};
  model.tip_names = {"arm"};
  model.links = {tip.frame};
  model.link_names = {"hand"};
  return model;
}

}  // namespace elastocal
