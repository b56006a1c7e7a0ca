// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "elastocal/math/random.hpp"
#include "elastocal/measurement/marked_robot.hpp"
#include "elastocal/measurement/trial.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {

/// The leg with its markers and one marker on the waist.
inline MarkedRobot MarkedTalosLeg() {
  MarkedRobot robot;
  robot.tree = TalosLeg();
  robot.markers = TalosLegModel().markers;
  robot.markers.push_back({"WAIST", 0, {0.1, 0.2, 0.0}});
  robot.q_not_logged.setZero(6);
  return robot;
}

/// Options for playing a trial in tests, with kinematics, clocks and noise. The virtual experiment,
/// which uses another engine, tests the rest.
struct PlayOptions {
  int postures = 24;  ///< random, within the share `range` of the limits
  double range = 0.5;
  double move_s = 3.5;  ///< duration of a minimum-jerk motion
  double rest_s = 1.5;
  double lag_s = 0.0;  ///< robot time = (1 + 1e-6 drift_ppm) camera time - lag_s
  double drift_ppm = 0.0;
  double frame_rate_hz = 100.0;
  double log_rate_hz = 200.0;
  double marker_sd = 0.2e-3;    ///< m, noise of a coordinate
  double torque_sd = 0.1;       ///< N.m
  int standing = 0;             ///< the link that does not move
  bool one_by_one = false;      ///< joints move one after the other, the last ones first
  bool there_and_back = false;  ///< every other posture is the first one
  std::uint64_t seed = 1;
};

/// A played trial and its true values.
struct ScriptedTrial {
  MarkerTrajectories markers;
  JointLog log;
  Eigen::MatrixXd q;             ///< held postures x coordinates
  Eigen::VectorXd rest_begin_s;  ///< by the cameras' clock
};

/// Torques may be any smooth function of the posture.
inline Eigen::VectorXd PlayedTorques(const RobotTree& tree, const Eigen::VectorXd& q) {
  Eigen::VectorXd torques(static_cast<Eigen::Index>(tree.joints.size()));
  for (Eigen::Index k = 0; k < torques.size(); ++k) {
    const double before = k > 0 ? JointPosition(tree.joints[k - 1], q) : 0.0;
    torques[k] = 10.0 + 30.0 * std::sin(JointPosition(tree.joints[k], q)) + 8.0 * before;
  }
  return torques;
}

/// Positions of all markers in the cameras' frame, as one vector.
inline Eigen::VectorXd PlayedPositions(const MarkedRobot& robot, int standing,
                                       const Eigen::VectorXd& q) {
  const Transform T_camera_standing = FromXyzRpy({1.2, -0.7, 0.05}, {0.0, 0.0, 2.1});
  const std::vector<Transform> T_root_link = LinkTransforms(robot.tree, q);
  const Transform T_camera_root = T_camera_standing * T_root_link[standing].inverse();
  Eigen::VectorXd positions(3 * static_cast<Eigen::Index>(robot.markers.size()));
  for (std::size_t m = 0; m < robot.markers.size(); ++m) {
    const Marker& marker = robot.markers[m];
    positions.segment<3>(3 * static_cast<Eigen::Index>(m)) =
        T_camera_root * (T_root_link[marker.link] * marker.p_link_marker);
  }
  return positions;
}

/// A trajectory over random postures: `At` gives the posture at a camera time.
class PlayedMotion {
 public:
  PlayedMotion(const RobotTree& tree, const PlayOptions& options) : options_(options) {
    Random random(options.seed);
    postures_.resize(options.postures, tree.coordinate_count());
    for (Eigen::Index i = 0; i < postures_.rows(); ++i) {
      for (Eigen::Index c = 0; c < postures_.cols(); ++c) {
        const JointLimits& limits = tree.joints[tree.coordinate_joint[c]].limits;
        const double middle = 0.5 * (limits.lower + limits.upper);
        const double half = 0.5 * options.range * (limits.upper - limits.lower);
        postures_(i, c) = random.Uniform(middle - half, middle + half);
        const auto turn = postures_.cols() * i / postures_.rows();
        const bool waits = options.one_by_one && turn + c != postures_.cols() - 1;
        if (waits) postures_(i, c) = i == 0 ? middle : postures_(i - 1, c);
      }
      if (options.there_and_back && i % 2 == 0) postures_.row(i) = postures_.row(0).eval();
    }
  }

