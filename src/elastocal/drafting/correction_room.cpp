// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/correction_room.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "elastocal/calibration/options.hpp"
#include "elastocal/drafting/body_shapes.hpp"
#include "elastocal/drafting/limb_names.hpp"
#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/robot/jacobian.hpp"
#include "elastocal/robot/moving_chain.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

/// A line in the root link's frame.
struct Line {
  Eigen::Vector3d point, direction;
};

/// The point that is nearest to all lines; along directions that they leave open, that near `open`.
Eigen::Vector3d MeetingPoint(const std::vector<Line>& lines, const Eigen::Vector3d& open) {
  constexpr double kWeak = 1e-4;
  Eigen::Matrix3d normal = kWeak * Eigen::Matrix3d::Identity();
  Eigen::Vector3d right = kWeak * open;
  for (const Line& line : lines) {
    const Eigen::Matrix3d across =
        Eigen::Matrix3d::Identity() - line.direction * line.direction.transpose();
    normal += across;
    right += across * line.point;
  }
  return normal.inverse() * right;
}

/// The joints of a limb that do not move the body on which it begins.
std::vector<int> JointsBeyondTrunk(const RobotTree& tree, const Limb& limb) {
  const auto begin = std::find_if(limb.joints.begin(), limb.joints.end(), [&](int k) {
    return tree.joints[Size(k)].parent_body == limb.from_body;
  });
  return {begin, limb.joints.end()};
}

/// The robot with motors that carry these loads, for its prior. A smaller effort cannot be that of
/// the joint (it is a placeholder, or that of a motor before its gear), and the prior would make
/// the joint too soft.
RobotTree WithAbleMotors(RobotTree tree, const JointLoads& loads) {
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    double& effort = tree.joints[k].limits.effort;
    if (effort > 0.0) effort = std::max(effort, std::abs(loads(2, static_cast<Eigen::Index>(k))));
  }
  return tree;
}

using Effects = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Effects of the errors on each link, a column for each error at one standard deviation of the
/// prior: rotation, rad, above the displacement of the link's origin, m.
std::vector<Effects> ErrorEffects(const RobotTree& tree, const std::vector<int>& links,
                                  const Eigen::VectorXd& q, int fixed_link) {
  Elasticity elasticity;
  for (int k = 0; k < static_cast<int>(tree.joints.size()); ++k) elasticity.torsion.push_back(k);
  std::vector<Marker> origins;
  for (std::size_t i = 0; i < links.size(); ++i) {
    origins.push_back({std::to_string(i), links[i], Eigen::Vector3d::Zero()});
  }
  const ErrorModel model = MakeErrorModel(tree, std::move(origins), {}, elasticity);
  const Geometry geometry = ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
  GeneralizedJacobian jacobian(model);
  const JointLoads loads = GravityLoads(model, geometry, q, kGravity, fixed_link);
  jacobian.Evaluate(geometry, q, loads);
  const Prior prior;
  const RobotTree able = WithAbleMotors(tree, loads);
  std::vector<Effects> effects;
  for (int i = 0; i < model.marker_count(); ++i) {
    effects.emplace_back(Effects::Zero(6, model.parameter_count()));
    for (const int column : jacobian.Columns(i)) {
      const Parameter& parameter = model.parameters[Size(column)];
      if (parameter.joint < 0) continue;  // where the robot is, and the point itself
      const Vector6d screw = prior.Of(able, parameter) * jacobian.Screw(column);
      const Eigen::Vector3d turn = screw.head<3>(), p = jacobian.Position(i);
      effects.back().col(column) << turn, turn.cross(p) + screw.tail<3>();
    }
  }
  return effects;
}

int FixedLinkOf(const Limb& limb) { return limb.leg ? limb.tip_link : 0; }

/// The motion of a link by the coordinates of a chain: rotation above displacement.
Eigen::MatrixXd LinkJacobian(const MovingChain& chain, int link) {
  Eigen::MatrixXd J(6, chain.size());
  J << chain.RotationJacobian(link),
      chain.PointJacobian(link, chain.link_poses()[Size(link)].translation());
  return J;
}

