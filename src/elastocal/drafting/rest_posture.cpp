// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/rest_posture.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <tuple>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/robot/legs.hpp"
#include "elastocal/robot/statics.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Places a link by a chain of joints from the root link, with damped least squares.
class Placer {
 public:
  /// `turned`: the link also gets its attitude, not only its position.
  Placer(const RobotTree& tree, int link, bool turned, const std::vector<int>& joints,
         Eigen::VectorXd lower, Eigen::VectorXd upper)
      : tree_(tree),
        link_(link),
        turned_(turned),
        joints_(joints),
        lower_(std::move(lower)),
        upper_(std::move(upper)) {}

  /// Moves the joints within their limits until the link has the wanted position and, if `turned`,
  /// attitude.
  bool Place(const Transform& wanted, Eigen::VectorXd& q) const {
    for (const int k : joints_) {
      const int c = tree_.joints[Size(k)].coordinate;
      q[c] = std::clamp(q[c], lower_[c], upper_[c]);
    }
    constexpr int kIterations = 200;
    constexpr double kReached = 1e-6, kDamping = 1e-6, kLargestStep = 0.2;
    for (int i = 0; i < kIterations; ++i) {
      Eigen::MatrixXd J;
      const Transform found = Evaluate(q, J);
      Vector6 error;
      error << wanted.translation() - found.translation(),
          RotationVector(wanted.linear() * found.linear().transpose());
      if (!turned_) {
        error.tail<3>().setZero();
        J.bottomRows<3>().setZero();
      }
      if (error.norm() < kReached) return true;
      const Eigen::MatrixXd normal =
          J.transpose() * J + kDamping * Eigen::MatrixXd::Identity(J.cols(), J.cols());
      Eigen::VectorXd step = normal.ldlt().solve(J.transpose() * error);
      step *= std::min(1.0, kLargestStep / std::max(1e-12, step.cwiseAbs().maxCoeff()));
      for (std::size_t k = 0; k < joints_.size(); ++k) {
        const int c = tree_.joints[Size(joints_[k])].coordinate;
        q[c] = std::clamp(q[c] + step[static_cast<Eigen::Index>(k)], lower_[c], upper_[c]);
      }
    }
    return false;
  }

 private:
  Transform Evaluate(const Eigen::VectorXd& q, Eigen::MatrixXd& J) const {
    const std::vector<Transform> poses = LinkTransforms(tree_, q);
    const Eigen::Vector3d end = poses[Size(link_)].translation();
    J.resize(6, static_cast<Eigen::Index>(joints_.size()));
    for (std::size_t k = 0; k < joints_.size(); ++k) {
      const Joint& joint = tree_.joints[Size(joints_[k])];
      const Transform& T = poses[Size(joint.child_link)];
      const Eigen::Vector3d axis = T.linear() * joint.axis;
      const bool turns = joint.type == JointType::kRevolute;
      const auto column = static_cast<Eigen::Index>(k);
      J.col(column).head<3>() = turns ? axis.cross(end - T.translation()) : axis;
      J.col(column).tail<3>() = turns ? axis : Eigen::Vector3d(Eigen::Vector3d::Zero());
      J.col(column) *= joint.multiplier;
    }
    return poses[Size(link_)];
  }

  const RobotTree& tree_;
  int link_;
  bool turned_;
  const std::vector<int>& joints_;
  Eigen::VectorXd lower_, upper_;
};

/// Whether all soles (or balls) are flat at one height; returns that height.
bool Flat(const RobotTree& tree, const std::vector<DraftedSole>& soles, const Eigen::VectorXd& q,
          double& height) {
  constexpr double kFlat = 0.035, kSame = 0.01;
  const std::vector<Transform> poses = LinkTransforms(tree, q);
  double lowest = 1e9, highest = -1e9;
  for (const DraftedSole& sole : soles) {
    const Transform& T = poses[Size(FindLink(tree, sole.link))];
    const bool flat = (T.linear().col(2) - Eigen::Vector3d::UnitZ()).norm() <= kFlat;
    if (!flat && !sole.ball_radius) return false;
    const double lowest_point = T.translation().z() - sole.ball_radius.value_or(0.0);
    lowest = std::min(lowest, lowest_point);
    highest = std::max(highest, lowest_point);
  }
  height = -0.5 * (lowest + highest);
  return !soles.empty() && highest - lowest < kSame;
}

/// The joints of a leg that move no other leg if there are at least six; otherwise all its joints.
std::vector<int> OwnJoints(const RobotTree& tree, const Limbs& limbs, const Limb& leg) {
  const auto is_shared = [&](int joint) {
    const int c = tree.joints[Size(joint)].coordinate;
    return std::any_of(limbs.limbs.begin(), limbs.limbs.end(), [&](const Limb& other) {
      return other.leg && other.tip_body != leg.tip_body &&
             std::any_of(other.joints.begin(), other.joints.end(),
                         [&](int k) { return IsMovedBy(tree.joints[Size(k)], c); });
    });
  };
  std::vector<int> own;
  for (const int joint : leg.joints) {
    if (!is_shared(joint)) own.push_back(joint);
  }
  constexpr std::size_t kOfAPose = 6;
  return own.size() < kOfAPose ? leg.joints : own;
}

