// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/stand_through.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

constexpr double kLongestSettling = 4.0;  // s
constexpr double kLook = 0.01;            // s between two looks at the robot
constexpr double kLoaded = 0.05;  // share of the vertical force above which a sole is loaded

/// The samples before and after a time, and the share of the second one. `at` moves along with the
/// time.
struct Between {
  Eigen::Index at = 0;
  double share = 0.0;

  Eigen::VectorXd Of(const Eigen::MatrixXd& q) const {
    return (q.row(at) + share * (q.row(at + 1) - q.row(at))).transpose();
  }
};

void MoveTo(const JointMotion& motion, double time_s, Between& between) {
  Eigen::Index& at = between.at;
  while (at + 2 < motion.time_s.size() && motion.time_s[at + 1] <= time_s) ++at;
  const double span = motion.time_s[at + 1] - motion.time_s[at];
  between.share = std::clamp((time_s - motion.time_s[at]) / span, 0.0, 1.0);
}

/// Contact forces, averaged over the latest looks at the robot with the present planned support.
class AverageContact {
 public:
  explicit AverageContact(std::size_t looks) : looks_(looks) {}

  void Add(const VirtualRobot& body, std::size_t soles, const std::vector<int>& support) {
    if (support != support_) latest_.clear();
    support_ = support;
    const auto [force, moment] = body.FloorWrench();
    Eigen::VectorXd now(6 + static_cast<Eigen::Index>(soles));
    now << force, moment, Eigen::VectorXd::Zero(now.size() - 6);
    for (std::size_t i = 0; i < soles; ++i) {
      const int sole = static_cast<int>(i);
      now[6 + sole] = body.SolePose(sole).linear().row(2).dot(body.SoleWrench(sole).head<3>());
    }
    latest_.push_back(std::move(now));
    if (latest_.size() > looks_) latest_.pop_front();
  }

  /// Whether there are at least half of all looks, so that the first touch of a sole counts little.
  bool Tells() const { return 2 * latest_.size() >= looks_; }

  /// Distance of the zero-moment point to the edge of the loaded soles, m.
  double ZmpMargin(const VirtualRobot& body, const std::vector<Sole>& soles) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(latest_.front().size());
    for (const Eigen::VectorXd& look : latest_) sum += look;
    std::vector<Sole> standing;
    std::vector<Transform> T_world_sole;
    for (std::size_t i = 0; i < soles.size(); ++i) {
      if (!(sum[6 + static_cast<Eigen::Index>(i)] > kLoaded * sum[2])) continue;
      standing.push_back(soles[i]);
      T_world_sole.push_back(body.SolePose(static_cast<int>(i)));
    }
    if (standing.empty()) return -std::numeric_limits<double>::infinity();
    return InsideMargin(SupportPolygon(standing, T_world_sole),
                        ZeroMomentPoint(sum.head<3>(), sum.segment<3>(3)));
  }

 private:
  std::size_t looks_;
  std::vector<int> support_;
  std::deque<Eigen::VectorXd>
      latest_;  // floor: force, moment; force on each sole along the vertical
};

/// The hands of those who put a robot down. They turn its waist upright by the moment of a spring,
/// which could hold twice its weight, and of a damper, in the world's axes.
class Hands {
 public:
  /// `height` is that of the part that they hold, m.
  Hands(const TrueRobot& robot, const VirtualRobot& body, double height)
      : stiffness_(2.0 * TotalMass(robot.tree) * kGravity.norm() * height),
        before_(body.WaistPose().linear()) {}

  Vector6d Hold(const VirtualRobot& body, double interval_s) {
    constexpr double kDamping = 0.15;  // s
    const Eigen::Matrix3d R = body.WaistPose().linear();
    const Eigen::Vector3d lean = Eigen::Vector3d::UnitZ().cross(R.col(2));
    const Eigen::Vector3d speed = RotationVector(R * before_.transpose()) / interval_s;
    before_ = R;
    Vector6d wrench = Vector6d::Zero();
    wrench.tail<3>() = -stiffness_ * (lean + kDamping * speed);
    return wrench;
  }

 private:
  double stiffness_;  // N.m/rad
  Eigen::Matrix3d before_;
};

/// `R_root_unit`: how the inertial unit is mounted.
StandingSense Sense(const VirtualRobot& body, std::size_t soles,
                    const Eigen::Matrix3d& R_root_unit) {
  StandingSense sense;
  sense.R_world_root = body.WaistPose().linear() * R_root_unit;
  sense.wrenches.resize(6, static_cast<Eigen::Index>(soles));
  for (Eigen::Index i = 0; i < sense.wrenches.cols(); ++i) {
    sense.wrenches.col(i) = body.SoleWrench(static_cast<int>(i));
  }
  return sense;
}

double TrackingError(const TrueRobot& robot, const Eigen::VectorXd& encoders,
                     const Eigen::VectorXd& command) {
  double largest = 0.0;
  for (std::size_t k = 0; k < robot.tree.joints.size(); ++k) {
    const double wanted = JointPosition(robot.tree.joints[k], command);
    largest = std::max(largest, std::abs(encoders[static_cast<Eigen::Index>(k)] - wanted));
  }
  return largest;
}

