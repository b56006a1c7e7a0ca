// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/clock_by_positions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/lag_change.hpp"
#include "elastocal/measurement/standing_kinematics.hpp"

namespace elastocal {
namespace {

constexpr int kMostMoments = 400;        // errors of the robot, not noise, limit the lag
constexpr double kBlock_s = 2.0;         // about the time in which a joint passes a posture
constexpr int kPasses = 3;               // the first change of the lag may be of tens of ms
constexpr double kUnchanged_s = 2e-3;    // at usual accelerations, 10 um off a straight line
constexpr double kWorthKnowing = 30e-6;  // largest sd of a drift: clocks drift about as much
constexpr double kClearly = 0.5;         // largest ratio of the residuals at the two lags
constexpr double kVelocityStep_s = 5e-3;
constexpr double kJointMoves = 2e-3;  // rad or m: range of a joint that moves

// Prior standard deviations of a robot's errors. Only their order of magnitude matters.
constexpr double kAngleSd = 0.03;  // rad
constexpr double kLengthSd_m = 0.01;
constexpr double kMarkerSd_m = 0.03;
constexpr double kComplianceSd = 300e-6;  // rad/(N.m)
constexpr double kPlaceSd = 1.0;          // m and rad: the frame of the cameras

/// Compares what cameras and log say of the markers, with what may be wrong with the robot.
class Comparison {
 public:
  Comparison(const MarkedRobot& robot, const std::vector<int>& markers,
             const std::vector<int>& standing, const SmoothedLog& log,
             const std::vector<int>& coordinates, const MarkerTrajectories& trajectories)
      : robot_(robot),
        markers_(markers),
        standing_body_(robot.tree.links[Size(standing.front())].body),
        log_(log),
        coordinates_(coordinates),
        trajectories_(trajectories),
        kinematics_(robot, markers, standing) {}

  /// Root mean square difference of measured and predicted coordinates, m; infinite without a
  /// moment.
  double Left(const ClockFit& clock) {
    TakeMoments(clock);
    Eigen::MatrixXd predicted(std::ssize(time_s_), 3 * std::ssize(markers_));
    for (Eigen::Index i = 0; i < predicted.rows(); ++i) {
      predicted.row(i) = Predicted(robot_time_s_[Size(i)]).transpose();
    }
    const Eigen::ArrayXXd off = SeenFromStanding(predicted) - predicted;
    const auto seen = static_cast<double>(off.size() - off.isNaN().count());
    if (seen == 0.0) return std::numeric_limits<double>::infinity();
    return std::sqrt(off.isNaN().select(0.0, off).square().sum() / seen);
  }

  MarkerMotion At(const ClockFit& clock) {
    TakeMoments(clock);
    MarkerMotion motion;
    motion.time_s = Eigen::VectorXd::Map(time_s_.data(), std::ssize(time_s_));
    const auto count = motion.time_s.size();
    const Eigen::Index columns = 3 * std::ssize(markers_);
    motion.predicted.resize(count, columns);
    motion.velocity.resize(count, columns);
    for (Eigen::Index i = 0; i < count; ++i) {
      motion.predicted.row(i) = Predicted(robot_time_s_[Size(i)]).transpose();
      motion.velocity.row(i) = (Predicted(robot_time_s_[Size(i)] + kVelocityStep_s) -
                                Predicted(robot_time_s_[Size(i)] - kVelocityStep_s))
                                   .transpose() /
                               (2.0 * kVelocityStep_s);
    }
    motion.measured = SeenFromStanding(motion.predicted);
    AddShapes(motion);
    return motion;
  }

 private:
  // Takes frames evenly over the trial, at which the log has the joints' positions.
  void TakeMoments(const ClockFit& clock) {
    const int stride = std::max(1, trajectories_.frame_count() / kMostMoments);
    frames_.clear();
    time_s_.clear();
    robot_time_s_.clear();
    for (int frame = 0; frame < trajectories_.frame_count(); frame += stride) {
      const double time_s = frame / trajectories_.rate_hz;
      const double robot_time_s = clock.RobotTime(time_s);
      if (!log_.Covers(robot_time_s - kVelocityStep_s) || !log_.Covers(robot_time_s) ||
          !log_.Covers(robot_time_s + kVelocityStep_s)) {
        continue;
      }
      frames_.push_back(frame);
      time_s_.push_back(time_s);
      robot_time_s_.push_back(robot_time_s);
    }
  }

