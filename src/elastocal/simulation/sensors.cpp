// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/sensors.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/simulation/faults.hpp"
#include "elastocal/simulation/stream_seed.hpp"

namespace elastocal {
namespace {

/// Calls `visit(first frame, last frame + 1)` for random events, `per_minute` of them, of
/// exponentially distributed length.
template <typename Visit>
void AtRandomTimes(double per_minute, double mean_s, double rate_hz, Eigen::Index frames,
                   Random& random, const Visit& visit) {
  if (per_minute <= 0.0 || mean_s <= 0.0) return;
  const auto exponential = [&](double mean) {
    return -mean * std::log(1.0 - random.Uniform(0.0, 1.0));
  };
  double time_s = exponential(60.0 / per_minute);
  while (time_s * rate_hz < static_cast<double>(frames)) {
    const double end_s = time_s + exponential(mean_s);
    const auto first = static_cast<Eigen::Index>(time_s * rate_hz);
    const auto last = std::min(frames, static_cast<Eigen::Index>(end_s * rate_hz) + 1);
    visit(first, last);
    time_s = end_s + exponential(60.0 / per_minute);
  }
}

void SwapLabels(const SensorOptions& options, const std::vector<NamedCluster>& clusters,
                double rate_hz, Random& random, Eigen::MatrixXd& positions) {
  for (const NamedCluster& cluster : clusters) {
    const auto count = static_cast<int>(cluster.markers.size());
    if (count < 2) continue;
    AtRandomTimes(options.swaps_per_minute, options.mean_swap_s, rate_hz, positions.rows(), random,
                  [&](Eigen::Index first, Eigen::Index last) {
                    const int a = random.Index(count);
                    const int b = (a + 1 + random.Index(count - 1)) % count;
                    const int column_a = 3 * cluster.markers[static_cast<std::size_t>(a)];
                    const int column_b = 3 * cluster.markers[static_cast<std::size_t>(b)];
                    positions.block(first, column_a, last - first, 3)
                        .swap(positions.block(first, column_b, last - first, 3));
                  });
  }
}

void AddNoise(const SensorOptions& options, Random& random, Eigen::MatrixXd& positions) {
  for (Eigen::Index i = 0; i < positions.rows(); ++i) {
    InterruptionPoint();
    for (Eigen::Index m = 0; m < positions.cols(); m += 3) {
      Eigen::Vector3d error = random.NormalVector(3, options.marker_noise_sd);
      if (random.Uniform(0.0, 1.0) < options.outlier_share) {
        error += random.Uniform(0.1, 1.0) * options.largest_outlier *
                 random.NormalVector(3, 1.0).normalized();
      }
      positions.row(i).segment<3>(m) += error.transpose();
    }
  }
}

/// Value of a sampled signal between its samples (Catmull-Rom); constant beyond its ends.
Eigen::RowVectorXd Interpolate(const Eigen::MatrixXd& samples, double position) {
  const Eigen::Index last = samples.rows() - 1;
  position = std::clamp(position, 0.0, static_cast<double>(last));
  const auto i = std::min(last, static_cast<Eigen::Index>(position));
  const double s = position - static_cast<double>(i);
  const auto row = [&](Eigen::Index k) {
    return samples.row(std::clamp<Eigen::Index>(k, 0, last));
  };
  const Eigen::RowVectorXd slope_0 = 0.5 * (row(i + 1) - row(i - 1));
  const Eigen::RowVectorXd slope_1 = 0.5 * (row(i + 2) - row(i));
  const double s2 = s * s;
  const double s3 = s2 * s;
  return (2.0 * s3 - 3.0 * s2 + 1.0) * row(i) + (s3 - 2.0 * s2 + s) * slope_0 +
         (3.0 * s2 - 2.0 * s3) * row(i + 1) + (s3 - s2) * slope_1;
}

/// Adds the causes of error of one joint to its logged positions. They displace the joint, and the
/// encoder does not show this.
void AddCauses(const TrueRobot& robot, const SensorOptions& options, JointLog& log) {
  constexpr double kLeastSpeed = 1e-3;  // rad/s: slower is no motion
  if (options.cause_joint.empty()) return;
  const int joint = FindJoint(robot.tree, options.cause_joint);
  const int c = robot.tree.joints[static_cast<std::size_t>(joint)].coordinate;
  const Eigen::VectorXd q = log.positions.col(c);
  double direction = 0.0;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double speed = i > 0 ? (q[i] - q[i - 1]) * options.log_rate_hz : 0.0;
    if (std::abs(speed) > kLeastSpeed) direction = std::copysign(1.0, speed);
    const double load = -log.torques(i, c);
    const double side = load == 0.0 ? 0.0 : std::copysign(1.0, load);
    log.positions(i, c) -= options.eccentricity * std::sin(q[i]) + options.gear_error * q[i] +
                           options.backlash * side + options.hysteresis * direction;
  }
}

/// The robot logs from time zero of its clock until the cameras stop, but at least one sample.
JointLog MakeLog(const TrueRobot& robot, const TrueMotion& motion, const SensorOptions& options,
                 const SensorTruth& truth, Random& random) {
  const double rate = 1.0 + 1e-6 * truth.drift_ppm;
  const double end_s = rate * (motion.frame_count() - 1) / motion.rate_hz - truth.lag_s;
  JointLog log;
  log.source = "simulated joint log";
  log.names = motion.joint_names;
  const auto rows = std::max<Eigen::Index>(
      1, static_cast<Eigen::Index>(std::floor(end_s * options.log_rate_hz)) + 1);
  log.time_s.resize(rows);
  log.positions.resize(rows, motion.encoders.cols());
  log.torques.resize(rows, motion.encoders.cols());
  const double step =
      options.encoder_bits > 0 ? 2.0 * M_PI * std::pow(0.5, options.encoder_bits) : 0.0;
  for (Eigen::Index i = 0; i < rows; ++i) {
    InterruptionPoint();
    log.time_s[i] = static_cast<double>(i) / options.log_rate_hz;
    const double frame = (log.time_s[i] + truth.lag_s) / rate * motion.rate_hz;
    log.positions.row(i) = Interpolate(motion.encoders, frame);
    log.torques.row(i) = Interpolate(motion.torques, frame);
  }
  AddCauses(robot, options, log);
  for (Eigen::Index c = 0; c < log.positions.cols(); ++c) {
    InterruptionPoint();
    const int k = robot.tree.coordinate_joint[static_cast<std::size_t>(c)];
    const bool slides =
        robot.tree.joints[static_cast<std::size_t>(k)].type == JointType::kPrismatic;
    if (step > 0.0 && !slides) {
      log.positions.col(c) = step * (log.positions.col(c) / step).array().round();
    }
    if (robot.torque_sensor[static_cast<std::size_t>(k)]) {
      log.torques.col(c) = robot.torque_gain[k] * log.torques.col(c) +
                           Eigen::VectorXd::Constant(rows, robot.torque_bias[k]) +
                           random.NormalVector(rows, options.torque_noise_sd);
    } else {
      log.torques.col(c).setConstant(kNaN);
    }
  }
  // Numbers are rounded as drivers print them; positions are still a thousand times finer than the
  // encoders.
  log.positions = (1e8 * log.positions).array().round() / 1e8;
  log.torques = (1e4 * log.torques).array().round() / 1e4;
  return log;
}

SensorTruth DrawClock(const SensorOptions& options, const Faults& faults,
                      const std::string& trial) {
  SensorTruth truth;
  Random lag(StreamSeed(options.seed, "lag " + trial));
  Random drift(StreamSeed(options.seed, "drift"));
  truth.lag_s = lag.Uniform(options.least_lag_s, options.largest_lag_s);
  if (faults.lag_s) truth.lag_s = *faults.lag_s;
  const double sign = drift.Index(2) == 0 ? -1.0 : 1.0;
  truth.drift_ppm = sign * drift.Uniform(0.5, 1.5) * options.drift_size_ppm;
  return truth;
}

}  // namespace