  double RestBegin(Eigen::Index posture) const {
    return static_cast<double>(posture) * (options_.rest_s + options_.move_s);
  }
  double Duration() const { return RestBegin(postures_.rows() - 1) + options_.rest_s; }
  const Eigen::MatrixXd& postures() const { return postures_; }

  Eigen::VectorXd At(double time_s) const {
    const double period = options_.rest_s + options_.move_s;
    const auto last = postures_.rows() - 1;
    const auto i = std::clamp<Eigen::Index>(static_cast<Eigen::Index>(time_s / period), 0, last);
    const double since = time_s - RestBegin(i) - options_.rest_s;
    if (i == last || since <= 0.0) return postures_.row(i);
    const double u = since / options_.move_s;
    const double part = u * u * u * (10.0 + u * (-15.0 + 6.0 * u));
    return postures_.row(i) + part * (postures_.row(i + 1) - postures_.row(i));
  }

 private:
  PlayOptions options_;
  Eigen::MatrixXd postures_;
};

inline MarkerTrajectories PlayMarkers(const MarkedRobot& robot, const PlayedMotion& motion,
                                      const PlayOptions& options) {
  Random random(options.seed + 1);
  MarkerTrajectories markers;
  markers.source = "played.tsv";
  for (const Marker& marker : robot.markers) markers.names.push_back(marker.name);
  markers.rate_hz = options.frame_rate_hz;
  const auto frames = static_cast<Eigen::Index>(motion.Duration() * options.frame_rate_hz);
  markers.positions.resize(frames, 3 * static_cast<Eigen::Index>(robot.markers.size()));
  for (Eigen::Index i = 0; i < frames; ++i) {
    const Eigen::VectorXd q = motion.At(static_cast<double>(i) / options.frame_rate_hz);
    const Eigen::VectorXd positions = PlayedPositions(robot, options.standing, q);
    markers.positions.row(i) = positions + random.NormalVector(positions.size(), options.marker_sd);
  }
  return markers;
}

/// A log of the duration of the cameras' recording, of all joints that follow no other.
inline JointLog PlayLog(const MarkedRobot& robot, const PlayedMotion& motion,
                        const PlayOptions& options) {
  Random random(options.seed + 2);
  const RobotTree& tree = robot.tree;
  JointLog log;
  log.source = "played.csv";
  for (int joint : tree.coordinate_joint) log.names.push_back(tree.joints[joint].name);
  const double begin = -options.lag_s;
  const auto samples = static_cast<Eigen::Index>(motion.Duration() * options.log_rate_hz);
  log.time_s.resize(samples);
  log.positions.resize(samples, tree.coordinate_count());
  log.torques.resize(samples, tree.coordinate_count());
  for (Eigen::Index i = 0; i < samples; ++i) {
    log.time_s[i] = begin + static_cast<double>(i) / options.log_rate_hz;
    const double camera_s = (log.time_s[i] + options.lag_s) / (1.0 + 1e-6 * options.drift_ppm);
    const Eigen::VectorXd q = motion.At(camera_s);
    log.positions.row(i) = q;
    const Eigen::VectorXd torques = PlayedTorques(tree, q)(tree.coordinate_joint);
    log.torques.row(i) = torques + random.NormalVector(torques.size(), options.torque_sd);
  }
  return log;
}

inline ScriptedTrial Play(const MarkedRobot& robot, const PlayOptions& options) {
  const PlayedMotion motion(robot.tree, options);
  ScriptedTrial trial;
  trial.markers = PlayMarkers(robot, motion, options);
  trial.log = PlayLog(robot, motion, options);
  trial.q = motion.postures();
  const Eigen::Index count = trial.q.rows();
  trial.rest_begin_s.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) trial.rest_begin_s[i] = motion.RestBegin(i);
  return trial;
}

/// Hides a marker in some frames.
inline void Hide(MarkerTrajectories& markers, int marker, Eigen::Index begin, Eigen::Index count) {
  markers.positions.block(begin, 3 * marker, count, 3)
      .setConstant(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace elastocal