  Eigen::VectorXd Joints(double robot_time_s) const {
    const Eigen::VectorXd signals = *log_.At(robot_time_s);
    Eigen::VectorXd q = robot_.q_not_logged;
    for (int c = 0; c < log_.joints; ++c) q[coordinates_[Size(c)]] = signals[c];
    return q;
  }

  Eigen::VectorXd Predicted(double robot_time_s) const {
    InterruptionPoint();
    return kinematics_.Positions(Joints(robot_time_s)).reshaped();
  }

  // The measured positions, brought by one rigid transform to the frame of the prediction.
  Eigen::MatrixXd SeenFromStanding(const Eigen::MatrixXd& predicted) const {
    Eigen::MatrixXd seen = trajectories_.positions(frames_, Eigen::all);
    std::vector<Eigen::Vector3d> from, to;
    for (Eigen::Index i = 0; i < seen.rows(); ++i) {
      for (Eigen::Index m = 0; m < std::ssize(markers_); ++m) {
        if (std::isnan(seen(i, 3 * m))) continue;
        from.emplace_back(seen.block<1, 3>(i, 3 * m).transpose());
        to.emplace_back(predicted.block<1, 3>(i, 3 * m).transpose());
      }
    }
    const auto T = FitRigid(from, to);
    if (!T) return seen;
    for (Eigen::Index i = 0; i < seen.rows(); ++i) {
      for (Eigen::Index m = 0; m < std::ssize(markers_); ++m) {
        const Eigen::Vector3d position = seen.block<1, 3>(i, 3 * m).transpose();
        seen.block<1, 3>(i, 3 * m) = (*T * position).transpose();
      }
    }
    return seen;
  }

  // Joints of the tree that move in the moments taken.
  std::vector<int> MovingJoints() const {
    Eigen::MatrixXd q(std::ssize(robot_time_s_), robot_.tree.coordinate_count());
    for (Eigen::Index i = 0; i < q.rows(); ++i) {
      q.row(i) = Joints(robot_time_s_[Size(i)]).transpose();
    }
    std::vector<int> moving;
    for (int k = 0; k < static_cast<int>(robot_.tree.joints.size()) && q.rows() > 0; ++k) {
      const Eigen::VectorXd positions = [&] {
        Eigen::VectorXd of(q.rows());
        for (Eigen::Index i = 0; i < q.rows(); ++i) {
          of[i] = JointPosition(robot_.tree.joints[Size(k)], q.row(i));
        }
        return of;
      }();
      if (positions.maxCoeff() - positions.minCoeff() > kJointMoves) moving.push_back(k);
    }
    return moving;
  }

  // For each joint of the tree, the log's column with its measured torque; -1: none.
  std::vector<int> TorqueColumns() const {
    std::vector<int> columns(robot_.tree.joints.size(), -1);
    for (int c = 0; c < log_.joints; ++c) {
      const int joint = robot_.tree.coordinate_joint[Size(coordinates_[Size(c)])];
      const auto& sensors = robot_.torque_sensors;
      if (std::find(sensors.begin(), sensors.end(), joint) == sensors.end()) continue;
      const auto signals = log_.At(robot_time_s_.front());
      if (std::isfinite((*signals)[log_.joints + c])) columns[Size(joint)] = log_.joints + c;
    }
    return columns;
  }