/// Largest absolute angle of the joints, rad.
double Bend(const RobotTree& tree, const std::vector<int>& joints, const Eigen::VectorXd& q) {
  double bend = 0.0;
  for (const int k : joints) bend = std::max(bend, std::abs(q[tree.joints[Size(k)].coordinate]));
  return bend;
}

/// `q` with a leg bent at one of its joints, in either direction, so that its foot is in place.
std::optional<Eigen::VectorXd> PlaceBent(const RobotTree& tree, const std::vector<int>& joints,
                                         const Placer& placer, const Transform& wanted,
                                         bool on_ball, const Eigen::VectorXd& q) {
  constexpr double kKnee = 0.8;  // rad; two joints ahead and behind then move by half of it
  constexpr double kFurther = 0.01;
  std::optional<Eigen::VectorXd> placed;
  for (std::size_t knee = 1; knee + 1 < joints.size() && !placed; ++knee) {
    for (const double bend : {kKnee, -kKnee}) {
      Eigen::VectorXd start = q;
      const auto set = [&](std::size_t i, double value) {
        start[tree.joints[Size(joints[i])].coordinate] = value;
      };
      set(knee - 1, -0.5 * bend);
      set(knee, bend);
      set(knee + 1, -0.5 * bend);
      if (!placer.Place(wanted, start)) continue;
      // A leg on a ball can bend in either direction; the more it bends, the further it reaches.
      if (placed && Bend(tree, joints, start) < Bend(tree, joints, *placed) + kFurther) continue;
      placed = start;
      if (!on_ball) break;
    }
  }
  return placed;
}

/// Lowers the root link, with the feet as in the zero posture, as far as the legs allow, by at most
/// a share of their length. Returns whether all feet are in place.
bool BendLegs(const RobotTree& tree, const Limbs& limbs, const std::vector<DraftedSole>& soles,
              double most_drop, Eigen::VectorXd& q) {
  constexpr double kStep = 0.01;
  const auto [lower, upper] = RangesOf(tree, 0.03);
  const auto zero = LinkTransforms(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  for (auto steps = std::lround(most_drop / kStep); steps > 0; --steps) {
    const double drop = kStep * static_cast<double>(steps);
    Eigen::VectorXd bent = q;
    bool all = true;
    for (const DraftedSole& sole : soles) {
      const std::vector<int> joints = OwnJoints(tree, limbs, limbs.limbs[Size(sole.limb)]);
      const int link = FindLink(tree, sole.link);
      Transform wanted = zero[Size(link)];
      const double top = LegTop(tree, limbs.limbs[Size(sole.limb)].joints);
      wanted.translation().z() += drop * (top - wanted.translation().z());
      const Placer placer(tree, link, !sole.ball_radius, joints, lower, upper);
      const auto placed =
          PlaceBent(tree, joints, placer, wanted, sole.ball_radius.has_value(), bent);
      all = all && placed;
      if (placed) bent = *placed;
    }
    if (!all) continue;
    q = bent;
    return true;
  }
  return false;
}

/// Moves each joint outside the legs whose motor cannot hold the weight to the nearest position in
/// which it can, with the root link upright. Returns whether one was moved.
bool LeanIntoTorques(const RobotTree& tree, const Limbs& limbs, Eigen::VectorXd& q) {
  constexpr double kShare = 0.8;
  constexpr int kSteps = 60, kRounds = 3;
  const auto range = RangesOf(tree, 0.05);
  std::vector<bool> leg(Size(tree.coordinate_count()), false);
  for (const Limb& limb : limbs.limbs) {
    for (const int k : limb.joints) {
      if (limb.leg) leg[Size(tree.joints[Size(k)].coordinate)] = true;
    }
  }
  bool moved = false;
  for (int round = 0; round < kRounds; ++round) {
    for (int c = 0; c < tree.coordinate_count(); ++c) {
      const double effort = tree.joints[Size(tree.coordinate_joint[Size(c)])].limits.effort;
      const auto used = [&](double position) {
        Eigen::VectorXd there = q;
        there[c] = position;
        return std::abs(GravityTorques(tree, there)[c]) / effort;
      };
      if (leg[Size(c)] || effort <= 0.0 || used(q[c]) <= kShare) continue;
      const double step = (range.second[c] - range.first[c]) / kSteps;
      for (int i = 1; i <= kSteps; ++i) {
        const double less = q[c] - i * step, more = q[c] + i * step;
        const bool back = less >= range.first[c] && used(less) <= kShare;
        if (!back && !(more <= range.second[c] && used(more) <= kShare)) continue;
        q[c] = back ? less : more;
        moved = true;
        break;
      }
    }
  }
  return moved;
}

bool SameWord(const std::string& name, const std::string& word) {
  std::string letters;
  for (const char c : name) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return letters.find(word) != std::string::npos;
}

/// The state in which robots usually rest, or null.
const std::pair<std::string, std::map<std::string, double>>* UsualState(
    const Semantics& semantics) {
  constexpr std::array kUsual = {"halfsitting", "standing", "stand", "ready",
                                 "home",        "default",  "rest"};
  for (const char* word : kUsual) {
    for (const auto& state : semantics.states) {
      if (SameWord(state.first, word)) return &state;
    }
  }
  return semantics.states.empty() ? nullptr : &semantics.states.front();
}

std::string OutsideLimits(const std::string& state, const Joint& joint, double value) {
  const bool turns = joint.type == JointType::kRevolute;
  const double unit = turns ? kRadiansPerDegree : kMetresPerMm;
  return fmt::format(
      "the state '{}' of the SRDF has joint {} at {:.1f} {}, outside the limits of the URDF, "
      "{:.1f} to {:.1f}; one of the two is wrong",
      state, Quote(joint.name), value / unit, turns ? "deg" : "mm", joint.limits.lower / unit,
      joint.limits.upper / unit);
}

/// The zero posture within limits. A joint with its limit at zero, like many elbows, is bent by
/// another 10 degrees, at most by an eighth of its range: a straight arm is singular, and later
/// corrections of commands need room.
Eigen::VectorXd AwayFromLimits(const RobotTree& tree, const Eigen::VectorXd& lower,
                               const Eigen::VectorXd& upper) {
  constexpr double kRoom = 10.0 * kRadiansPerDegree, kMostShare = 0.125;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(lower.size());
  Eigen::VectorXd room = zero;
  for (Eigen::Index c = 0; c < room.size(); ++c) {
    const Joint& joint = tree.joints[Size(tree.coordinate_joint[static_cast<std::size_t>(c)])];
    if (joint.type != JointType::kRevolute) continue;
    room[c] = std::clamp(kMostShare * (upper[c] - lower[c]), 0.0, kRoom);
  }
  return zero.cwiseMax(lower + room).cwiseMin(upper - room);
}

}  // namespace

