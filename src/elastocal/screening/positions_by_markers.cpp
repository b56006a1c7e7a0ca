// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/positions_by_markers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

#include "elastocal/math/transform.hpp"
#include "elastocal/robot/jacobian.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr double kMarkerSd = 0.02;      // m: errors of nominal robot and markers, for a large robot
constexpr double kMarkerShare = 0.01;   // share of the robot's size, for a small robot
constexpr double kLoggedSd = 0.5;       // rad
constexpr double kLoggedSlideSd = 0.1;  // m
constexpr double kWaistSd = 1.0;        // m, rad: about the first guess
// In these standard deviations: markers of joints that differ from the log.
constexpr double kFarOff = 2.0;
constexpr int kMostSteps = 20;
constexpr double kSmallStep = 1e-4;

bool SlidesAlong(const RobotTree& tree, int coordinate) {
  return tree.joints[tree.coordinate_joint[coordinate]].type == JointType::kPrismatic;
}

/// Finds the positions of the joints, posture by posture.
class MarkerPositionFinder {
 public:
  MarkerPositionFinder(const ErrorModel& model, const Recording& recording)
      : model_(model),
        recording_(recording),
        jacobian_(model),
        marker_sd_(std::min(kMarkerSd, kMarkerShare * RobotSize(model.tree))) {
    geometry_ = ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
    unknown_of_.assign(model.tree.coordinate_count(), -1);
    for (int joint : model.active_joints) {
      for (const Drive& drive : DrivesOf(model.tree.joints[joint])) {
        int& unknown = unknown_of_[drive.coordinate];
        if (unknown < 0) unknown = count_++;
      }
    }
    for (const Parameter& parameter : model.parameters) {
      std::vector<Column> columns;
      if (parameter.kind == ParameterKind::kTheta || parameter.kind == ParameterKind::kR) {
        const Joint& joint = model.tree.joints[parameter.joint];
        const bool moves =
            (joint.type == JointType::kRevolute) == (parameter.kind == ParameterKind::kTheta);
        if (moves) {
          for (const Drive& drive : DrivesOf(joint)) {
            columns.push_back(
                {kWaistParameterCount + unknown_of_[drive.coordinate], drive.multiplier});
          }
        }
      }
      columns_.push_back(std::move(columns));
    }
    for (int i = 0; i < kWaistParameterCount; ++i) columns_[i] = {{i, 1.0}};
  }

  /// The positions of all coordinates in posture `i`.
  Eigen::VectorXd Find(int i) {
    const Eigen::VectorXd logged = recording_.q.row(i).transpose();
    const Start start = BestStart(i, logged);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(kWaistParameterCount + count_);
    for (Eigen::Index c = 0; c < logged.size(); ++c) {
      if (unknown_of_[c] >= 0) x[kWaistParameterCount + unknown_of_[c]] = start.q[c] - logged[c];
    }
    double cost = Linearise(i, start.T_ref_waist, logged, x);
    double damping = 0.0;
    for (int step = 0; step < kMostSteps; ++step) {
      Eigen::MatrixXd damped = information_;
      damped.diagonal() *= 1.0 + damping;
      const Eigen::VectorXd change = -damped.ldlt().solve(gradient_);
      const Eigen::VectorXd tried = x + change;
      const double found = Linearise(i, start.T_ref_waist, logged, tried);
      if (found <= cost) {
        x = tried;
        cost = found;
        damping *= 0.1;
        if (change.lpNorm<Eigen::Infinity>() < kSmallStep) break;
      } else {
        damping = std::max(1e-3, 10.0 * damping);
        cost = Linearise(i, start.T_ref_waist, logged, x);
      }
    }
    return With(logged, x);
  }

 private:
  struct Column {
    int unknown;
    double factor;
  };

  /// Start of the search in a posture.
  struct Start {
    Eigen::VectorXd q;
    Transform T_ref_waist = Transform::Identity();
    double misfit = std::numeric_limits<double>::infinity();  ///< rms distance of the markers, m
  };

  /// Places the waist by the markers, with the joints at q.
  Start Register(int i, const Eigen::VectorXd& q) {
    PlaceWaist(Transform::Identity(), Vector6d::Zero(), geometry_);
    const Eigen::Matrix3Xd nominal = MarkerPositions(model_, geometry_, q);
    Eigen::Matrix3Xd from(3, nominal.cols()), to(3, nominal.cols());
    Eigen::Index count = 0;
    for (int m = 0; m < model_.marker_count(); ++m) {
      if (!Seen(recording_, i, m)) continue;
      from.col(count) = nominal.col(m);
      to.col(count++) = MarkerPosition(recording_, i, m);
    }
    Start start{.q = q};
    if (count < 3) return start;
    start.T_ref_waist = FitRigid(from.leftCols(count), to.leftCols(count));
    const Eigen::Matrix3Xd left = start.T_ref_waist * from.leftCols(count) - to.leftCols(count);
    start.misfit = std::sqrt(left.squaredNorm() / static_cast<double>(count));
    return start;
  }

