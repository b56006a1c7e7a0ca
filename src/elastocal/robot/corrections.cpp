// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/corrections.hpp"

#include <algorithm>
#include <cmath>

namespace elastocal {
namespace {

using Shape = CorrectionShape;

constexpr double kSmoothing = 0.02;  // share of the effort below which a load's sign is smooth
constexpr double kLeastLoad = 0.05;  // N.m or N, if the effort is unknown
constexpr double kTypicalAngle = 2e-3, kTypicalPlay = 3e-3, kTypicalSlide = 2e-4;  // rad, rad, m
constexpr double kTypicalStiffening = 0.075;  // rad at the effort: 3e-3 at a fifth of it
constexpr double kTypicalRatio = 3e-3;
constexpr double kTypicalSlideByTurn = 2e-4, kTypicalTurnBySlide = 3e-3;  // m/rad, rad/m
constexpr double kTypicalTilt = 2e-5, kTypicalShift = 1e-5;               // rad/(N.m) and 1/N
constexpr double kTypicalDrift = 1e-3;                                    // m/h
constexpr double kTypicalMassShare = 0.1, kTypicalShiftOfMass = 0.02;     // m
constexpr double kLeastMass = 0.1;                                        // kg, for these two
constexpr double kTypicalGravityTilt = 0.01;                              // rad

bool KnowsEffort(const Joint& joint) {
  return std::isfinite(joint.limits.effort) && joint.limits.effort > 0.0;
}

double EvaluateJoint(const RobotTree& tree, const Correction& correction, const Eigen::VectorXd& q,
                     const Eigen::VectorXd& load_z, const PostureHistory& history) {
  const Joint& joint = tree.joints[correction.joint];
  const double position = JointPosition(joint, q);
  const double load = load_z.size() > 0 ? load_z[correction.joint] : 0.0;
  switch (correction.shape) {
    case Shape::kSin:
      return std::sin(position);
    case Shape::kCos:
      return std::cos(position);
    case Shape::kSinTwice:
      return std::sin(2.0 * position);
    case Shape::kCosTwice:
      return std::cos(2.0 * position);
    case Shape::kGear:
      return position - correction.centre;
    case Shape::kCoupling:
      return JointPosition(tree.joints[correction.source], q) - correction.centre;
    case Shape::kBacklash:
      return std::tanh(load / LoadScale(tree, correction));
    case Shape::kHysteresis: {
      const double sign = history.approach.size() > 0 ? history.approach[joint.coordinate] : 0.0;
      return joint.multiplier < 0.0 ? -sign : sign;
    }
    default: {
      const double effort = LoadScale(tree, correction);
      return load * std::abs(load) / (effort * effort);
    }
  }
}

double Evaluate(const RobotTree& tree, const Correction& correction, const Eigen::VectorXd& q,
                const Eigen::VectorXd& load_z, const PostureHistory& history) {
  switch (correction.shape) {
    case Shape::kSuspensionMx:
      return history.root_moment.x();
    case Shape::kSuspensionMy:
      return history.root_moment.y();
    case Shape::kHours:
      return history.hours - correction.centre;
    case Shape::kMass:
    case Shape::kFirstMoment:
    case Shape::kGravityTilt:
      return 1.0;
    default:
      return EvaluateJoint(tree, correction, q, load_z, history);
  }
}

/// Middle of a joint's range; zero if the range is unlimited.
double Middle(const Joint& joint) {
  const double middle = 0.5 * (joint.limits.lower + joint.limits.upper);
  return std::isfinite(middle) ? middle : 0.0;
}

struct CouplingSize {
  ParameterUnit unit;
  double typical;
};

/// Unit and prior of a coupling: of two revolute joints (tendons, differentials), or of a revolute
/// and a prismatic one (a spindle with splines).
CouplingSize Coupled(bool turns, bool neighbour_turns) {
  if (turns && neighbour_turns) return {ParameterUnit::kRatio, kTypicalRatio};
  if (turns) return {ParameterUnit::kRadianPerMetre, kTypicalTurnBySlide};
  return {ParameterUnit::kMetrePerRadian, kTypicalSlideByTurn};
}

class Catalogue {
 public:
  explicit Catalogue(const RobotTree& tree) : tree_(tree) {
    // A mimic joint follows another one.
    for (int coordinate = 0; coordinate < tree.coordinate_count(); ++coordinate) {
      joints_.push_back(tree.coordinate_joint[coordinate]);
    }
    std::sort(joints_.begin(), joints_.end());
  }

