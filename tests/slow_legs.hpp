// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "elastocal/math/random.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "tests/standing_humanoid.hpp"

namespace elastocal {

/// A humanoid on one leg, then on the other. On each, it has 16 rests, and then moves slowly from
/// rest to rest, with ten moments recorded on each way. Model errors displace and turn all but the
/// standing foot. They are drawn for each rest, and are a first-order process in time along the
/// ways.
struct SlowLegs {
  StandingHumanoid robot{16};
  Eigen::VectorXd truth = robot.DrawTruth(3);

  SlowLegs() {
    for (const std::size_t leg : {3u, 4u}) {
      PlayedTrial slow = robot.trials[leg];
      const Eigen::MatrixXd& rests = robot.trials[leg].q;
      slow.trial.name += "_slow";
      slow.trial.moments = true;
      slow.q.resize(10 * (rests.rows() - 1), rests.cols());
      for (Eigen::Index i = 0; i < slow.q.rows(); ++i) {
        const double way = static_cast<double>(i % 10) / 10.0;
        slow.q.row(i) = (1.0 - way) * rests.row(i / 10) + way * rests.row(i / 10 + 1);
      }
      robot.trials.push_back(slow);
    }
  }

  Recording Record(std::uint64_t seed) const {
    Recording recording = robot.Record(
        truth, {.marker_sd = 5e-5, .torque_sensors = robot.project.torque_sensors, .seed = seed});
    recording.time_s = Eigen::VectorXd::LinSpaced(recording.posture_count(), 0.0,
                                                  (recording.posture_count() - 1) / kRate);
    Random random(seed);
    Vector6d error = random.NormalVector(6, kTied);  // m, rad
    for (int i = 0; i < recording.posture_count(); ++i) {
      const Trial& trial = recording.trials[recording.trial[i]];
      if (trial.support.size() != 1) continue;
      const double kept = trial.moments ? kKept : 0.0;
      error = kept * error + random.NormalVector(6, kTied * std::sqrt(1.0 - kept * kept));
      const int foot = robot.model.tree.links[trial.support.front()].body;
      const Eigen::Vector3d centre = recording.markers.block<1, 3>(i, 0).transpose();
      for (int m = 0; m < robot.model.marker_count(); ++m) {
        if (robot.model.tree.links[robot.model.markers[m].link].body == foot) continue;
        const Eigen::Vector3d at = recording.markers.block<1, 3>(i, 3 * m).transpose();
        recording.markers.block<1, 3>(i, 3 * m) +=
            (error.head<3>() + error.tail<3>().cross(at - centre)).transpose();
      }
    }
    return recording;
  }

  static constexpr double kTied = 0.3e-3;  // m, rad
  static constexpr double kRate = 10.0;    // Hz
  static constexpr double kKept = 0.95;    // of the error between successive moments
};

/// Records only the ways, of both legs. A model error (m) that hardly changes in a second displaces
/// each body but the standing foot. From some moment on, `push` displaces the cluster of the left
/// shank.
inline Recording RecordWays(const SlowLegs& legs, double of_body, const Eigen::Vector3d& push,
                            std::uint64_t seed) {
  constexpr double kKept = 0.99;
  constexpr int kPushed = 80;
  StandingHumanoid robot = legs.robot;
  robot.trials.erase(robot.trials.begin(), robot.trials.begin() + 5);
  Recording recording = robot.Record(
      legs.truth,
      {.marker_sd = 5e-5, .torque_sensors = robot.project.torque_sensors, .seed = seed});
  recording.time_s = Eigen::VectorXd::LinSpaced(recording.posture_count(), 0.0,
                                                (recording.posture_count() - 1) / SlowLegs::kRate);
  Random random(seed);
  const auto draw = [&](double sd) {
    Eigen::Matrix3Xd all(3, robot.model.tree.body_count());
    for (auto&& one : all.colwise()) one = random.NormalVector(3, sd);
    return all;
  };
  Eigen::Matrix3Xd error = draw(of_body);
  for (int i = 0; i < recording.posture_count(); ++i) {
    error = kKept * error + draw(of_body * std::sqrt(1.0 - kKept * kKept));
    const int trial = recording.trial[i];
    const int foot = robot.model.tree.links[recording.trials[trial].support.front()].body;
    for (int m = 0; m < robot.model.marker_count(); ++m) {
      const int body = robot.model.tree.links[robot.model.markers[m].link].body;
      if (body == foot) continue;
      recording.markers.block<1, 3>(i, 3 * m) += error.col(body).transpose();
      const bool pushed = i >= kPushed && robot.model.markers[m].name.starts_with("LSHANK");
      if (pushed) recording.markers.block<1, 3>(i, 3 * m) += push;
    }
  }
  return recording;
}

}  // namespace elastocal