  /// The start of the search: the log or, where the markers are far from it, the log with the one
  /// reversed sign or exchange of two joints that brings them nearest.
  Start BestStart(int i, const Eigen::VectorXd& logged) {
    Start best = Register(i, logged);
    if (!(best.misfit > kFarOff * marker_sd_)) return best;
    const auto take = [&](const Eigen::VectorXd& q) {
      Start start = Register(i, q);
      if (start.misfit < best.misfit) best = std::move(start);
    };
    for (Eigen::Index a = 0; a < logged.size(); ++a) {
      if (unknown_of_[a] < 0) continue;
      Eigen::VectorXd q = logged;
      q[a] = -q[a];
      take(q);
      for (Eigen::Index b = 0; b < a; ++b) {
        if (unknown_of_[b] < 0) continue;
        q = logged;
        std::swap(q[a], q[b]);
        take(q);
      }
    }
    return best;
  }

  Eigen::VectorXd With(const Eigen::VectorXd& logged, const Eigen::VectorXd& x) const {
    Eigen::VectorXd q = logged;
    for (Eigen::Index c = 0; c < q.size(); ++c) {
      if (unknown_of_[c] >= 0) q[c] += x[kWaistParameterCount + unknown_of_[c]];
    }
    return q;
  }

  /// Computes information and gradient at x; returns the cost.
  double Linearise(int i, const Transform& T_ref_waist, const Eigen::VectorXd& logged,
                   const Eigen::VectorXd& x) {
    const auto size = x.size();
    Eigen::VectorXd weights = Eigen::VectorXd::Constant(size, 1.0 / (kWaistSd * kWaistSd));
    for (int c = 0; c < model_.tree.coordinate_count(); ++c) {
      if (unknown_of_[c] < 0) continue;
      const double sd = SlidesAlong(model_.tree, c) ? kLoggedSlideSd : kLoggedSd;
      weights[kWaistParameterCount + unknown_of_[c]] = 1.0 / (sd * sd);
    }
    information_ = weights.asDiagonal();
    gradient_ = weights.cwiseProduct(x);
    double cost = x.dot(gradient_);
    PlaceWaist(T_ref_waist, x.head<kWaistParameterCount>(), geometry_);
    jacobian_.Evaluate(geometry_, With(logged, x));
    for (int m = 0; m < model_.marker_count(); ++m) {
      if (!Seen(recording_, i, m)) continue;
      const Eigen::Vector3d residual =
          (jacobian_.Position(m) - MarkerPosition(recording_, i, m)) / marker_sd_;
      const std::vector<int>& parameters = jacobian_.Columns(m);
      const auto block = jacobian_.Block(m);
      Eigen::Matrix3Xd J = Eigen::Matrix3Xd::Zero(3, size);
      for (std::size_t k = 0; k < parameters.size(); ++k) {
        for (const Column& column : columns_[parameters[k]]) {
          J.col(column.unknown) +=
              column.factor / marker_sd_ * block.col(static_cast<Eigen::Index>(k));
        }
      }
      // A marker that is far off is wrong, or waits for the joints to come nearer.
      const double weight = 1.0 / (1.0 + residual.squaredNorm() / 100.0);
      information_.noalias() += weight * J.transpose() * J;
      gradient_.noalias() += weight * J.transpose() * residual;
      cost += 100.0 * std::log1p(residual.squaredNorm() / 100.0);
    }
    return cost;
  }

  const ErrorModel& model_;
  const Recording& recording_;
  GeneralizedJacobian jacobian_;
  const double marker_sd_;  // m, of a coordinate
  Geometry geometry_;
  // By coordinate: its number after the unknowns of the waist; -1: none.
  std::vector<int> unknown_of_;
  std::vector<std::vector<Column>> columns_;  // by parameter: the unknowns with the same effect
  int count_ = 0;
  Eigen::MatrixXd information_;
  Eigen::VectorXd gradient_;
};

}  // namespace

Eigen::MatrixXd PositionsByMarkers(const ErrorModel& model, const Recording& recording) {
  Eigen::MatrixXd positions = recording.q;
  if (recording.trials.empty()) return positions;
  MarkerPositionFinder finder(model, recording);
  for (int i = 0; i < recording.posture_count(); ++i) {
    positions.row(i) = finder.Find(i).transpose();
  }
  return positions;
}

}  // namespace elastocal
