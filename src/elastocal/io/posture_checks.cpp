// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/posture_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "elastocal/math/input_error.hpp"
#include "elastocal/measurement/recorded_joints.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr double kDegreesPerRadian = 180.0 / M_PI;
/// Beyond two turns a joint is more likely in degrees than wound up.
constexpr double kLargestAngle = 4.0 * M_PI;
constexpr double kLargestSlide = 20.0;  // largest multiple of the limit of a sliding joint
constexpr double kLeastSlide = 1.0;     // m: limits of grippers are often too narrow
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

/// Likely units of lengths that, taken for metres, would be `ratio` times the robot's size. A robot
/// that is calibrated moves its markers by 0.08 to 1.1 times its size (RobotSize). Empty if no unit
/// fits.
std::string LikelyUnits(double ratio) {
  struct LengthUnit {
    const char* name;
    double in_a_metre;
  };
  constexpr std::array kUnits = {LengthUnit{"inches", 39.37}, LengthUnit{"centimetres", 100.0},
                                 LengthUnit{"millimetres", 1000.0}};
  std::string likely;
  for (const LengthUnit& unit : kUnits) {
    const bool largest = unit.in_a_metre == kUnits.back().in_a_metre;  // cameras may be far away
    const double sizes = ratio / unit.in_a_metre;
    if (sizes < 0.08 || (sizes > 1.1 && !largest)) continue;
    likely += (likely.empty() ? "" : " or ") + std::string(unit.name);
  }
  return likely;
}

[[noreturn]] void FailUnit(const std::string& found, double length, double size) {
  const std::string units = LikelyUnits(length / size);
  throw InputError(found + ", but the robot is no larger than " + Round(size) + " m: " +
                   (units.empty() ? "is a marker wrong, or are these in another unit?"
                                  : "these look like " + units + ";") +
                   " metres were expected");
}

void CheckRanges(const Recording& recording, double size) {
  double largest = 0.0;  // range of the marker that moves most
  std::string found;
  for (int m = 0; m < recording.marker_count(); ++m) {
    for (int axis = 0; axis < 3; ++axis) {
      const double range = Range(recording.markers.col(3 * m + axis));
      if (range <= std::max(largest, kLargestRange * size)) continue;
      largest = range;
      found = recording.source + ": marker " + Quote(recording.marker_names[m]) + " ranges over " +
              Round(range) + " m along " + "xyz"[axis];
    }
  }
  if (!found.empty()) FailUnit(found, largest, size);
}

std::vector<int> SeenMarkers(const Recording& recording, int posture) {
  std::vector<int> seen;
  for (int m = 0; m < recording.marker_count(); ++m) {
    if (Seen(recording, posture, m)) seen.push_back(m);
  }
  return seen;
}

/// Median of the markers' positions in a posture, coordinate by coordinate.
Eigen::Vector3d MedianPosition(const Recording& recording, int posture,
                               const std::vector<int>& markers) {
  Eigen::Vector3d median;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (int m : markers) values.push_back(recording.markers(posture, 3 * m + axis));
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    median[axis] = *middle;
  }
  return median;
}

/// Throws InputError if two markers are too far apart. It names the odd one: the one that is
/// farther from the median position or, if only two are seen, from the origin.
void CheckDistance(const Recording& recording, int posture, int a, int b, double size) {
  const Eigen::Vector3d p = MarkerPosition(recording, posture, a);
  const Eigen::Vector3d q = MarkerPosition(recording, posture, b);
  const double distance = (p - q).norm();
  if (distance <= kLargestRange * size) return;
  const std::vector<int> seen = SeenMarkers(recording, posture);
  const Eigen::Vector3d reference =
      seen.size() > 2 ? MedianPosition(recording, posture, seen) : Eigen::Vector3d::Zero().eval();
  if ((p - reference).norm() < (q - reference).norm()) std::swap(a, b);
  FailUnit(PlaceOf(recording, posture) + "marker " + Quote(recording.marker_names[a]) + " is " +
               Round(distance) + " m from marker " + Quote(recording.marker_names[b]),
           distance, size);
}

