// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/true_robot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/statics.hpp"
#include "elastocal/simulation/stream_seed.hpp"

namespace elastocal {
namespace {

/// Limits a compliance so that gravity deflects no joint by more than 0.01 rad (m). Stiffnesses are
/// those of robots of a person's weight, but some robots carry tonnes.
void KeepStiffEnough(double torque, double& compliance) {
  constexpr double kLargestDeflection = 0.01;  // rad or m
  if (torque * compliance > kLargestDeflection) compliance = kLargestDeflection / torque;
}

/// Largest likely torque of a motor, N.m: it holds three times the robot's weight at its full
/// reach. A larger effort in a URDF (50000 in one of an ergoCub) is a placeholder.
double LargestLikelyEffort(const RobotTree& tree) {
  double mass = 0.0;
  for (const Link& link : tree.links) mass += link.mass;
  return 1.5 * mass * kGravity.norm() * RobotSize(tree);  // twice the reach
}

class Drawing {
 public:
  Drawing(const TruthOptions& options, TrueRobot& robot) : options_(options), robot_(robot) {}

  void Placements() {
    SeriesRandom random(options_.seed, options_.series, "placement");
    for (std::size_t k = 0; k < robot_.tree.joints.size(); ++k) {
      Joint& joint = robot_.tree.joints[k];
      const Eigen::Vector3d shift = random.NormalVector(3, 1.0);
      const Eigen::Vector3d turn = random.NormalVector(3, 1.0);
      const double scale = GeometryScale(k);
      const double angle = scale * options_.angle_sd * turn.norm();
      joint.T_parent_child = joint.T_parent_child *
                             Eigen::Translation3d(scale * options_.length_sd * shift) *
                             RotAxis(turn.normalized(), angle);
    }
  }

  void Offsets() {
    SeriesRandom random(options_.seed, options_.series, "offset");
    for (std::size_t k = 0; k < robot_.tree.joints.size(); ++k) {
      const bool slides = robot_.tree.joints[k].type == JointType::kPrismatic;
      const double sd = slides     ? options_.length_sd
                        : IsLeg(k) ? options_.leg_offset_sd
                                   : options_.upper_offset_sd;
      robot_.offset[Index(k)] = GeometryScale(k) * random.Normal(1.0) * sd;
    }
  }

  void Linkages() {
    SeriesRandom random(options_.seed, options_.series, "linkages");
    for (std::size_t i = 0; i < robot_.described.linkages.size(); ++i) {
      const Linkage& linkage = robot_.described.linkages[i];
      Eigen::VectorXd& errors = robot_.linkage_errors[i];
      Eigen::Index at = 0;
      for (const Rod& rod : linkage.rods) {
        for (const auto& [quantity, sd] : rod.uncertain) {
          const auto joint = static_cast<std::size_t>(linkage.joints[0]);
          errors[at++] = GeometryScale(joint) * random.Normal(1.0) * sd;
        }
      }
      robot_.tree.linkages[i] = Assembled(linkage, errors);
      for (const int k : linkage.joints) robot_.offset[k] = 0.0;
    }
  }

  /// The true rods. They were adjusted when the linkage was put together on the true tree: except
  /// for the errors of the rods' lengths, the motors then read what the description says.
  Linkage Assembled(const Linkage& linkage, Eigen::VectorXd& errors) const {
    const auto motors = MotorPositions(robot_.described, linkage, linkage.assembled);
    Eigen::VectorXd but_lengths = errors;
    ForLengths(linkage, [&](std::size_t, Eigen::Index at) { but_lengths[at] = 0.0; });
    Linkage with = WithErrors(linkage, but_lengths);
    const Eigen::VectorXd gaps = LoopGaps(robot_.tree, with, *motors, linkage.assembled);
    for (std::size_t r = 0; r < with.rods.size(); ++r) with.rods[r].length += gaps[Index(r)];
    ForLengths(linkage, [&](std::size_t r, Eigen::Index at) {
      with.rods[r].length += errors[at];
      errors[at] += gaps[Index(r)];
    });
    return with;
  }

  /// Calls `use(rod, entry of the linkage's errors)` for each length that is uncertain.
  template <typename Use>
  static void ForLengths(const Linkage& linkage, const Use& use) {
    Eigen::Index at = 0;
    for (std::size_t r = 0; r < linkage.rods.size(); ++r) {
      for (const RodUncertainty& uncertain : linkage.rods[r].uncertain) {
        if (uncertain.quantity == RodQuantity::kLength) use(r, at);
        ++at;
      }
    }
  }

