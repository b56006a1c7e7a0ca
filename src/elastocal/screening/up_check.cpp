// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/up_check.hpp"

#include <cmath>
#include <cstdio>
#include <vector>

#include "elastocal/math/statistics.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

constexpr double kMostTilt = 50.0 * M_PI / 180.0;
constexpr double kStandingTilt = 30.0 * M_PI / 180.0;

/// Directions from the centre of the feet to the centre of mass, in the frame of the recording.
std::vector<Eigen::Vector3d> WaysUp(const ErrorModel& model, const Recording& recording) {
  const Placement placement = RegisterPlacement(model, recording, 1.0);
  const double total = TotalMass(model.tree);
  std::vector<Eigen::Vector3d> ways;
  for (int i = 0; i < recording.posture_count(); ++i) {
    const std::vector<int>& support = recording.trials[recording.trial[i]].support;
    if (support.empty()) continue;
    const std::vector<Transform> links = LinkTransforms(model.tree, recording.q.row(i).transpose());
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < links.size() && total > 0.0; ++k) {
      centre += model.tree.links[k].mass / total * (links[k] * model.tree.links[k].com);
    }
    for (int foot : support) {
      centre -= links[foot].translation() / static_cast<double>(support.size());
    }
    ways.emplace_back(placement.T_ref_waist[i].linear() * centre);
  }
  return ways;
}

/// Median angle between these directions and `up`.
double Tilt(const std::vector<Eigen::Vector3d>& ways, const Eigen::Vector3d& up) {
  Eigen::VectorXd angles(static_cast<Eigen::Index>(ways.size()));
  for (std::size_t i = 0; i < ways.size(); ++i) {
    angles[static_cast<Eigen::Index>(i)] = std::atan2(ways[i].cross(up).norm(), ways[i].dot(up));
  }
  return Median(angles);
}

}  // namespace

std::optional<UpContradiction> FindWrongUp(const ErrorModel& model, const Recording& recording) {
  if (recording.trials.empty()) return std::nullopt;
  const std::vector<Eigen::Vector3d> ways = WaysUp(model, recording);
  if (ways.empty()) return std::nullopt;
  UpContradiction found{.tilt = Tilt(ways, -recording.gravity.normalized()), .axis = {}};
  if (!(found.tilt > kMostTilt)) return std::nullopt;
  for (int axis = 0; axis < 3; ++axis) {
    for (double sign : {1.0, -1.0}) {
      const double tilt = Tilt(ways, sign * Eigen::Vector3d::Unit(axis));
      if (!(tilt < kStandingTilt)) continue;
      found.axis = (sign < 0.0 ? "-" : "") + std::string(1, static_cast<char>('x' + axis));
      found.axis_tilt = tilt;
    }
  }
  return found;
}

std::string Describe(const UpContradiction& found) {
  char text[240];
  std::snprintf(text, sizeof text,
                "`up` in experiment.yaml is wrong: the robot would stand with its centre of mass "
                "%.0f deg off the vertical above its feet",
                found.tilt * 180.0 / M_PI);
  std::string whole = text;
  if (found.axis.empty()) return whole;
  std::snprintf(text, sizeof text, "; with `up: %s` it is %.0f deg", found.axis.c_str(),
                found.axis_tilt * 180.0 / M_PI);
  return whole + text;
}

}  // namespace elastocal
