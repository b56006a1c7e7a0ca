// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/postures.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr double kDescribedHeight = 1.083;  // m, of the robot to which PostureOptions belong

/// Range of a coordinate without the margin.
std::pair<double, double> Range(const RobotTree& tree, int coordinate, double margin) {
  return PostureRange(tree.joints[Size(tree.coordinate_joint[Size(coordinate)])], margin);
}

/// Coordinates of joints, without mimic joints.
std::vector<int> CoordinatesOf(const RobotTree& tree, const std::vector<int>& joints) {
  std::vector<int> coordinates;
  for (int k : joints) {
    if (!tree.joints[Size(k)].mimic) coordinates.push_back(tree.joints[Size(k)].coordinate);
  }
  return coordinates;
}

/// Tolerance of a leg's pose, m and rad: a leg that shares joints or has fewer than six cannot
/// reach all poses.
double PlacementTolerance(const RobotTree& tree, const Leg& leg) {
  return CoordinatesOf(tree, leg.joints).size() < 6 ? 0.1 : 1e-8;
}

using Twist = Eigen::Matrix<double, 6, 1>;

/// Displacement [m, rad] from `found` to `wanted`.
Twist PoseError(const Transform& wanted, const Transform& found) {
  Twist error;
  error.head<3>() = wanted.translation() - found.translation();
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(wanted.linear() * found.linear().transpose()));
  error.tail<3>() = turn.angle() * turn.axis();
  return error;
}

}  // namespace

Eigen::VectorXd HomePosture(const RobotTree& tree, const PostureOptions& options) {
  Eigen::VectorXd q = Eigen::VectorXd::Zero(tree.coordinate_count());
  for (int i = 0; i < q.size(); ++i) {
    const auto [lower, upper] = Range(tree, i, options.limit_margin);
    q[i] = std::clamp(0.0, lower, std::max(lower, upper));
  }
  return q;
}

std::optional<Eigen::VectorXd> PlaceFoot(const RobotTree& tree, const Leg& leg,
                                         const Transform& T_waist_foot, Eigen::VectorXd q,
                                         double tolerance) {
  constexpr int kIterations = 50;
  constexpr double kStep = 1e-6;
  constexpr double kDamping = 1e-6;
  constexpr double kLargestMove = 0.3;
  constexpr double kNoMove = 1e-7;
  const std::vector<int> moved = CoordinatesOf(tree, leg.joints);
  const auto count = static_cast<Eigen::Index>(moved.size());
  bool stuck = false;
  for (int iteration = 0;; ++iteration) {
    const Transform found = LinkTransforms(tree, q)[Size(leg.foot_link)];
    const Twist error = PoseError(T_waist_foot, found);
    stuck = stuck || iteration == kIterations;
    if (error.norm() < 1e-9 || (stuck && error.norm() < tolerance)) return q;
    if (stuck) return std::nullopt;
    Eigen::Matrix<double, 6, Eigen::Dynamic> J(6, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      Eigen::VectorXd moved_q = q;
      moved_q[moved[static_cast<std::size_t>(i)]] += kStep;
      J.col(i) = PoseError(LinkTransforms(tree, moved_q)[Size(leg.foot_link)], found) / kStep;
    }
    Eigen::MatrixXd normal = J.transpose() * J;
    normal.diagonal().array() += kDamping;
    Eigen::VectorXd step = normal.ldlt().solve(J.transpose() * error);
    step *= std::min(1.0, kLargestMove / std::max(1e-12, step.cwiseAbs().maxCoeff()));
    const Eigen::VectorXd before = q;
    for (Eigen::Index i = 0; i < count; ++i) {
      const int coordinate = moved[static_cast<std::size_t>(i)];
      const auto [lower, upper] = Range(tree, coordinate, 0.0);
      q[coordinate] = std::clamp(q[coordinate] + step[i], lower, upper);
    }
    stuck = (q - before).cwiseAbs().maxCoeff() < kNoMove;
  }
}

