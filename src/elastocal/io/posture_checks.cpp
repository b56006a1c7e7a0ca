#include "elastocal/io/posture_checks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

constexpr double kDegreesPerRadian = 180.0 / M_PI;
/// Beyond two turns a joint is more likely in degrees than wound up.
constexpr double kLargestAngle = 4.0 * M_PI;
/// Marker positions of a robot that stands fixed cannot range over more than its size; three times
/// leaves room for long tools.
constexpr double kLargestRange = 3.0;
constexpr double kLimitMarginRad = M_PI / 180.0;
constexpr double kLimitMarginM = 5e-3;

/// Few digits, for messages.
std::string Round(double value) { return FormatNumber(std::round(value * 1e4) / 1e4); }

std::string PlaceOf(const Recording& recording, Eigen::Index posture) {
  return recording.line.empty() ? recording.source + ": "
                                : Place(recording.source, recording.line[posture]);
}

bool SameNumbers(const Recording& recording, int a, int b) {
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (Seen(recording, i, a) != Seen(recording, i, b)) return false;
    if (Seen(recording, i, a) &&
        MarkerPosition(recording, i, a) != MarkerPosition(recording, i, b)) {
      return false;
    }
  }
  return true;
}

void CheckIdentical(const Recording& recording) {
  for (int a = 0; a < recording.marker_count(); ++a) {
    for (int b = a + 1; b < recording.marker_count(); ++b) {
      if (!SameNumbers(recording, a, b)) continue;
      throw InputError(recording.source + ": markers " + Quote(recording.marker_names[a]) +
                       " and " + Quote(recording.marker_names[b]) +
                       " have identical columns; two markers are never in one place");
    }
  }
}

/// Largest minus smallest of the numbers in a column that may have gaps.
double Range(const Eigen::VectorXd& column) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (double value : column) {
    if (std::isnan(value)) continue;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  return most - least;
}

void CheckMetres(const Recording& recording, const RobotTree& tree) {
  const double size = RobotSize(tree);
  for (int m = 0; m < recording.marker_count(); ++m) {
    for (int axis = 0; axis < 3; ++axis) {
      const double range = Range(recording.markers.col(3 * m + axis));
      if (size <= 0.0 || range <= kLargestRange * size) continue;
      throw InputError(recording.source + ": marker " + Quote(recording.marker_names[m]) +
                       " ranges over " + Round(range) + " m along " + "xyz"[axis] +
                       ", but the robot is no larger than " + Round(size) +
                       " m: these look like millimetres; metres were expected");
    }
  }
}

std::string LimitWarning(const Recording& recording, const Joint& joint, int coordinate) {
  const bool revolute = joint.type == JointType::kRevolute;
  const double margin = revolute ? kLimitMarginRad : kLimitMarginM;
  int count = 0, worst = 0;
  double worst_excess = 0.0;
  for (int i = 0; i < recording.posture_count(); ++i) {
    const double q = recording.q(i, coordinate);
    const double excess = std::max(joint.limits.lower - q, q - joint.limits.upper);
    count += excess > margin;
    if (excess <= worst_excess) continue;
    worst_excess = excess;
    worst = i;
  }
  if (count == 0) return "";
  const double q = recording.q(worst, coordinate);
  const double limit = q > joint.limits.upper ? joint.limits.upper : joint.limits.lower;
  const std::string unit = revolute ? " rad" : " m";
  return PlaceOf(recording, worst) + "joint " + Quote(joint.name) + " is at " + Round(q) + unit +
         ", " +
         (revolute ? Round(worst_excess * kDegreesPerRadian) + " degrees"
                   : Round(worst_excess * 1e3) + " mm") +
         " beyond its limit of " + Round(limit) + unit +
         (count > 1 ? " (the worst of " + std::to_string(count) + " postures beyond it)" : "");
}

}  // namespace

void CheckRadians(const Joint& joint, const Eigen::Ref<const Eigen::VectorXd>& positions,
                  const std::function<std::string(Eigen::Index)>& place) {
  if (joint.type != JointType::kRevolute || positions.size() == 0) return;
  Eigen::Index worst = 0;
  const double largest = positions.cwiseAbs().maxCoeff(&worst);
  if (largest <= kLargestAngle) return;
  throw InputError(place(worst) + "joint " + Quote(joint.name) + " is at " +
                   FormatNumber(positions[worst]) +
                   ": this looks like degrees; radians were expected");
}

void CheckPlausible(const Recording& recording, const RobotTree& tree) {
  CheckMetres(recording, tree);
  for (int c = 0; c < tree.coordinate_count(); ++c) {
    CheckRadians(tree.joints[tree.coordinate_joint[c]], recording.q.col(c),
                 [&](Eigen::Index i) { return PlaceOf(recording, i); });
  }
  CheckIdentical(recording);
}

std::vector<std::string> LimitWarnings(const Recording& recording, const RobotTree& tree) {
  std::vector<std::string> warnings;
  for (int c = 0; c < tree.coordinate_count(); ++c) {
    const Joint& joint = tree.joints[tree.coordinate_joint[c]];
    const auto& absent = recording.joints_not_recorded;
    if (std::find(absent.begin(), absent.end(), joint.name) != absent.end()) continue;
    const std::string warning = LimitWarning(recording, joint, c);
    if (!warning.empty()) warnings.push_back(warning);
  }
  return warnings;
}

}  // namespace elastocal
