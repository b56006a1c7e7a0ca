// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/told_positions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr int kPlacings = 10;          // rounds of pose and positions in turn
constexpr int kRangeSteps = 24;        // steps over the joint's range
constexpr int kStepHalvings = 8;       // halvings of a step
constexpr double kLongestSlide = 1.0;  // m
constexpr double kAsTold = 0.5;        // rad
// Share of the postures that are neither as logged nor half a turn off.
constexpr double kMostUntold = 0.2;
constexpr std::size_t kFewestHalfTurns = 3;
// Range of a column and of the joint's limits, in half turns.
constexpr double kLeastOfHalfTurn = 0.7, kMoreThanHalfTurn = 1.1;

class ToldPositions {
 public:
  ToldPositions(const ErrorModel& model, const Recording& recording, int coordinate)
      : model_(model), recording_(recording), coordinate_(coordinate) {
    model_.T_ref_waist = Transform::Identity();
    geometry_ = ApplyErrors(model_, Eigen::VectorXd::Zero(model_.parameter_count()));
    const Joint& joint = model.tree.joints[Size(model.tree.coordinate_joint[Size(coordinate)])];
    const double most = joint.type == JointType::kPrismatic ? kLongestSlide : std::numbers::pi;
    lower_ = std::max(joint.limits.lower, -most);
    upper_ = std::min(joint.limits.upper, most);
  }

  Recording Find() {
    for (int turn = 0; turn < kPlacings; ++turn) {
      InterruptionPoint();
      if (!PlaceRoot()) break;
      for (int i = 0; i < recording_.posture_count(); ++i) {
        recording_.q(i, coordinate_) = NearestPosition(i);
      }
    }
    return std::move(recording_);
  }

 private:
  Eigen::Matrix3Xd Nominal(const Eigen::VectorXd& q) const {
    return MarkerPositions(model_, geometry_, q);
  }

  bool PlaceRoot() {
    std::vector<Eigen::Vector3d> nominal, measured;
    for (int i = 0; i < recording_.posture_count(); ++i) {
      const Eigen::Matrix3Xd positions = Nominal(recording_.q.row(i).transpose());
      for (int m = 0; m < recording_.marker_count(); ++m) {
        if (!Seen(recording_, i, m)) continue;
        nominal.emplace_back(positions.col(m));
        measured.push_back(MarkerPosition(recording_, i, m));
      }
    }
    const std::optional<Transform> placed = FitRigid(nominal, measured);
    if (placed) T_ref_root_ = *placed;
    return placed.has_value();
  }

  /// Sum of squared distances of the markers in a posture, m^2.
  double SquaresAt(int i, double position) const {
    Eigen::VectorXd q = recording_.q.row(i).transpose();
    q[coordinate_] = position;
    const Eigen::Matrix3Xd positions = T_ref_root_ * Nominal(q);
    double squares = 0.0;
    for (int m = 0; m < recording_.marker_count(); ++m) {
      if (!Seen(recording_, i, m)) continue;
      squares += (positions.col(m) - MarkerPosition(recording_, i, m)).squaredNorm();
    }
    return squares;
  }

  double NearestPosition(int i) const {
    double step = (upper_ - lower_) / kRangeSteps;
    double best = lower_, least = std::numeric_limits<double>::infinity();
    const auto consider = [&](double position) {
      const double squares = SquaresAt(i, position);
      if (squares < least) {
        least = squares;
        best = position;
      }
    };
    for (int k = 0; k <= kRangeSteps; ++k) consider(lower_ + k * step);
    for (int halving = 0; halving < kStepHalvings; ++halving) {
      step /= 2.0;
      const double middle = best;
      consider(std::max(lower_, middle - step));
      consider(std::min(upper_, middle + step));
    }
    return best;
  }

  ErrorModel model_;
  Recording recording_;
  int coordinate_;
  Geometry geometry_;
  double lower_ = 0.0, upper_ = 0.0;
  Transform T_ref_root_ = Transform::Identity();
};

}  // namespace

Recording WithToldPositions(const ErrorModel& model, const Recording& recording, int coordinate) {
  return ToldPositions(model, recording, coordinate).Find();
}

HalfTurns FindHalfTurns(const ErrorModel& model, const Recording& recording, int coordinate) {
  const Joint& joint = model.tree.joints[Size(model.tree.coordinate_joint[Size(coordinate)])];
  const auto column = recording.q.col(coordinate);
  const double range = column.maxCoeff() - column.minCoeff();
  const bool within = range > kLeastOfHalfTurn * std::numbers::pi && range <= std::numbers::pi;
  const bool further =
      joint.limits.upper - joint.limits.lower > kMoreThanHalfTurn * std::numbers::pi;
  if (recording.free_root || joint.type == JointType::kPrismatic || !within || !further) return {};
  const Recording told = WithToldPositions(model, recording, coordinate);
  HalfTurns found{{}, recording};
  int neither = 0;
  for (int i = 0; i < recording.posture_count(); ++i) {
    const double off = std::remainder(told.q(i, coordinate) - column[i], 2.0 * std::numbers::pi);
    if (std::abs(off) > std::numbers::pi - kAsTold) {
      found.postures.push_back(i);
      found.turned.q(i, coordinate) += std::copysign(std::numbers::pi, told.q(i, coordinate));
    } else if (std::abs(off) > kAsTold) {
      ++neither;
    }
  }
  const bool many = kMostUntold * recording.posture_count() < neither;
  return many || found.postures.size() < kFewestHalfTurns ? HalfTurns{} : std::move(found);
}

}  // namespace elastocal
