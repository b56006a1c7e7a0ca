// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "elastocal/posture/chain_problem.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {

// A small problem for the tests of this layer: a leg of four joints with a foot and six markers.

inline RobotTree MakeLegRobot() {
  RobotTree tree = MakeRoot();
  const int yaw = AddJoint(tree, "hip_yaw", 0, Offset(0.0, 0.1, -0.1), {0, 0, 1});
  const int roll = AddJoint(tree, "hip_roll", yaw, Offset(0, 0, 0), {1, 0, 0});
  const int pitch = AddJoint(tree, "hip_pitch", roll, Offset(0, 0, 0), {0, 1, 0});
  const int knee = AddJoint(tree, "knee", pitch, Offset(0, 0, -0.4), {0, 1, 0});
  AddFixedLink(tree, "foot", knee, Offset(0, 0, -0.4));
  for (Link& link : tree.links) {
    link.mass = 3.0;
    link.com = Eigen::Vector3d(0.01, 0.02, -0.1);
  }
  for (Joint& joint : tree.joints) joint.limits.effort = 60.0;
  tree.joints[3].limits.lower = 0.0;
  tree.joints[3].limits.upper = 2.0;
  return tree;
}

inline std::vector<Marker> LegMarkers(const RobotTree& tree) {
  const int thigh = FindLink(tree, "hip_pitch_link");
  const int shank = FindLink(tree, "knee_link");
  return {{"T1", thigh, {0.08, 0.02, -0.1}},  {"T2", thigh, {0.05, 0.09, -0.25}},
          {"T3", thigh, {-0.03, 0.1, -0.2}},  {"S1", shank, {0.07, 0.01, -0.1}},
          {"S2", shank, {0.04, -0.05, -0.3}}, {"S3", shank, {0.01, 0.08, -0.35}}};
}

inline MotionSetup LegMotion(const RobotTree& tree) {
  MotionSetup motion;
  motion.rest = Eigen::Vector4d(0.0, 0.0, -0.5, 1.0);
  motion.lower = Eigen::Vector4d(-1.0, -1.0, -1.0, 0.0);
  motion.upper = Eigen::Vector4d(1.0, 1.0, 1.0, 2.0);
  motion.spheres = {{"PELVIS", 0, {0.0, -0.1, -0.3}, 0.1},
                    {"KNEE", FindLink(tree, "knee_link"), {0.0, 0.0, 0.0}, 0.06},
                    {"FOOT", FindLink(tree, "foot"), {0.0, 0.0, 0.0}, 0.07}};
  return motion;
}

inline ChainSetup LegSetup(const RobotTree& tree) {
  ChainSetup setup;
  setup.name = "leg";
  setup.tip_link = FindLink(tree, "foot");
  setup.coordinates = ChainCoordinates(tree, 0, setup.tip_link);
  setup.box = Box{{-0.5, -0.2, -0.95}, {0.5, 0.6, -0.4}};
  setup.largest_turn = M_PI / 3.0;
  setup.contacts = {{0, 1}, {0, 2}};
  setup.floor_z = -0.9;
  return setup;
}

/// The whole problem. It cannot be moved, because its parts refer to each other.
struct LegProblem {
  explicit LegProblem(Criterion criterion = Criterion::kO1, const Elasticity& elasticity = {})
      : model(MakeErrorModel(MakeLegRobot(), LegMarkers(MakeLegRobot()), {}, elasticity)),
        motion(LegMotion(model.tree)),
        setup(LegSetup(model.tree)),
        base(FindChainParameters(model, motion, setup, {})),
        problem(MakeChainProblem(model, base.kept, motion, setup, criterion)) {}
  LegProblem(const LegProblem&) = delete;
  LegProblem& operator=(const LegProblem&) = delete;

  ErrorModel model;
  MotionSetup motion;
  ChainSetup setup;
  BaseParameters base;
  PostureProblem problem;
};

}  // namespace elastocal
