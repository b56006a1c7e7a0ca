// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/faults.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

std::string Millimetres(double metres) {
  return std::to_string(static_cast<int>(std::lround(1e3 * metres))) + " mm";
}

template <typename Names>
void Expect(const Names& names, const std::string& name, const std::string& what) {
  if (name.empty() || std::find(names.begin(), names.end(), name) != names.end()) return;
  throw InputError("fault: there is no " + what + " '" + name + "'" + DidYouMean(name, names));
}

bool InTrial(const Faults& faults, const PlannedTrial& trial) {
  return faults.trial.empty() || faults.trial == trial.name;
}

Eigen::Index Find(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) - names.begin();
}

/// Axes fixed to three markers.
Eigen::Matrix3d ClusterAxes(const Eigen::MatrixXd& positions, Eigen::Index frame,
                            const std::vector<int>& markers) {
  const auto at = [&](std::size_t i) -> Eigen::Vector3d {
    return positions.row(frame).segment<3>(3 * markers[i]).transpose();
  };
  const Eigen::Vector3d x = (at(1) - at(0)).normalized();
  const Eigen::Vector3d z = x.cross(Eigen::Vector3d(at(2) - at(0))).normalized();
  Eigen::Matrix3d R;
  R << x, z.cross(x), z;
  return R;
}

/// First frame of a knock in trial `index`; past the end if there is none.
Eigen::Index KnockFrame(const Faults& faults, const std::vector<PlannedTrial>& trials,
                        std::size_t index, Eigen::Index frames) {
  if (faults.trial.empty() || faults.trial == trials[index].name) return frames / 2;
  for (std::size_t before = 0; before < index; ++before) {
    if (trials[before].name == faults.trial) return 0;
  }
  return frames;
}

void Knock(const Faults& faults, const std::vector<NamedCluster>& clusters,
           const std::vector<PlannedTrial>& trials, std::size_t index, const TrueMotion& motion,
           Eigen::MatrixXd& positions, std::vector<std::string>& said) {
  for (const NamedCluster& cluster : clusters) {
    if (cluster.name != faults.knocked_cluster) continue;
    const Eigen::Index first = KnockFrame(faults, trials, index, positions.rows());
    if (first == positions.rows()) continue;
    for (Eigen::Index i = first; i < positions.rows(); ++i) {
      // The push is along the first side of the cluster.
      const Eigen::Vector3d push =
          faults.knock * ClusterAxes(motion.markers, i, cluster.markers).col(0);
      for (int m : cluster.markers) positions.row(i).segment<3>(3 * m) += push.transpose();
    }
    said.push_back("cluster " + cluster.name + " knocked by " + Millimetres(faults.knock) +
                   " from frame " + std::to_string(first + 1) + " on");
  }
}

/// Time at which the n-th move of a motion (from 1) ends; infinite if there is no such move.
double MoveEnd(const Motion& motion, int n) {
  double time_s = 0.0;
  for (const MotionSegment& segment : motion.segments) {
    time_s += segment.duration_s;
    const bool move = segment.coordinate < 0 && segment.from != segment.to;
    if (move && --n == 0) return time_s;
  }
  return std::numeric_limits<double>::infinity();
}

/// Moves the whole robot aside, from shortly before the end of one move until shortly before the
/// end of the next.
void Slip(const Faults& faults, const PlannedTrial& trial, const TrueMotion& motion,
          Eigen::MatrixXd& positions, std::vector<std::string>& said) {
  constexpr double kBefore = 1.0;  // s before the end of the move, when the foot slides
  if (faults.slipped_posture < 1 || !InTrial(faults, trial)) return;
  const double from = MoveEnd(trial.motion, faults.slipped_posture) - kBefore;
  const double to = MoveEnd(trial.motion, faults.slipped_posture + 1) - kBefore;
  for (Eigen::Index i = 0; i < positions.rows(); ++i) {
    const double time_s = static_cast<double>(i) / motion.rate_hz;
    if (time_s < from || time_s >= to) continue;
    for (Eigen::Index m = 0; m < positions.cols() / 3; ++m) positions(i, 3 * m) += faults.slip;
  }
  if (std::isfinite(from)) {
    said.push_back("foot slipped by " + Millimetres(faults.slip) + " in posture " +
                   std::to_string(faults.slipped_posture));
  }
}

}  // namespace

void PushMarkers(const Faults& faults, const std::vector<NamedCluster>& clusters,
                 const std::vector<PlannedTrial>& trials, std::size_t index,
                 const TrueMotion& motion, Eigen::MatrixXd& positions,
                 std::vector<std::string>& said) {
  Knock(faults, clusters, trials, index, motion, positions, said);
  Slip(faults, trials[index], motion, positions, said);
}