PostureSampler::PostureSampler(const RobotTree& tree, const std::vector<Leg>& legs,
                               const PostureOptions& options, std::uint64_t seed)
    : tree_(tree),
      legs_(legs),
      options_(options),
      random_(seed),
      inertias_(BodyInertias(tree)),
      T_root_link_zero_(LinkTransforms(tree, Eigen::VectorXd::Zero(tree.coordinate_count()))),
      height_(StandingHeight(tree, legs)),
      scale_(height_ > 0.0 ? height_ / kDescribedHeight : 1.0),
      stand_(HomePosture(tree, options)) {
  for (const Leg& leg : legs_) {
    if (const auto bent = Bend(leg, stand_, 0.5 * (options_.least_drop + options_.largest_drop))) {
      stand_ = *bent;
    } else {
      stands_ = false;
    }
  }
  stands_ = stands_ && legs_.size() <= 2 && StandsOnEither();
}

bool PostureSampler::StandsOnEither() {
  constexpr int kTries = 20000;
  if (legs_.size() < 2) return true;
  const Random before = random_;
  const bool stands = TryDrawSwing(stand_, legs_[0], legs_[1], kTries).has_value() &&
                      TryDrawSwing(stand_, legs_[1], legs_[0], kTries).has_value();
  random_ = before;
  return stands;
}

std::optional<Eigen::VectorXd> PostureSampler::Bend(const Leg& leg, Eigen::VectorXd q,
                                                    double drop) {
  constexpr int kTries = 200;
  Transform T_waist_foot = T_root_link_zero_[Size(leg.foot_link)];
  T_waist_foot.translation().z() += drop * height_;
  // A straight leg is singular, and a leg can bend in several ways; so the search begins at random
  // near straight.
  for (int i = 0; i < kTries; ++i) {
    for (int coordinate : CoordinatesOf(tree_, leg.joints)) {
      const auto [lower, upper] = Range(tree_, coordinate, options_.limit_margin);
      q[coordinate] = std::clamp(random_.Uniform(-0.8, 0.8), lower, upper);
    }
    if (auto found = PlaceFoot(tree_, leg, T_waist_foot, q, PlacementTolerance(tree_, leg)))
      return found;
  }
  return std::nullopt;
}

void PostureSampler::DrawJoints(const std::vector<int>& joints, Eigen::VectorXd& q) {
  for (int coordinate : CoordinatesOf(tree_, joints)) {
    const auto [lower, upper] = Range(tree_, coordinate, options_.limit_margin);
    q[coordinate] = random_.Uniform(lower, upper);
  }
}

bool PostureSampler::InWorkspace(const EndWorkspace& workspace, int tip,
                                 const Eigen::VectorXd& q) const {
  const Transform& T_zero = T_root_link_zero_[Size(tip)];
  const Transform T = LinkTransforms(tree_, q)[Size(tip)];
  Eigen::Vector3d p = T.translation();
  if (T_zero.translation().y() < 0.0) p.y() = -p.y();
  return (p.array() >= scale_ * workspace.lower.array()).all() &&
         (p.array() <= scale_ * workspace.upper.array()).all() &&
         RotationAngle(T_zero.linear().transpose() * T.linear()) <= workspace.largest_turn;
}

bool PostureSampler::ArmApart(const NamedChain& chain, const Eigen::VectorXd& q) const {
  // Elbow, wrist and hand must be this far from the axis of the trunk, m.
  constexpr double kTrunkRadius = 0.18;
  const std::vector<Transform> T_root_link = LinkTransforms(tree_, q);
  const std::vector<int> joints = JointsToBody(tree_, tree_.links[Size(chain.tip_link)].body);
  for (std::size_t i = joints.size() / 2 + 1; i < joints.size(); ++i) {
    const int link = tree_.joints[Size(joints[i])].child_link;
    if (T_root_link[Size(link)].translation().head<2>().norm() < scale_ * kTrunkRadius)
      return false;
  }
  return true;
}

Eigen::VectorXd PostureSampler::DrawUpper(const NamedChain& chain) {
  constexpr int kTries = 5000;
  std::vector<int> joints = JointsToBody(tree_, tree_.links[Size(chain.tip_link)].body);
  const std::vector<int> before = JointsToBody(tree_, tree_.links[Size(chain.from_link)].body);
  joints.erase(joints.begin(), joints.begin() + static_cast<std::ptrdiff_t>(before.size()));
  const bool arm = static_cast<int>(joints.size()) >= options_.arm_joints;
  Eigen::VectorXd q = stand_;
  for (int i = 0; i < kTries; ++i) {
    DrawJoints(joints, q);
    if (!arm || (InWorkspace(options_.hand, chain.tip_link, q) && ArmApart(chain, q))) break;
  }
  return q;
}

