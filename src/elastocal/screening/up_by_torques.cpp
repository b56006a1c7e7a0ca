// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/up_by_torques.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "elastocal/math/decompositions.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kFewestTorqueSensors = 3;
constexpr Eigen::Index kFewestMeasured = 10;  // postures of a sensor that takes part
constexpr double kFarFromStated = 30.0 * M_PI / 180.0;
constexpr double kOppositeUp = 150.0 * M_PI / 180.0;
constexpr double kLeftOfStatedUp = 0.25;  // share of the squares
// Common factor of all sensors, or its inverse: beyond, it is another mistake.
constexpr double kMostTorqueFactor = 2.0;
constexpr double kCosineAlong = 0.94;  // cosine of 20 degrees

/// Torques of one sensor, and those that each component of the up direction would cause, without
/// the means.
struct TorquesByUp {
  Eigen::MatrixX3d by_up;  // N.m
  Eigen::VectorXd measured;
};

std::vector<TorquesByUp> TakeTorquesByUp(const ErrorModel& model, const Recording& recording,
                                         const Placement& placement) {
  const int count = recording.posture_count();
  const RobotTree& tree = model.tree;
  // By component: postures x coordinates.
  std::vector<Eigen::MatrixXd> of(3, Eigen::MatrixXd(count, tree.coordinate_count()));
  for (int i = 0; i < count; ++i) {
    const Eigen::Matrix3d R_waist_ref = placement.T_ref_waist[i].linear().transpose();
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d gravity_waist = -recording.gravity.norm() * R_waist_ref.col(axis);
      of[axis].row(i) =
          StaticTorques(tree, recording.q.row(i).transpose(), gravity_waist, 0).transpose();
    }
  }
  std::vector<TorquesByUp> sensors;
  for (Eigen::Index joint = 0; joint < recording.torques.cols(); ++joint) {
    std::vector<int> postures;
    for (int i = 0; i < count; ++i) {
      if (std::isfinite(recording.torques(i, joint))) postures.push_back(i);
    }
    if (std::ssize(postures) < kFewestMeasured) continue;
    TorquesByUp sensor{Eigen::MatrixX3d(std::ssize(postures), 3),
                       recording.torques(postures, joint)};
    const int coordinate = tree.joints[static_cast<std::size_t>(joint)].coordinate;
    for (int axis = 0; axis < 3; ++axis) sensor.by_up.col(axis) = of[axis](postures, coordinate);
    sensor.by_up.rowwise() -= sensor.by_up.colwise().mean().eval();
    sensor.measured.array() -= sensor.measured.mean();
    sensors.push_back(std::move(sensor));
  }
  return sensors;
}

TorquesByUp Together(const std::vector<TorquesByUp>& sensors) {
  Eigen::Index rows = 0;
  for (const TorquesByUp& one : sensors) rows += one.measured.size();
  TorquesByUp all{Eigen::MatrixX3d(rows, 3), Eigen::VectorXd(rows)};
  rows = 0;
  for (const TorquesByUp& one : sensors) {
    all.by_up.middleRows(rows, one.measured.size()) = one.by_up;
    all.measured.segment(rows, one.measured.size()) = one.measured;
    rows += one.measured.size();
  }
  return all;
}

bool IsHeldInAllTrials(const Recording& recording) {
  const auto held = [](const Trial& trial) { return trial.support.empty() && !trial.free_root; };
  return !recording.trials.empty() &&
         std::all_of(recording.trials.begin(), recording.trials.end(), held);
}

}  // namespace

std::optional<UpByTorques> FindUpByTorques(const ErrorModel& model, const Recording& recording,
                                           double slip_m) {
  const bool measured = recording.torques.rows() > 0 && TotalMass(model.tree) > 0.0;
  if (!measured || !IsHeldInAllTrials(recording)) return std::nullopt;
  const Placement placement = RegisterPlacement(model, recording, slip_m);
  if (placement.empty()) return std::nullopt;
  const std::vector<TorquesByUp> sensors = TakeTorquesByUp(model, recording, placement);
  if (sensors.size() < kFewestTorqueSensors) return std::nullopt;
  const TorquesByUp all = Together(sensors);
  const Eigen::Vector3d estimated = ShortestSolution(all.by_up, all.measured);
  const double factor = estimated.norm();
  if (!(factor < kMostTorqueFactor && factor * kMostTorqueFactor > 1.0)) return std::nullopt;
  const Eigen::Vector3d stated = -recording.gravity.normalized();
  const auto left = [&](const Eigen::Vector3d& up) {
    return std::sqrt((all.measured - all.by_up * up).squaredNorm() /
                     static_cast<double>(all.measured.size()));
  };
  UpByTorques found{.up = estimated / factor};
  found.angle = std::atan2(found.up.cross(stated).norm(), found.up.dot(stated));
  found.left = left(found.up);
  found.stated = left(stated);
  const bool another = found.angle > kFarFromStated && found.angle < kOppositeUp;
  if (!another || !(found.left * found.left < kLeftOfStatedUp * found.stated * found.stated)) {
    return std::nullopt;
  }
  return found;
}

std::string Describe(const UpByTorques& found) {
  Eigen::Index axis = 0;
  const double along = found.up.cwiseAbs().maxCoeff(&axis);
  char direction[80];
  if (along > kCosineAlong) {
    std::snprintf(direction, sizeof direction, "`up: %s%c`", found.up[axis] < 0.0 ? "-" : "",
                  "xyz"[axis]);
  } else {
    std::snprintf(direction, sizeof direction, "(%.2f, %.2f, %.2f) up", found.up.x(), found.up.y(),
                  found.up.z());
  }
  char text[300];
  std::snprintf(text, sizeof text,
                "`up` in experiment.yaml is wrong: the torque sensors are %.2g N.m off statics "
                "with it (root mean square, each one's mean apart), and %.2g N.m with %s",
                found.stated, found.left, direction);
  return text;
}

}  // namespace elastocal