/// A robot that stands by itself while it plays a motion.
class StandingPlay {
 public:
  StandingPlay(const TrueRobot& robot, const std::vector<Sole>& soles, const JointMotion& motion,
               const PhysicsOptions& physics, const StandThroughOptions& options)
      : robot_(robot),
        soles_(soles),
        motion_(motion),
        options_(options),
        commanded_(options.commanded != nullptr ? *options.commanded : motion.q),
        body_(robot, FeetOf(soles), commanded_.row(0).transpose(), physics),
        height_(body_.Height()),
        per_look_(std::max(1L, std::lround(kLook / body_.time_step_s()))),
        interval_s_(static_cast<double>(per_look_) * body_.time_step_s()),
        contact_(
            Size(std::max(1L, std::lround(std::sqrt(height_ / kGravity.norm()) / interval_s_)))),
        correction_(Eigen::VectorXd::Zero(motion.q.cols())) {}

  StandingRun Run() {
    if (options_.stabiliser == nullptr || options_.R_world_root_at_rest) {
      Settle();
    } else {
      LetGo();
    }
    return Play();
  }

 private:
  static std::vector<int> FeetOf(const std::vector<Sole>& soles) {
    std::vector<int> feet;
    for (const Sole& sole : soles) feet.push_back(sole.link);
    return feet;
  }

  StandingSense Felt() const { return Sense(body_, soles_.size(), R_root_unit_); }

  void Correct(Eigen::Index sample, const Eigen::VectorXd& planned) {
    const std::vector<int>& support = motion_.support[static_cast<std::size_t>(sample)];
    correction_ = options_.stabiliser->Correct(planned, support, Felt(), interval_s_) - planned;
  }

  /// Lets the robot come to rest in the first posture. If R_world_root_at_rest is given, the
  /// mounting of the inertial unit and the error of masses follow from this rest.
  void Settle() {
    body_.Settle(kLongestSettling);
    if (!options_.R_world_root_at_rest) return;
    R_root_unit_ = body_.WaistPose().linear().transpose() * *options_.R_world_root_at_rest;
    if (options_.stabiliser == nullptr) return;
    options_.stabiliser->TakeRest(motion_.q.row(0).transpose(), motion_.support.front(), Felt());
  }

  /// The hands let go slowly, so that a robot with errors stands by itself at the end.
  void LetGo() {
    Hands hands(robot_, body_, height_);
    const long looks = std::lround(kLongestSettling / interval_s_);
    for (long i = 0; i < looks; ++i) {
      const double held = 1.0 - static_cast<double>(i + 1) / static_cast<double>(looks);
      body_.Command(commanded_.row(0).transpose() + correction_);
      for (long step = 0; step < per_look_; ++step) {
        body_.PushWaist(held * hands.Hold(body_, body_.time_step_s()));
        body_.Step();
      }
      Correct(0, motion_.q.row(0).transpose());
    }
    body_.PushWaist(Vector6d::Zero());
  }

  StandingRun Play() {
    const Transform begin = body_.WaistPose();
    StandingRun run;
    run.least_zmp_margin = std::numeric_limits<double>::infinity();
    const double first = motion_.time_s[0], last = motion_.time_s[motion_.time_s.size() - 1];
    const auto steps = static_cast<long>(std::floor((last - first) / body_.time_step_s()));
    Between now;
    for (long i = 1; i <= steps; ++i) {
      run.time_s = static_cast<double>(i) * body_.time_step_s();
      MoveTo(motion_, first + run.time_s, now);
      body_.Command(now.Of(commanded_) + correction_);
      body_.Step();
      if (i % per_look_ != 0) continue;
      if (body_.FallenFrom(height_)) {
        // The robot fell before the contact forces were averaged.
        constexpr double kNever = std::numeric_limits<double>::infinity();
        if (run.least_zmp_margin == kNever) run.least_zmp_margin = -kNever;
        return run;
      }
      Look(begin, now, run);
    }
    run.stood = true;
    return run;
  }

  /// Measures the robot, every hundredth of a second, and lets the stabiliser correct it.
  void Look(const Transform& begin, const Between& now, StandingRun& run) {
    const double upright = body_.WaistPose().linear().col(2).dot(begin.linear().col(2));
    run.largest_lean = std::max(run.largest_lean, std::acos(std::clamp(upright, -1.0, 1.0)));
    run.tracking = std::max(
        run.tracking, TrackingError(robot_, body_.Encoders(), now.Of(commanded_) + correction_));
    contact_.Add(body_, soles_.size(), motion_.support[Size(now.at)]);
    if (contact_.Tells()) {
      run.least_zmp_margin = std::min(run.least_zmp_margin, contact_.ZmpMargin(body_, soles_));
    }
    const Eigen::VectorXd planned = now.Of(motion_.q);
    if (options_.watch) options_.watch(now.at, planned, body_);
    if (options_.stabiliser == nullptr) return;
    Correct(now.at, planned);
    run.largest_shift = std::max(run.largest_shift, options_.stabiliser->shift().norm());
  }

  const TrueRobot& robot_;
  const std::vector<Sole>& soles_;
  const JointMotion& motion_;
  const StandThroughOptions& options_;
  const Eigen::MatrixXd& commanded_;
  VirtualRobot body_;
  double height_;  // VirtualRobot::Height() at the beginning, m
  long per_look_;  // steps of the simulation between two looks
  double interval_s_;
  AverageContact contact_;
  Eigen::Matrix3d R_root_unit_ = Eigen::Matrix3d::Identity();
  Eigen::VectorXd correction_;  // what the stabiliser adds to the commands
};

}  // namespace

StandingRun StandThrough(const TrueRobot& robot, const std::vector<Sole>& soles,
                         const JointMotion& motion, PhysicsOptions physics,
                         const StandThroughOptions& options) {
  physics.standing = Standing::kFree;
  physics.soles = soles;
  return StandingPlay(robot, soles, motion, physics, options).Run();
}

}  // namespace elastocal
