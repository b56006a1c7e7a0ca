// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/math/transform.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace elastocal {

/// A hand or foot of a robot that executes a motion.
struct PlaybackTip {
  int link = 0;
  bool is_foot = false;
  /// By picture: distance from its planned position, seen from the first foot that stands in the
  /// plan, m. NaN while a foot stands.
  std::vector<double> distance_m = {};
};

/// Pictures of a robot that executes a motion, with the plan. All poses are in one frame (z up): in
/// the plan the first foot begins at its pose of the zero posture, on the ground below the root
/// link.
struct Playback {
  std::vector<double> time_s;          ///< time of each picture since the beginning
  std::vector<Eigen::VectorXd> q;      ///< planned posture at that time, by coordinate, rad or m
  std::vector<Transform> T_plan_root;  ///< planned pose of the root link
  std::vector<int> links;              ///< links that joints move, the ends of limbs and the soles
  /// For each picture and link, deviation of the robot's pose from the plan's: displacement of the
  /// origin, m, then rotation vector, rad, |.| <= pi; both in the axes of the common frame.
  std::vector<Eigen::Matrix<double, 6, Eigen::Dynamic>> displacement;
  std::vector<PlaybackTip> tips;
};

/// Records the pictures of one robot.
class PlaybackRecorder {
 public:
  /// `tips` are hands and feet, without distances. Keeps a reference to the nominal tree.
  PlaybackRecorder(const RobotTree& tree, std::vector<PlaybackTip> tips);

  /// Adds a picture. `q` is the planned posture, with T_root_link of the plan's links; `support`
  /// are the planned feet on the floor, at least one; T_world_link are the poses of the robot's
  /// links.
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
  int foot_ = -1;           ///< first standing foot in the last picture
  Transform T_plan_foot_;   ///< its pose in the plan
  Transform T_plan_world_;  ///< transform from the simulator's world to the common frame
};

/// A playback with the robot's knowledge (`as`).
struct NamedPlayback {
  std::string as;
  bool stabilised = false;
  const Playback* playback = nullptr;
};

/// The playbacks of robots that execute one plan, as JSON (docs/formats.md): numbers in 0.1 mm and
/// 0.1 mrad, a byte for each change from picture to picture, deflated.
std::string FormatPlaybacks(const RobotTree& tree, const std::vector<NamedPlayback>& robots);

}  // namespace elastocal