  // The unknowns are, in this order: the frame of the cameras, mountings of moving joints (a turn
  // and a displacement on the body that carries them), their compliances, displacements of markers.
  void AddShapes(MarkerMotion& motion) const {
    motion.shapes.assign(markers_.size(), {});
    if (robot_time_s_.empty()) return;
    const std::vector<int> moving = MovingJoints();
    motion.prior_sd = PriorsOfShapes(moving.size());
    std::vector<std::vector<int>> acting(markers_.size());  // joints on each marker
    for (std::size_t m = 0; m < markers_.size(); ++m) {
      std::vector<int>& unknowns = motion.shapes[m].unknowns;
      for (int u = 0; u < kOfFrame; ++u) unknowns.push_back(u);
      for (std::size_t j = 0; j < moving.size(); ++j) {
        if (Carries(moving[j], BodyOf(m)) == Carries(moving[j], standing_body_)) continue;
        acting[m].push_back(moving[j]);
        for (int u = 0; u < kOfJoint; ++u) {
          unknowns.push_back(kOfFrame + kOfJoint * static_cast<int>(j) + u);
        }
      }
      const auto first = static_cast<int>(kOfFrame + kOfJoint * moving.size() + 3 * m);
      for (int axis = 0; axis < 3; ++axis) unknowns.push_back(first + axis);
      motion.shapes[m].derivatives.setZero(3 * motion.time_s.size(), std::ssize(unknowns));
    }
    const std::vector<int> torque_columns = TorqueColumns();
    for (Eigen::Index i = 0; i < motion.time_s.size(); ++i) {
      InterruptionPoint();
      const Eigen::VectorXd signals = *log_.At(robot_time_s_[Size(i)]);
      const std::vector<Transform> bodies = kinematics_.Bodies(Joints(robot_time_s_[Size(i)]));
      for (std::size_t m = 0; m < markers_.size(); ++m) {
        const Eigen::Vector3d p =
            motion.predicted.block<1, 3>(i, 3 * static_cast<Eigen::Index>(m)).transpose();
        auto rows = motion.shapes[m].derivatives.middleRows<3>(3 * i);
        rows.leftCols<3>() = Turned(Eigen::Matrix3d::Identity(), p);
        rows.middleCols<3>(3).setIdentity();
        Eigen::Index column = kOfFrame;
        for (const int k : acting[m]) {
          const int torque = torque_columns[Size(k)];
          rows.middleCols<kOfJoint>(column) =
              ByJoint(k, BodyOf(m), p, bodies, torque < 0 ? 0.0 : signals[torque]);
          column += kOfJoint;
        }
        rows.rightCols<3>() = bodies[Size(BodyOf(m))].linear();
      }
    }
  }

  static constexpr int kOfFrame = 6, kOfJoint = 7;  // unknowns

  Eigen::VectorXd PriorsOfShapes(std::size_t moving) const {
    std::vector<double> sd(kOfFrame, kPlaceSd);
    for (std::size_t j = 0; j < moving; ++j) {
      sd.insert(sd.end(), {kAngleSd, kAngleSd, kAngleSd, kLengthSd_m, kLengthSd_m, kLengthSd_m,
                           kComplianceSd});
    }
    sd.insert(sd.end(), 3 * markers_.size(), kMarkerSd_m);
    return Eigen::VectorXd::Map(sd.data(), std::ssize(sd));
  }

  /// Displacements of a marker at `p` on a body by the unknowns of joint k.
  Eigen::Matrix<double, 3, kOfJoint> ByJoint(int k, int body, const Eigen::Vector3d& p,
                                             const std::vector<Transform>& bodies,
                                             double torque) const {
    const Joint& joint = robot_.tree.joints[Size(k)];
    const Transform& moved = bodies[Size(k) + 1];
    const double sign = Carries(k, body) ? 1.0 : -1.0;
    const Eigen::Matrix3d axes = sign * bodies[Size(joint.parent_body)].linear();
    const Eigen::Vector3d lever = p - moved.translation();
    Eigen::Matrix<double, 3, kOfJoint> by;
    by.leftCols<3>() = Turned(axes, lever);
    by.middleCols<3>(3) = axes;
    by.col(6).setZero();
    if (joint.type == JointType::kRevolute) {
      by.col(6) = sign * torque * (moved.linear() * joint.axis).cross(lever);
    }
    return by;
  }

  // Displacements of a point at the end of `lever` by turns about the axes.
  static Eigen::Matrix3d Turned(const Eigen::Matrix3d& axes, const Eigen::Vector3d& lever) {
    Eigen::Matrix3d turned;
    for (int axis = 0; axis < 3; ++axis) turned.col(axis) = axes.col(axis).cross(lever);
    return turned;
  }

  int BodyOf(std::size_t m) const {
    return robot_.tree.links[Size(robot_.markers[Size(markers_[m])].link)].body;
  }

  bool Carries(int joint, int body) const {
    const std::vector<int> joints = JointsToBody(robot_.tree, body);
    return std::find(joints.begin(), joints.end(), joint) != joints.end();
  }