void CheckDistances(const Recording& recording, double size) {
  for (int i = 0; i < recording.posture_count(); ++i) {
    const std::vector<int> seen = SeenMarkers(recording, i);
    // If all markers are near the first, no two are far apart, and the pairs need not be checked.
    const bool close = std::all_of(seen.begin(), seen.end(), [&](int m) {
      return (MarkerPosition(recording, i, m) - MarkerPosition(recording, i, seen[0])).norm() <=
             0.5 * kLargestRange * size;
    });
    if (close) continue;
    for (std::size_t a = 0; a < seen.size(); ++a) {
      for (std::size_t b = a + 1; b < seen.size(); ++b) {
        CheckDistance(recording, i, seen[a], seen[b], size);
      }
    }
  }
}

void CheckPosturesDiffer(const Recording& recording) {
  const int count = recording.posture_count();
  if (count < 2 || recording.q != recording.q.row(0).replicate(count, 1)) return;
  throw InputError(recording.source + ": the " + std::to_string(count) +
                   " postures are all the same; different joint positions were expected");
}

/// Joint and marker positions of a posture. Infinity stands for a marker that was not seen, as NaN
/// is not even equal to itself.
std::vector<double> RowNumbers(const Recording& recording, int posture) {
  std::vector<double> row(recording.q.row(posture).begin(), recording.q.row(posture).end());
  for (double value : recording.markers.row(posture)) {
    row.push_back(std::isnan(value) ? std::numeric_limits<double>::infinity() : value);
  }
  return row;
}

/// The speed that no joint of a robot has, rad/s or m/s.
double ImpossibleSpeed(const Joint& joint) {
  constexpr double kTimesLimit = 5.0, kLeast = 20.0;  // some URDFs have limits that are too low
  const double limit = joint.limits.velocity;
  return std::isfinite(limit) ? std::max(kLeast, kTimesLimit * limit) : kLeast;
}

/// Throws InputError for times that are not in seconds: the joints could not move so fast from one
/// posture to the next.
void CheckSeconds(const Recording& recording, const RobotTree& tree) {
  int steps = 0, flying = 0;
  Eigen::Index worst = 0, joint = 0;
  double most = 0.0;
  for (Eigen::Index i = 1; i < recording.time_s.size(); ++i) {
    const double step = recording.time_s[i] - recording.time_s[i - 1];
    if (!(step > 0.0)) continue;
    ++steps;
    bool flies = false;
    for (int c = 0; c < tree.coordinate_count(); ++c) {
      const double speed = std::abs(recording.q(i, c) - recording.q(i - 1, c)) / step;
      flies = flies || speed > ImpossibleSpeed(tree.joints[tree.coordinate_joint[c]]);
      if (speed <= most) continue;
      most = speed;
      worst = i;
      joint = tree.coordinate_joint[c];
    }
    flying += flies ? 1 : 0;
  }
  if (2 * flying <= steps) return;
  throw InputError(PlaceOf(recording, worst) + "joint " + Quote(tree.joints[joint].name) +
                   " would have moved at " + FormatNumber(std::round(most)) +
                   (tree.joints[joint].type == JointType::kRevolute ? " rad/s" : " m/s") +
                   " since the posture before: these times look like hours or minutes; seconds "
                   "were expected");
}

std::string LimitWarning(const Recording& recording, const Joint& joint, int coordinate) {
  const bool revolute = joint.type == JointType::kRevolute;
  int count = 0, worst = 0;
  double worst_excess = 0.0;
  for (int i = 0; i < recording.posture_count(); ++i) {
    const double q = recording.q(i, coordinate);
    const double excess = std::max(joint.limits.lower - q, q - joint.limits.upper);
    count += BeyondLimits(joint, q);
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

bool TurnsWithoutEnd(const Joint& joint) {
  return joint.type == JointType::kRevolute && std::isinf(joint.limits.lower) &&
         std::isinf(joint.limits.upper);
}

/// Whether joints with limits tell that angles are in radians: some are not at zero, and none is
/// beyond its limits. In degrees they would be.
bool LimitsTellRadians(const std::vector<const Joint*>& joints, const Eigen::MatrixXd& positions) {
  bool told = false;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    if (joints[k]->type != JointType::kRevolute || TurnsWithoutEnd(*joints[k])) continue;
    for (const double q : positions.col(static_cast<Eigen::Index>(k))) {
      if (BeyondLimits(*joints[k], q)) return false;
      told = told || q != 0.0;
    }
  }
  return told;
}

}  // namespace

