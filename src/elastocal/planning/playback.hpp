// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/math/transform.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A hand or foot while a robot executes a motion.
struct PlaybackTip {
  int link = 0;
  bool is_foot = false;
  /// By picture: how far it is from where the plan has it, seen from the first foot that the plan
  /// has on the floor, m. NaN while a foot stands.
  std::vector<double> distance_m = {};
};

/// A robot that executes a motion, in pictures, beside the plan. All poses are in one frame (z up):
/// the first foot begins where it is in the zero posture, on the ground under the root link.
struct Playback {
  std::vector<double> time_s;          ///< of each picture, since the beginning
  std::vector<Eigen::VectorXd> q;      ///< what the plan has then, by coordinate, rad or m
  std::vector<Transform> T_plan_root;  ///< where the plan has the root link
  std::vector<int> links;              ///< those that move by themselves, the tips and the soles
  /// For each picture and link, from the plan's pose to the robot's: displacement of the origin, m,
  /// then rotation vector, rad, |.| <= pi; both in the axes of the common frame.
  std::vector<Eigen::Matrix<double, 6, Eigen::Dynamic>> displacement;
  std::vector<PlaybackTip> tips;
};

/// Takes the pictures of one robot.
class PlaybackRecorder {
 public:
  /// `tips`: hands and feet, without distances yet. Keeps a reference to the nominal tree.
  PlaybackRecorder(const RobotTree& tree, std::vector<PlaybackTip> tips);

  /// Adds a picture. `q`: the planned posture, with T_root_link of the plan's links; `support`: the
  /// planned feet on the floor, one or more; T_world_link: where the robot has its links.
  void Add(double time_s, const Eigen::VectorXd& q, const std::vector<Transform>& T_root_link,
           const std::vector<int>& support, const std::vector<Transform>& T_world_link);

  const Playback& playback() const { return playback_; }

 private:
  Transform PlanRoot(const std::vector<Transform>& T_root_link, int foot,
                     const std::vector<Transform>& T_world_link);
  void AddDistances(const std::vector<Transform>& T_root_link, const std::vector<int>& support,
                    const std::vector<Transform>& T_world_link);

  const RobotTree& tree_;
  Playback playback_;
  int foot_ = -1;           ///< the first on the floor, last time
  Transform T_plan_foot_;   ///< where the plan has it
  Transform T_plan_world_;  ///< from the simulator's world to the common frame
};

/// What `as` says of a playback.
struct NamedPlayback {
  std::string as;
  bool stabilised = false;
  const Playback* playback = nullptr;
};

/// The playbacks of robots that execute one plan, as JSON (docs/formats.md): numbers in 0.1 mm and
/// 0.1 mrad, a byte for what has changed from picture to picture, deflated.
std::string FormatPlaybacks(const RobotTree& tree, const std::vector<NamedPlayback>& robots);

}  // namespace elastocal
