// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numeric>
#include <vector>

#include "elastocal/measurement/trial_samples.hpp"
#include "tests/test_robots.hpp"
#include "tests/trial_player.hpp"

namespace elastocal {

/// The leg of TALOS with its nine markers and a cluster on the waist.
inline MarkedRobot WaistAndLeg() {
  MarkedRobot robot;
  robot.tree = TalosLeg();
  robot.markers = {{"WAIST_1", 0, {-0.16, 0.07, -0.02}},
                   {"WAIST_2", 0, {-0.16, -0.065, -0.035}},
                   {"WAIST_3", 0, {-0.16, 0.01, -0.11}}};
  const std::vector<Marker> leg = TalosLegModel().markers;
  robot.markers.insert(robot.markers.end(), leg.begin(), leg.end());
  robot.clusters = {
      {"WAIST", {0, 1, 2}}, {"THIGH", {3, 4, 5}}, {"SHANK", {6, 7, 8}}, {"FOOT", {9, 10, 11}}};
  robot.torque_sensors = {0, 1, 2, 3, 4, 5};
  robot.q_not_logged.setZero(6);
  return robot;
}

inline constexpr int kFoot = 6;  // link

inline std::vector<int> AllMarkers(const MarkedRobot& robot) {
  std::vector<int> markers(robot.markers.size());
  std::iota(markers.begin(), markers.end(), 0);
  return markers;
}

inline Trial Standing(TrialKind kind = TrialKind::kCalibration) {
  return {.name = "stand", .kind = kind, .chains = {"leg"}, .support = {kFoot}};
}

inline TrialSamples Sample(const ScriptedTrial& played, const MeasurementOptions& options = {},
                           const Trial& trial = Standing()) {
  const MarkedRobot robot = WaistAndLeg();
  return SampleTrial(robot, trial, AllMarkers(robot), played.markers, played.log, options);
}

inline ScriptedTrial PlayStanding(PlayOptions options = {}) {
  options.standing = kFoot;
  return Play(WaistAndLeg(), options);
}

}  // namespace elastocal