constexpr double kArm = 0.3;  // m: as much as a radian

/// Least changes of joints that undo the effects on the end of a limb, whose Jacobian is `J`.
Eigen::MatrixXd Undo(Eigen::MatrixXd J, Effects effects) {
  constexpr double kLeast = 1e-6;  // of squared singular values
  J.bottomRows<3>() /= kArm;
  effects.bottomRows<3>() /= kArm;
  const SymmetricDecomposition squares = DecomposeSymmetric(J * J.transpose());
  const Eigen::VectorXd inverse =
      squares.values.unaryExpr([](double v) { return v > kLeast ? 1.0 / v : 0.0; });
  return -J.transpose() *
         (squares.vectors * inverse.asDiagonal() * (squares.vectors.transpose() * effects));
}

constexpr double OneDirection(double norm) { return norm * 0.57735026918962576; }  // 1 / sqrt(3)

}  // namespace

double ExpectedDisplacement(const RobotTree& tree, int link, const Eigen::VectorXd& q,
                            int fixed_link) {
  const std::vector<Effects> effects = ErrorEffects(tree, {link}, q, fixed_link);
  return OneDirection(effects[0].bottomRows<3>().norm());
}

ExpectedCorrection ExpectCorrection(const RobotTree& tree, const Limb& limb,
                                    const Eigen::VectorXd& q) {
  std::vector<int> links;
  for (const int k : limb.joints) links.push_back(tree.joints[Size(k)].child_link);
  links.push_back(limb.tip_link);
  const std::vector<Effects> effects = ErrorEffects(tree, links, q, FixedLinkOf(limb));
  const std::vector<int> coordinates = ChainCoordinates(tree, 0, limb.tip_link);
  MovingChain chain(tree, coordinates, q);
  chain.Move(q(coordinates));
  const Eigen::MatrixXd undo = Undo(LinkJacobian(chain, limb.tip_link), effects.back());
  ExpectedCorrection expected;
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    expected.joints[coordinates[i]] = undo.row(static_cast<Eigen::Index>(i)).norm();
  }
  for (std::size_t i = 0; i + 1 < links.size(); ++i) {
    const Eigen::MatrixXd left = effects[i] + LinkJacobian(chain, links[i]) * undo;
    expected.displacement =
        std::max(expected.displacement, OneDirection(left.bottomRows<3>().norm()));
  }
  return expected;
}

ExpectedCorrection TypicalCorrection(const RobotTree& tree, const Limb& limb,
                                     const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                     const Eigen::VectorXd& q) {
  constexpr std::size_t kPostures = 61;
  Random random(1);
  std::map<int, std::vector<double>> joints;
  std::vector<double> displacements;
  for (std::size_t i = 0; i < kPostures; ++i) {
    Eigen::VectorXd drawn = q;
    for (const int c : ChainCoordinates(tree, 0, limb.tip_link)) {
      drawn[c] = random.Uniform(lower[c], upper[c]);
    }
    const ExpectedCorrection one = ExpectCorrection(tree, limb, drawn);
    for (const auto& [c, sd] : one.joints) joints[c].push_back(sd);
    displacements.push_back(one.displacement);
  }
  const auto median = [](std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + kPostures / 2, values.end());
    return values[kPostures / 2];
  };
  ExpectedCorrection typical;
  typical.displacement = median(displacements);
  for (const auto& [c, sds] : joints) typical.joints[c] = median(sds);
  return typical;
}

double RoomSds(std::size_t count) {
  constexpr double kExceeded = 0.05, kMany = 1e6;  // degrees of freedom: a normal distribution
  return StudentQuantile(1.0 - kExceeded / static_cast<double>(count), kMany);
}

std::vector<const Limb*> CorrectedLimbs(const RobotTree& tree, const Limbs& limbs) {
  constexpr std::size_t kLeastJoints = 4;
  std::vector<const Limb*> corrected;
  for (const Limb& limb : limbs.limbs) {
    if (JointsBeyondTrunk(tree, limb).size() < kLeastJoints) continue;
    if (!IsHeadByNames(tree, limb)) corrected.push_back(&limb);
  }
  return corrected;
}