RawTrial Measure(const TrueRobot& robot, const std::vector<NamedCluster>& clusters,
                 const std::vector<PlannedTrial>& trials, std::size_t index,
                 const TrueMotion& motion, const SensorOptions& options, const Faults& faults) {
  CheckFaults(faults, robot, clusters, trials);
  const std::string& name = trials[index].name;
  RawTrial raw;
  raw.truth = DrawClock(options, faults, name);

  Eigen::MatrixXd positions = motion.markers;
  PushMarkers(faults, clusters, trials, index, motion, positions, raw.truth.faults);
  if (options.cameras_drift != 0.0) {
    for (Eigen::Index i = 0; i < positions.rows(); ++i) {
      const double hours = static_cast<double>(i) / motion.rate_hz / 3600.0;
      for (Eigen::Index m = 0; m < positions.cols(); m += 3) {
        positions(i, m) += options.cameras_drift * hours;
      }
    }
  }
  Random noise(StreamSeed(options.seed, "marker noise " + name));
  AddNoise(options, noise, positions);
  Random swaps(StreamSeed(options.seed, "swaps " + name));
  SwapLabels(options, clusters, motion.rate_hz, swaps, positions);
  Random gaps(StreamSeed(options.seed, "gaps " + name));
  for (Eigen::Index m = 0; m < positions.cols(); m += 3) {
    AtRandomTimes(options.gaps_per_minute, options.mean_gap_s, motion.rate_hz, positions.rows(),
                  gaps, [&](Eigen::Index first, Eigen::Index last) {
                    positions.block(first, m, last - first, 3).setConstant(kNaN);
                  });
  }
  Random missing(StreamSeed(options.seed, "missing " + name));
  LoseMarkers(faults, trials, index, motion.marker_names, motion.rate_hz, missing, positions,
              raw.truth.faults);
  raw.markers = {"simulated cameras", motion.marker_names, motion.rate_hz, std::move(positions)};

  Random torque(StreamSeed(options.seed, "torque noise " + name));
  raw.joints = MakeLog(robot, motion, options, raw.truth, torque);
  SpoilLog(faults, trials, index, raw.joints, raw.truth.faults);
  return raw;
}

}  // namespace elastocal