  std::vector<Correction> Of(std::optional<double> hours,
                             const std::vector<std::string>& markers) && {
    AddRoot(hours);
    for (int k = 0; k < static_cast<int>(tree_.joints.size()); ++k) AddBody(k);
    AddGravity();
    for (std::size_t i = 0; i < joints_.size(); ++i) AddJoint(i);
    if (hours) {
      for (const std::string& marker : markers) AddMarker(marker, *hours);
    }
    return std::move(list_);
  }

 private:
  void AddRoot(std::optional<double> hours) {
    const auto add = [&](const char* name, const char* cause, Shape shape, int axis,
                         ParameterUnit unit, double typical, double centre = 0.0) {
      list_.push_back({std::string("waist.") + name, std::string("waist.") + cause, shape, -1, axis,
                       -1, centre, unit, typical});
    };
    const auto tilt = ParameterUnit::kRadianPerNewtonMetre;
    const auto shift = ParameterUnit::kPerNewton;
    add("suspension_rx", "suspension", Shape::kSuspensionMx, 3, tilt, kTypicalTilt);
    add("suspension_ry", "suspension", Shape::kSuspensionMy, 4, tilt, kTypicalTilt);
    add("suspension_x", "suspension", Shape::kSuspensionMy, 0, shift, kTypicalShift);
    add("suspension_y", "suspension", Shape::kSuspensionMx, 1, shift, kTypicalShift);
    add("suspension_rx_my", "suspension", Shape::kSuspensionMy, 3, tilt, kTypicalTilt);
    add("suspension_ry_mx", "suspension", Shape::kSuspensionMx, 4, tilt, kTypicalTilt);
    if (!hours) return;
    const char* const names[] = {"drift_x", "drift_y", "drift_z"};
    for (int axis = 0; axis < 3; ++axis) {
      add(names[axis], "drift", Shape::kHours, axis, ParameterUnit::kMetrePerHour, kTypicalDrift,
          *hours);
    }
  }

  /// Adds mass and first moments of the body that a joint moves, named after the joint's child
  /// link.
  void AddBody(int joint) {
    double mass = 0.0;
    for (const Link& link : tree_.links) {
      if (link.body == joint + 1) mass += link.mass;
    }
    if (mass <= 0.0) return;
    mass = std::max(mass, kLeastMass);
    const std::string& link =
        tree_.links[static_cast<std::size_t>(tree_.joints[joint].child_link)].name;
    list_.push_back({link + ".mass", link + ".mass", Shape::kMass, -1, -1, joint, 0.0,
                     ParameterUnit::kKilogram, kTypicalMassShare * mass});
    for (int axis = 0; axis < 3; ++axis) {
      list_.push_back({link + ".moment_" + "xyz"[axis], link + ".moment", Shape::kFirstMoment, -1,
                       axis, joint, 0.0, ParameterUnit::kKilogramMetre,
                       kTypicalShiftOfMass * mass});
    }
  }

  void AddGravity() {
    for (int axis = 0; axis < 2; ++axis) {
      list_.push_back({std::string("gravity.tilt_") + "xy"[axis], "gravity.tilt",
                       Shape::kGravityTilt, -1, axis, -1, 0.0, ParameterUnit::kRadian,
                       kTypicalGravityTilt});
    }
  }

  void AddMarker(const std::string& marker, double hours) {
    const std::string cause = "marker." + marker + ".creep";
    for (int axis = 0; axis < 3; ++axis) {
      list_.push_back({cause + "_" + "xyz"[axis], cause, Shape::kHours, -1, axis, -1, hours,
                       ParameterUnit::kMetrePerHour, kTypicalDrift, marker});
    }
  }