Hinge FindHinge(const RobotTree& tree, const Limb& limb, const Eigen::VectorXd& q) {
  constexpr std::size_t kOfABall = 3;
  constexpr double kShortest = 0.25;  // of the longer part
  const std::vector<int> own = JointsBeyondTrunk(tree, limb);
  Hinge found;
  const std::vector<Transform> poses = BodyPoses(tree, q);
  const auto line = [&](int k) {
    const Transform& T = poses[Size(k) + 1];
    return Line{T.translation(), T.linear() * tree.joints[Size(k)].axis};
  };
  const Eigen::Vector3d tip = LinkTransforms(tree, q)[Size(limb.tip_link)].translation();
  for (std::size_t i = 1; i < own.size(); ++i) {
    const Joint& joint = tree.joints[Size(own[i])];
    if (joint.type != JointType::kRevolute || joint.mimic || joint.multiplier == 0.0) continue;
    std::vector<Line> before, after;
    for (std::size_t k = i - std::min(i, kOfABall); k < i; ++k) before.push_back(line(own[k]));
    for (std::size_t k = i + 1; k < std::min(own.size(), i + 1 + kOfABall); ++k) {
      after.push_back(line(own[k]));
    }
    const Line axis = line(own[i]);
    const auto from_axis = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
      const Eigen::Vector3d d = p - axis.point;
      return d - d.dot(axis.direction) * axis.direction;
    };
    const Eigen::Vector3d back = from_axis(MeetingPoint(before, before.front().point));
    const Eigen::Vector3d ahead = from_axis(MeetingPoint(after, tip));
    const double upper = back.norm(), lower = ahead.norm();
    if (std::min(upper, lower) < kShortest * std::max(upper, lower)) continue;
    if (std::min(upper, lower) <= std::min(found.upper, found.lower)) continue;
    const double bent = std::atan2(axis.direction.dot(ahead.cross(back)), -back.dot(ahead));
    found = {own[i], q[joint.coordinate] - bent / joint.multiplier, upper, lower};
  }
  return found;
}

double BendForLength(const Hinge& hinge, double length) {
  const double a = hinge.upper, b = hinge.lower;
  const double distance = std::max(a + b - length, std::abs(a - b));
  return std::acos(std::clamp((distance * distance - a * a - b * b) / (2.0 * a * b), -1.0, 1.0));
}

std::vector<BentRange> BentRanges(const RobotTree& tree, const Limbs& limbs,
                                  const Eigen::VectorXd& q) {
  constexpr double kEitherWay = 0.25, kLeastKept = 0.5;  // of a range
  std::vector<BentRange> ranges;
  const std::vector<const Limb*> corrected = CorrectedLimbs(tree, limbs);
  for (const Limb* of : corrected) {
    const Limb& limb = *of;
    const Hinge hinge = FindHinge(tree, limb, q);
    if (hinge.joint < 0) continue;
    const Joint& joint = tree.joints[Size(hinge.joint)];
    const auto [lower, upper] = PostureRange(joint, 0.0, q[joint.coordinate]);
    const double range = upper - lower, turn = 2.0 * M_PI / std::abs(joint.multiplier);
    const double turns = std::round((hinge.straight - 0.5 * (lower + upper)) / turn);
    const double straight = hinge.straight - turn * turns;
    const bool above = upper - straight > straight - lower;
    if ((above ? straight - lower : upper - straight) > kEitherWay * range) continue;
    const double length =
        RoomSds(corrected.size()) * ExpectedDisplacement(tree, limb.tip_link, q, FixedLinkOf(limb));
    const double bend = BendForLength(hinge, length) / std::abs(joint.multiplier);
    const double most = (1.0 - kLeastKept) * range;
    BentRange bent{joint.coordinate, limb.leg, {lower, upper}};
    if (above) {
      bent.range[0] = std::max(lower, std::min(straight + bend, lower + most));
    } else {
      bent.range[1] = std::min(upper, std::max(straight - bend, upper - most));
    }
    if (bent.range[1] - bent.range[0] < range) ranges.push_back(bent);
  }
  return ranges;
}

}  // namespace elastocal