void CheckUnits(const Joint& joint, const Eigen::Ref<const Eigen::VectorXd>& positions,
                const std::function<std::string(Eigen::Index)>& place) {
  if (positions.size() == 0) return;
  const bool slides = joint.type == JointType::kPrismatic;
  const double range = std::max(std::abs(joint.limits.lower), std::abs(joint.limits.upper));
  const double most = !slides       ? kLargestAngle
                      : range > 0.0 ? std::max(kLeastSlide, kLargestSlide * range)
                                    : std::numeric_limits<double>::infinity();
  Eigen::Index worst = 0;
  const double largest = positions.cwiseAbs().maxCoeff(&worst);
  if (largest <= most) return;
  if (slides) {
    throw InputError(place(worst) + "joint " + Quote(joint.name) + " is at " +
                     FormatNumber(positions[worst]) + ", its limit is at " + FormatNumber(range) +
                     " m: this looks like millimetres; metres were expected");
  }
  throw InputError(place(worst) + "joint " + Quote(joint.name) + " is at " +
                   FormatNumber(positions[worst]) +
                   ": this looks like degrees; radians were expected");
}

void CheckUnits(const std::vector<const Joint*>& joints, const Eigen::MatrixXd& positions,
                const std::function<std::string(Eigen::Index)>& place) {
  const bool radians = LimitsTellRadians(joints, positions);
  for (std::size_t k = 0; k < joints.size(); ++k) {
    if (radians && TurnsWithoutEnd(*joints[k])) continue;
    CheckUnits(*joints[k], positions.col(static_cast<Eigen::Index>(k)), place);
  }
}

bool BeyondLimits(const Joint& joint, double position) {
  const double margin = joint.type == JointType::kRevolute ? kLimitMarginRad : kLimitMarginM;
  return std::max(joint.limits.lower - position, position - joint.limits.upper) > margin;
}

void CheckPlausible(const Recording& recording, const RobotTree& tree) {
  const double size = RobotSize(tree);
  if (size > 0.0) {
    if (!HasPoseByPosture(recording)) CheckRanges(recording, size);
    CheckDistances(recording, size);
  }
  std::vector<const Joint*> joints;
  for (const int joint : tree.coordinate_joint) joints.push_back(&tree.joints[joint]);
  CheckUnits(joints, recording.q, [&](Eigen::Index i) { return PlaceOf(recording, i); });
  CheckSeconds(recording, tree);
  CheckIdentical(recording);
  CheckPosturesDiffer(recording);
}

std::vector<std::string> LimitWarnings(const Recording& recording, const RobotTree& tree) {
  std::vector<std::string> warnings;
  for (int c = 0; c < tree.coordinate_count(); ++c) {
    const Joint& joint = tree.joints[tree.coordinate_joint[c]];
    if (!IsRecorded(recording, tree, c)) continue;
    const std::string warning = LimitWarning(recording, joint, c);
    if (!warning.empty()) warnings.push_back(warning);
  }
  return warnings;
}

std::string RepetitionWarning(const Recording& recording) {
  std::map<std::vector<double>, int> first_lines;
  std::vector<int> repeated, repeating;
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (SeenMarkers(recording, i).empty()) continue;  // nothing was measured
    const auto [first, is_new] = first_lines.emplace(RowNumbers(recording, i), recording.line[i]);
    if (is_new) continue;
    repeated.push_back(first->second);
    repeating.push_back(recording.line[i]);
  }
  if (repeating.empty()) return "";
  const std::size_t count = repeating.size();
  std::string text = recording.source + (count == 1 ? ": line " : ": lines ");
  text += std::to_string(repeating[0]);
  if (count > 1) text += (count > 2 ? ", " : " and ") + std::to_string(repeating[1]);
  if (count > 2) text += " and " + std::to_string(count - 2) + " more";
  const bool one_source =
      std::count(repeated.begin(), repeated.end(), repeated[0]) == std::ptrdiff_t(count);
  text += count == 1 ? " repeats " : " repeat ";
  text += one_source ? "line " + std::to_string(repeated[0]) : "lines above them";
  return text + (count == 1 ? ": it counts as an independent measurement, which it is not"
                            : ": they count as independent measurements, which they are not");
}

}  // namespace elastocal