  void AddJoint(std::size_t i) {
    const int k = joints_[i];
    const Joint& joint = tree_.joints[k];
    const bool turns = joint.type == JointType::kRevolute;
    const auto own = turns ? ParameterUnit::kRadian : ParameterUnit::kMetre;
    const double play = turns ? kTypicalPlay : kTypicalSlide;
    const auto add = [&](const std::string& name, const std::string& cause, Shape shape,
                         ParameterUnit unit, double typical, int source = -1, double centre = 0.0) {
      list_.push_back({joint.name + "." + name, joint.name + "." + cause, shape, k, -1, source,
                       centre, unit, typical});
    };
    if (turns) {
      add("eccentricity_sin", "eccentricity", Shape::kSin, own, kTypicalAngle);
      add("eccentricity_cos", "eccentricity", Shape::kCos, own, kTypicalAngle);
      add("ellipticity_sin", "ellipticity", Shape::kSinTwice, own, kTypicalAngle);
      add("ellipticity_cos", "ellipticity", Shape::kCosTwice, own, kTypicalAngle);
    }
    add("gear", "gear", Shape::kGear, ParameterUnit::kRatio, kTypicalRatio, -1, Middle(joint));
    for (const std::size_t other : {i - 1, i + 1}) {
      if (other >= joints_.size()) continue;  // also where i - 1 wraps around
      const Joint& neighbour = tree_.joints[joints_[other]];
      const bool adjacent =
          neighbour.parent_body == k + 1 || joint.parent_body == joints_[other] + 1;
      const bool neighbour_turns = neighbour.type == JointType::kRevolute;
      if (!adjacent || (!turns && !neighbour_turns)) continue;
      const auto [unit, typical] = Coupled(turns, neighbour_turns);
      const std::string name = "coupling_" + neighbour.name;
      add(name, name, Shape::kCoupling, unit, typical, joints_[other], Middle(neighbour));
    }
    add("backlash", "backlash", Shape::kBacklash, own, play);
    add("hysteresis", "hysteresis", Shape::kHysteresis, own, play);
    if (turns && KnowsEffort(joint)) {
      add("stiffening", "stiffening", Shape::kStiffening, own, kTypicalStiffening);
    }
  }

  const RobotTree& tree_;
  std::vector<int> joints_;
  std::vector<Correction> list_;
};

}  // namespace

Eigen::VectorXd EvaluateShapes(const RobotTree& tree, const std::vector<Correction>& corrections,
                               const Eigen::VectorXd& q, const Eigen::VectorXd& load_z,
                               const PostureHistory& history) {
  Eigen::VectorXd shapes(static_cast<Eigen::Index>(corrections.size()));
  for (Eigen::Index i = 0; i < shapes.size(); ++i) {
    shapes[i] = Evaluate(tree, corrections[static_cast<std::size_t>(i)], q, load_z, history);
  }
  return shapes;
}

double LoadScale(const RobotTree& tree, const Correction& correction) {
  const Joint& joint = tree.joints[correction.joint];
  if (!KnowsEffort(joint)) return kLeastLoad;
  return (correction.shape == Shape::kBacklash ? kSmoothing : 1.0) * joint.limits.effort;
}

std::vector<Correction> PossibleCorrections(const RobotTree& tree, std::optional<double> hours,
                                            const std::vector<std::string>& markers) {
  return Catalogue(tree).Of(hours, markers);
}

CorrectionTarget TargetOf(const Correction& correction) {
  if (correction.joint >= 0) return CorrectionTarget::kJoint;
  if (!correction.marker_name.empty()) return CorrectionTarget::kMarker;
  switch (correction.shape) {
    case Shape::kMass:
    case Shape::kFirstMoment:
    case Shape::kGravityTilt:
      return CorrectionTarget::kLoads;
    default:
      return CorrectionTarget::kRoot;
  }
}

std::vector<Correction> CorrectionsOf(const std::vector<Correction>& all,
                                      const std::vector<std::string>& causes) {
  std::vector<Correction> chosen;
  for (const Correction& correction : all) {
    if (std::find(causes.begin(), causes.end(), correction.cause) != causes.end()) {
      chosen.push_back(correction);
    }
  }
  return chosen;
}

std::vector<std::string> CausesOf(const std::vector<Correction>& corrections) {
  std::vector<std::string> causes;
  for (const Correction& correction : corrections) {
    if (std::find(causes.begin(), causes.end(), correction.cause) == causes.end()) {
      causes.push_back(correction.cause);
    }
  }
  return causes;
}

}  // namespace elastocal