  void JointSprings() {
    SeriesRandom random(options_.seed, options_.series, "joint springs");
    const Eigen::VectorXd torques = LargestGravityTorques(robot_.tree);
    for (std::size_t k = 0; k < robot_.tree.joints.size(); ++k) {
      const double share = random.Uniform(0.0, 1.0);
      const auto [least, most] = StiffnessRange(k);
      const double scale =
          IsLeg(k) ? options_.leg_elasticity_scale : options_.upper_elasticity_scale;
      double compliance = 1.0 / (least * std::pow(most / least, share));
      if (!IsLeg(k)) KeepStiffEnough(torques[Index(k)], compliance);
      robot_.compliance[Index(k)] = scale * compliance;
    }
  }

  void LinkSprings() {
    SeriesRandom random(options_.seed, options_.series, "link springs");
    const auto draw = [&](Vector6d compliance) {
      for (double& c : compliance) {
        c *= options_.leg_elasticity_scale *
             (1.0 + options_.link_compliance_spread * random.Uniform(-1.0, 1.0));
      }
      return compliance;
    };
    for (std::size_t l = 0; l < robot_.legs.size(); ++l) {
      const std::vector<int>& joints = robot_.legs[l].joints;
      for (std::size_t i = 0; i < joints.size(); ++i) {
        robot_.link_compliance[static_cast<std::size_t>(joints[i])] =
            draw(i == 0                   ? options_.pelvis_compliance
                 : 2 * i <= joints.size() ? options_.hip_link_compliance
                                          : options_.shank_link_compliance);
      }
      robot_.foot_compliance[l] = draw(options_.shank_link_compliance);
    }
  }

  void Inertias() {
    SeriesRandom random(options_.seed, options_.series, "inertia");
    for (Link& link : robot_.tree.links) {
      const double factor = std::max(0.5, 1.0 + options_.mass_sd * random.Normal(1.0));
      const Eigen::Vector3d shift = random.NormalVector(3, options_.com_sd);
      if (link.mass <= 0.0) continue;
      link.mass *= factor;
      link.inertia *= factor;
      link.com += shift;
    }
  }

  void Friction() {
    const double largest = LargestLikelyEffort(robot_.tree);
    for (std::size_t k = 0; k < robot_.tree.joints.size(); ++k) {
      const double effort = robot_.tree.joints[k].limits.effort;
      if (!std::isfinite(effort)) continue;
      robot_.friction[Index(k)] = options_.friction_share * std::min(effort, largest);
    }
  }

  void Markers() {
    Random random(StreamSeed(options_.seed, "markers"));
    for (Marker& marker : robot_.markers) {
      marker.p_link_marker += random.NormalVector(3, options_.marker_sd);
    }
  }

  void Causes() {
    if (!options_.heavy_link.empty()) {
      Link& link = robot_.tree.links[FindLink(robot_.tree, options_.heavy_link)];
      link.mass *= 1.0 + options_.heavy_share;
      link.inertia *= 1.0 + options_.heavy_share;
    }
    if (options_.creeping_marker.empty()) return;
    std::vector<std::string> names;
    for (const Marker& marker : robot_.markers) names.push_back(marker.name);
    const auto at = std::find(names.begin(), names.end(), options_.creeping_marker);
    if (at == names.end()) {
      throw InputError("no marker '" + options_.creeping_marker + "'" +
                       DidYouMean(options_.creeping_marker, names));
    }
    robot_.creeping_marker = static_cast<int>(at - names.begin());
    robot_.creep = options_.creep;
  }

  void TorqueSensors() {
    constexpr double kLargestBiasShare = 0.02;
    SeriesRandom random(options_.seed, options_.series, "torque sensors");
    for (std::size_t k = 0; k < robot_.tree.joints.size(); ++k) {
      const double limit = kLargestBiasShare * robot_.tree.joints[k].limits.effort;
      robot_.torque_gain[Index(k)] = 1.0 + random.Normal(options_.torque_gain_sd);
      robot_.torque_bias[Index(k)] =
          std::clamp(random.Normal(options_.torque_bias_sd), -limit, limit);
    }
  }

 private:
  /// Smallest and largest stiffness of a joint.
  std::pair<double, double> StiffnessRange(std::size_t k) const {
    if (robot_.tree.joints[k].type == JointType::kPrismatic) {
      return {options_.slide_stiffness_least, options_.slide_stiffness_most};
    }
    if (IsLeg(k)) return {options_.leg_stiffness_least, options_.leg_stiffness_most};
    return {options_.upper_stiffness_least, options_.upper_stiffness_most};
  }

  static Eigen::Index Index(std::size_t k) { return static_cast<Eigen::Index>(k); }
  bool IsLeg(std::size_t k) const { return InLeg(robot_.legs, static_cast<int>(k)); }
  double GeometryScale(std::size_t k) const {
    return IsLeg(k) ? options_.leg_geometry_scale : options_.upper_geometry_scale;
  }