bool PostureSampler::SwingFeasible(const Eigen::VectorXd& q, const Leg& swing,
                                   const Leg& support) const {
  const std::vector<Transform> T_root_link = LinkTransforms(tree_, q);
  const Eigen::Vector3d p_sole_swing =
      support.R_floor_foot * (T_root_link[Size(support.foot_link)].inverse() *
                              T_root_link[Size(swing.foot_link)].translation());
  if (p_sole_swing.z() < scale_ * options_.ground_clearance) return false;
  // Only joints from the knee on are checked: the hips are fixed to the waist.
  for (std::size_t i = swing.joints.size() / 2; i < swing.joints.size(); ++i) {
    for (std::size_t j = support.joints.size() / 2; j < support.joints.size(); ++j) {
      const auto& a = T_root_link[Size(tree_.joints[Size(swing.joints[i])].child_link)];
      const auto& b = T_root_link[Size(tree_.joints[Size(support.joints[j])].child_link)];
      if ((a.translation() - b.translation()).norm() < scale_ * options_.least_distance)
        return false;
    }
  }
  return true;
}

bool PostureSampler::KneeBent(const Leg& leg, const Eigen::VectorXd& q) const {
  const auto bend = [&](int k, const Eigen::VectorXd& posture) {
    return std::abs(JointPosition(tree_.joints[Size(k)], posture));
  };
  const int knee = *std::max_element(leg.joints.begin(), leg.joints.end(), [&](int a, int b) {
    return bend(a, stand_) < bend(b, stand_);
  });
  return bend(knee, q) >= options_.least_bend && bend(knee, q) <= options_.largest_bend;
}

std::optional<Eigen::VectorXd> PostureSampler::DrawSupport(Eigen::VectorXd q, const Leg& swing,
                                                           const Leg& support) {
  constexpr int kBalanceSteps = 4;
  const double drop = random_.Uniform(options_.least_drop, options_.largest_drop);
  const auto lean = [&] { return random_.Uniform(-options_.largest_lean, options_.largest_lean); };
  const double roll = lean();
  const double pitch = lean();
  const double yaw = random_.Uniform(-options_.largest_turn, options_.largest_turn);
  const Eigen::Vector2d aim(scale_ * random_.Uniform(-options_.sway.x(), options_.sway.x()),
                            scale_ * random_.Uniform(-options_.sway.y(), options_.sway.y()));
  // Attitude of the waist over the sole, in axes of the floor.
  const Eigen::Matrix3d R_floor_waist = (RotZ(yaw) * RotY(pitch) * RotX(roll)).linear();
  Eigen::Vector3d p_floor_waist = -T_root_link_zero_[Size(support.foot_link)].translation() -
                                  Eigen::Vector3d(0, 0, drop * height_);
  for (int i = 0; i < kBalanceSteps; ++i) {
    const Eigen::Vector3d com = p_floor_waist + R_floor_waist * CentreOfMass(tree_, inertias_, q);
    p_floor_waist.head<2>() += aim - com.head<2>();
    Transform T_floor_waist = Transform::Identity();
    T_floor_waist.linear() = R_floor_waist;
    T_floor_waist.translation() = p_floor_waist;
    Transform T_waist_foot = T_floor_waist.inverse() * Transform(support.R_floor_foot);
    auto placed = PlaceFoot(tree_, support, T_waist_foot, q, PlacementTolerance(tree_, support));
    if (!placed) return std::nullopt;
    q = *placed;
  }
  if (!KneeBent(support, q) || !SwingFeasible(q, swing, support)) return std::nullopt;
  return q;
}

std::optional<Eigen::VectorXd> PostureSampler::TryDrawSwing(Eigen::VectorXd q, const Leg& swing,
                                                            const Leg& support, int tries) {
  for (int i = 0; i < tries; ++i) {
    DrawJoints(swing.joints, q);
    if (!InWorkspace(options_.foot, swing.foot_link, q)) continue;
    if (auto found = DrawSupport(q, swing, support)) return found;
  }
  return std::nullopt;
}

Eigen::VectorXd PostureSampler::DrawSwing(const Eigen::VectorXd& q, const Leg& swing,
                                          const Leg& support) {
  constexpr int kTries = 200000;
  if (const auto found = TryDrawSwing(q, swing, support, kTries)) return *found;
  throw InputError("no posture found in which '" + support.chain +
                   "' supports the robot and the foot of '" + swing.chain +
                   "' is in its workspace");
}

}  // namespace elastocal
