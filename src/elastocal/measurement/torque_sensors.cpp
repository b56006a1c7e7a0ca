// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/torque_sensors.hpp"

#include <cstdio>
#include <map>
#include <optional>

#include "elastocal/measurement/frame_interval.hpp"

namespace elastocal {
namespace {

// A value to which a sensor returns and at which it stays.
struct Stays {
  double seconds = 0.0;
  double longest_s = 0.0;
  double begin_s = 0.0;  // of the first
  int count = 0;
};

bool RobotMoves(const JointLog& log, const FrameInterval& samples, double moved_rad) {
  const auto positions = log.positions.middleRows(samples.begin, samples.size());
  for (Eigen::Index joint = 0; joint < positions.cols(); ++joint) {
    if (positions.col(joint).maxCoeff() - positions.col(joint).minCoeff() > moved_rad) return true;
  }
  return false;
}

// The stays of a sensor, by the exact value at which it stays.
std::map<double, Stays> FindStays(const JointLog& log, int column,
                                  const TorqueCheckOptions& options) {
  std::map<double, Stays> stays;
  const auto torque = log.torques.col(column);
  for (int begin = 0, end = 0; begin < log.sample_count(); begin = end) {
    while (end < log.sample_count() && torque[end] == torque[begin]) ++end;
    const double seconds = log.time_s[end - 1] - log.time_s[begin];
    if (seconds < options.shortest_stay_s) continue;
    if (!RobotMoves(log, {begin, end}, options.moved_rad)) continue;
    Stays& here = stays[torque[begin]];
    if (here.count++ == 0) here.begin_s = log.time_s[begin];
    here.seconds += seconds;
    here.longest_s = std::max(here.longest_s, seconds);
  }
  return stays;
}

std::optional<TorqueFinding> CheckSensor(const JointLog& log, int column,
                                         const TorqueCheckOptions& options) {
  const auto torque = log.torques.col(column);
  if (!torque.allFinite()) return std::nullopt;
  const double lowest = torque.minCoeff();
  const double highest = torque.maxCoeff();
  const auto finding = [&](TorqueFault fault, double value, double begin_s) {
    const auto count = static_cast<double>((torque.array() == value).count());
    return TorqueFinding{column, fault, value, count / log.sample_count(), begin_s};
  };
  if (lowest == highest) return finding(TorqueFault::kDead, lowest, log.time_s[0]);
  std::optional<TorqueFinding> saturated;
  for (const auto& [value, here] : FindStays(log, column, options)) {
    const bool extreme = value == lowest || value == highest;
    // A stuck sensor keeps its last value forever, whereas a saturated one reaches its limit again
    // and again.
    if (here.longest_s >= options.stuck_s && !(extreme && here.count > 1)) {
      return finding(TorqueFault::kStuck, value, here.begin_s);
    }
    if (extreme && here.seconds >= options.saturated_s) {
      saturated = finding(TorqueFault::kSaturated, value, here.begin_s);
    }
  }
  return saturated;
}

}  // namespace

std::vector<TorqueFinding> CheckTorqueSensors(const JointLog& log,
                                              const TorqueCheckOptions& options) {
  std::vector<TorqueFinding> findings;
  if (log.sample_count() < 2) return findings;
  for (int column = 0; column < static_cast<int>(log.torques.cols()); ++column) {
    if (const auto finding = CheckSensor(log, column, options)) findings.push_back(*finding);
  }
  return findings;
}

std::string Describe(const TorqueFinding& finding) {
  char text[160];
  switch (finding.fault) {
    case TorqueFault::kDead:
      std::snprintf(text, sizeof(text), "dead (%.4g throughout)", finding.value);
      break;
    case TorqueFault::kStuck:
      std::snprintf(text, sizeof(text),
                    "stuck (at %.4g while the robot moved, %.0f %% of the time)", finding.value,
                    100.0 * finding.share);
      break;
    case TorqueFault::kSaturated:
      std::snprintf(text, sizeof(text), "saturated (at %.4g for %.1f %% of the time)",
                    finding.value, 100.0 * finding.share);
      break;
  }
  return text;
}

}  // namespace elastocal