  const TruthOptions& options_;
  TrueRobot& robot_;
};

/// Moves the joints of linkage `i` in `q` from their positions by the rods of tree `from` to those
/// by the rods of tree `to`, for the same positions of the motors. Joints out of reach stay.
void MoveBetween(const RobotTree& from, const RobotTree& to, std::size_t i, Eigen::VectorXd& q) {
  const std::vector<int> coordinates = CoordinatesOf(from, from.linkages[i]);
  const Eigen::VectorXd positions = q(coordinates);
  const auto motors = MotorPositions(from, from.linkages[i], positions);
  if (!motors) return;
  const auto closure = CloseLinkage(to, to.linkages[i], *motors, {}, positions);
  if (closure) q(coordinates) = closure->positions;
}

}  // namespace

TrueRobot NominalRobot(RobotTree tree, std::vector<Marker> markers, std::vector<Leg> legs,
                       const std::vector<int>& torque_sensors) {
  TrueRobot robot;
  const auto joints = static_cast<Eigen::Index>(tree.joints.size());
  if (!tree.linkages.empty()) robot.described = tree;
  for (const Linkage& linkage : tree.linkages) {
    robot.linkage_errors.emplace_back(Eigen::VectorXd::Zero(linkage.error_count()));
  }
  robot.tree = std::move(tree);
  robot.legs = std::move(legs);
  robot.markers = std::move(markers);
  robot.offset = robot.compliance = robot.friction = Eigen::VectorXd::Zero(joints);
  robot.torque_gain = Eigen::VectorXd::Ones(joints);
  robot.torque_bias = Eigen::VectorXd::Zero(joints);
  robot.link_compliance.assign(robot.tree.joints.size(), Vector6d::Zero());
  robot.foot_compliance.assign(robot.legs.size(), Vector6d::Zero());
  robot.torque_sensor.assign(robot.tree.joints.size(), false);
  for (int k : torque_sensors) robot.torque_sensor[static_cast<std::size_t>(k)] = true;
  return robot;
}

TrueRobot DrawTrueRobot(const TrueRobot& nominal, const TruthOptions& options) {
  TrueRobot robot = nominal;
  TruthOptions scaled = options;
  const double height = StandingHeight(nominal.tree, nominal.legs);
  if (height > 0.0) {
    scaled.length_sd *= height / options.described_height;
    scaled.com_sd *= height / options.described_height;
  }
  Drawing drawing(scaled, robot);
  drawing.Placements();
  drawing.Offsets();
  drawing.Linkages();
  drawing.JointSprings();
  drawing.LinkSprings();
  drawing.Inertias();
  drawing.Friction();
  drawing.Markers();
  drawing.TorqueSensors();
  drawing.Causes();
  return robot;
}

Eigen::VectorXd TrueJointPositions(const TrueRobot& robot, const Eigen::VectorXd& encoders) {
  Eigen::VectorXd placed = encoders;
  for (std::size_t i = 0; i < robot.described.linkages.size(); ++i) {
    MoveBetween(robot.described, robot.tree, i, placed);
  }
  Eigen::VectorXd positions = robot.offset;
  for (std::size_t k = 0; k < robot.tree.joints.size(); ++k) {
    positions[static_cast<Eigen::Index>(k)] += JointPosition(robot.tree.joints[k], placed);
  }
  return positions;
}

Eigen::VectorXd EncoderPositions(const TrueRobot& robot, const Eigen::VectorXd& positions) {
  Eigen::VectorXd encoders = positions - robot.offset;
  if (robot.described.linkages.empty()) return encoders;
  const std::vector<int>& drivers = robot.described.coordinate_joint;
  Eigen::VectorXd q = encoders(drivers);
  for (std::size_t i = 0; i < robot.described.linkages.size(); ++i) {
    MoveBetween(robot.tree, robot.described, i, q);
  }
  encoders(drivers) = q;
  return encoders;
}

std::vector<Transform> TrueLinkTransforms(const TrueRobot& robot,
                                          const Eigen::VectorXd& positions) {
  // In this tree every joint has its own coordinate.
  RobotTree tree = robot.tree;
  tree.coordinate_joint.clear();
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    Joint& joint = tree.joints[k];
    joint.coordinate = static_cast<int>(k);
    joint.multiplier = 1.0;
    joint.offset = 0.0;
    joint.more.clear();
    tree.coordinate_joint.push_back(static_cast<int>(k));
  }
  return LinkTransforms(tree, positions);
}

}  // namespace elastocal