void LoseMarkers(const Faults& faults, const std::vector<PlannedTrial>& trials, std::size_t index,
                 const std::vector<std::string>& names, double rate_hz, Random& random,
                 Eigen::MatrixXd& positions, std::vector<std::string>& said) {
  const Eigen::Index frames = positions.rows();
  if (!faults.swapped_marker_a.empty() && InTrial(faults, trials[index])) {
    const Eigen::Index a = 3 * Find(names, faults.swapped_marker_a);
    const Eigen::Index b = 3 * Find(names, faults.swapped_marker_b);
    const Eigen::Index first = frames / 3;
    const Eigen::Index count =
        std::min(frames - first, static_cast<Eigen::Index>(faults.swap_s * rate_hz));
    const Eigen::MatrixXd kept = positions.block(first, a, count, 3);
    positions.block(first, a, count, 3) = positions.block(first, b, count, 3).eval();
    positions.block(first, b, count, 3) = kept;
    said.push_back("labels " + faults.swapped_marker_a + " and " + faults.swapped_marker_b +
                   " swapped in frames " + std::to_string(first + 1) + " to " +
                   std::to_string(first + count));
  }
  if (!faults.lost_marker.empty()) {
    const Eigen::Index m = 3 * Find(names, faults.lost_marker);
    positions.block(frames / 2, m, frames - frames / 2, 3).setConstant(kNaN);
    said.push_back("marker " + faults.lost_marker + " lost in the second half");
  }
  if (faults.missing_share > 0.0) {
    for (Eigen::Index i = 0; i < frames; ++i) {
      for (Eigen::Index m = 0; m < positions.cols(); m += 3) {
        const bool missing = random.Uniform(0.0, 1.0) < faults.missing_share;
        if (missing) positions.row(i).segment<3>(m).setConstant(kNaN);
      }
    }
    said.push_back(std::to_string(100.0 * faults.missing_share) + " % of the samples missing");
  }
}

void SpoilLog(const Faults& faults, const std::vector<PlannedTrial>& trials, std::size_t index,
              JointLog& log, std::vector<std::string>& said) {
  if (!faults.dead_torque_sensor.empty()) {
    log.torques.col(Find(log.names, faults.dead_torque_sensor)).setZero();
    said.push_back("torque sensor of " + faults.dead_torque_sensor + " dead");
  }
  if (!faults.saturated_torque_sensor.empty()) {
    auto column = log.torques.col(Find(log.names, faults.saturated_torque_sensor));
    column = column.cwiseMin(faults.saturation).cwiseMax(-faults.saturation).eval();
    said.push_back("torque sensor of " + faults.saturated_torque_sensor + " saturated");
  }
  if (faults.log_cut_s > 0.0 && InTrial(faults, trials[index])) {
    const double end = log.time_s[log.time_s.size() - 1] - faults.log_cut_s;
    Eigen::Index rows = 1;
    while (rows < log.time_s.size() && log.time_s[rows] <= end) ++rows;
    log.time_s.conservativeResize(rows);
    log.positions.conservativeResize(rows, Eigen::NoChange);
    log.torques.conservativeResize(rows, Eigen::NoChange);
    said.emplace_back("joint log ends early");
  }
}

void CheckFaults(const Faults& faults, const TrueRobot& robot,
                 const std::vector<NamedCluster>& clusters,
                 const std::vector<PlannedTrial>& trials) {
  std::vector<std::string> marker_names, sensors, cluster_names, trial_names;
  for (const Marker& marker : robot.markers) marker_names.push_back(marker.name);
  for (const PlannedTrial& trial : trials) trial_names.push_back(trial.name);
  for (std::size_t k = 0; k < robot.tree.joints.size(); ++k) {
    if (robot.torque_sensor[k]) sensors.push_back(robot.tree.joints[k].name);
  }
  for (const NamedCluster& cluster : clusters) {
    if (cluster.markers.size() >= 3) cluster_names.push_back(cluster.name);
  }
  Expect(marker_names, faults.lost_marker, "marker");
  Expect(marker_names, faults.swapped_marker_a, "marker");
  Expect(marker_names, faults.swapped_marker_b, "marker");
  if (faults.swapped_marker_a.empty() != faults.swapped_marker_b.empty()) {
    throw InputError("fault: labels are swapped between two markers; found one");
  }
  Expect(cluster_names, faults.knocked_cluster, "cluster of three markers");
  Expect(sensors, faults.dead_torque_sensor, "torque sensor on a joint");
  Expect(sensors, faults.saturated_torque_sensor, "torque sensor on a joint");
  Expect(trial_names, faults.trial, "trial");
}

}  // namespace elastocal