  const MarkedRobot& robot_;
  const std::vector<int>& markers_;
  int standing_body_;
  const SmoothedLog& log_;
  const std::vector<int>& coordinates_;
  const MarkerTrajectories& trajectories_;
  StandingKinematics kinematics_;
  std::vector<int> frames_;
  std::vector<double> time_s_, robot_time_s_;
};

// Change of the lag, with a drift if the motion tells the drift to `kWorthKnowing`.
std::optional<LagChange> FindChange(const MarkerMotion& motion) {
  const auto with_drift = FindLagChange(motion, true, kBlock_s);
  if (with_drift && with_drift->slope_sd < kWorthKnowing) return with_drift;
  return FindLagChange(motion, false, kBlock_s);
}

// Adds a change of the lag to robot time = (1 + 1e-6 drift) camera time - lag.
void Add(const LagChange& change, ClockFit& clock) {
  clock.lag_s += change.At(0.0);
  clock.drift_ppm -= 1e6 * change.slope;
}

struct Refined {
  ClockFit clock;
  double left_m = 0.0;
};

std::optional<Refined> Refine(Comparison& comparison, const ClockFit& first,
                              const ClockOptions& options) {
  Refined refined{first};
  ClockFit& clock = refined.clock;
  for (int pass = 0; pass < kPasses; ++pass) {
    const MarkerMotion motion = comparison.At(clock);
    const auto change = FindChange(motion);
    if (!change) return std::nullopt;
    Add(*change, clock);
    clock.drift_estimated = first.drift_estimated || change->slope_sd > 0.0;
    refined.left_m = change->left_m;
    const double first_s = motion.time_s[0];
    const double last_s = motion.time_s[motion.time_s.size() - 1];
    clock.sd_s = std::max(change->Sd(first_s), change->Sd(last_s));
    if (std::max(std::abs(change->At(first_s)), std::abs(change->At(last_s))) < kUnchanged_s) break;
  }
  clock.state = clock.sd_s <= options.largest_sd_s ? ClockState::kReliable : ClockState::kImprecise;
  return refined;
}

// Refines both lags of an ambiguous clock and chooses the one with clearly smaller residuals.
ClockFit Choose(Comparison& comparison, const ClockFit& by_speed, const ClockOptions& options) {
  ClockFit other = by_speed;
  other.lag_s = by_speed.second_lag_s;
  other.drift_ppm = 0.0;
  const auto a = Refine(comparison, by_speed, options);
  const auto b = Refine(comparison, other, options);
  if (a && (!b || a->left_m < kClearly * b->left_m)) return a->clock;
  if (b && (!a || b->left_m < kClearly * a->left_m)) return b->clock;
  return by_speed;
}

}  // namespace

ClockFit RefineClock(const MarkedRobot& robot, const std::vector<int>& markers,
                     const std::vector<int>& standing, const SmoothedLog& log,
                     const std::vector<int>& coordinates, const MarkerTrajectories& trajectories,
                     const ClockFit& by_speed, const ClockOptions& options) {
  Comparison comparison(robot, markers, standing, log, coordinates, trajectories);
  if (by_speed.state == ClockState::kAmbiguous) return Choose(comparison, by_speed, options);
  const auto refined = Refine(comparison, by_speed, options);
  return refined && refined->clock.sd_s < by_speed.sd_s ? refined->clock : by_speed;
}

double LeftByPositions(const MarkedRobot& robot, const std::vector<int>& markers,
                       const std::vector<int>& standing, const SmoothedLog& log,
                       const std::vector<int>& coordinates, const MarkerTrajectories& trajectories,
                       const ClockFit& clock) {
  Comparison comparison(robot, markers, standing, log, coordinates, trajectories);
  return comparison.Left(clock);
}

std::optional<double> LagByPositions(const MarkedRobot& robot, const std::vector<int>& markers,
                                     const std::vector<int>& standing, const SmoothedLog& log,
                                     const std::vector<int>& coordinates,
                                     const MarkerTrajectories& trajectories,
                                     const ClockFit& clock) {
  Comparison comparison(robot, markers, standing, log, coordinates, trajectories);
  ClockFit other = clock;
  other.lag_s = clock.second_lag_s;
  other.drift_ppm = 0.0;
  const double here = comparison.Left(clock), there = comparison.Left(other);
  if (here < kClearly * there) return clock.lag_s;
  if (there < kClearly * here) return other.lag_s;
  return std::nullopt;
}

}  // namespace elastocal