RestPosture ChooseRest(const RobotTree& tree, const Limbs& limbs,
                       const std::vector<DraftedSole>& soles, const Semantics& semantics,
                       double drop) {
  constexpr double kMargin = 0.021;
  const auto [lower, upper] = RangesOf(tree, kMargin);
  RestPosture rest;
  // On legs, knees and hands are moved later.
  rest.q = soles.empty() ? AwayFromLimits(tree, lower, upper)
                         : Eigen::VectorXd::Zero(lower.size()).cwiseMax(lower).cwiseMin(upper);
  rest.source = "the zero posture, within the limits";
  if (const auto* state = UsualState(semantics)) {
    Eigen::VectorXd q = rest.q;
    for (const Joint& joint : tree.joints) {
      const auto value = state->second.find(joint.name);
      if (value == state->second.end() || joint.mimic) continue;
      if (!(value->second >= joint.limits.lower && value->second <= joint.limits.upper)) {
        rest.warnings.push_back(OutsideLimits(state->first, joint, value->second));
      }
      const auto [least, most] = PostureRange(joint, kMargin, value->second);
      q[joint.coordinate] = std::clamp(value->second, least, most);
    }
    rest.q = q;
    rest.source = "the state '" + state->first + "' of the SRDF";
  }
  rest.stands = Flat(tree, soles, rest.q, rest.root_height);
  double bend = 0.0;
  for (const DraftedSole& sole : soles) {
    bend = std::max(bend, Bend(tree, limbs.limbs[Size(sole.limb)].joints, rest.q));
  }
  if (LeanIntoTorques(tree, limbs, rest.q)) {
    rest.source += ", leaning where motors could not hold the weight otherwise";
  }
  constexpr double kLeastBend = 0.3;
  if (!soles.empty() && (!rest.stands || bend < kLeastBend || drop > kUsualDrop) &&
      BendLegs(tree, limbs, soles, drop, rest.q)) {
    rest.source += ", with bent knees";
    rest.stands = Flat(tree, soles, rest.q, rest.root_height);
  }
  return rest;
}

std::pair<Eigen::VectorXd, Eigen::VectorXd> RangesOf(const RobotTree& tree, double margin) {
  Eigen::VectorXd lower(tree.coordinate_count()), upper(tree.coordinate_count());
  for (int i = 0; i < tree.coordinate_count(); ++i) {
    std::tie(lower[i], upper[i]) =
        PostureRange(tree.joints[Size(tree.coordinate_joint[Size(i)])], margin);
  }
  return {lower, upper};
}

}  // namespace elastocal
