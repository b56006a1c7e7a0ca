// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/tracked.hpp"

#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/observation/frame_view.hpp"

namespace elastocal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kArm =
    0.1;  // m: of the points that stand for a pose where a tracker is registered

/// Pose on the floor of what carries the tracker.
Transform CarrierOf(const Sight& sight) {
  return sight.T_floor_link.size() > 1 ? sight.T_floor_link[1] : Transform::Identity();
}

FrameView ViewOf(const Sight& sight, const Vector3d& p_floor) {
  return ViewFrom(CarrierOf(sight), sight.values[0], p_floor);
}

/// Derivatives by the screws of all links, from that by the screw of the moving link.
std::vector<ByScrew> ByLinks(const Sight& sight, const ByScrew& by_screw) {
  if (sight.T_floor_link.size() > 1) return {by_screw, -by_screw};
  return {by_screw};
}

Vector3d MarkOf(const Sight& sight) {
  return sight.T_floor_link[0] * (sight.values[1].origin.translation() + sight.values[1].x);
}

Transform BodyInTracker(const Sight& sight) {
  const Transform T_floor_tracker = CarrierOf(sight) * sight.values[0].Pose();
  return T_floor_tracker.inverse(Eigen::Isometry) * sight.T_floor_link[0] * sight.values[1].Pose();
}

Eigen::Quaterniond Attitude(const Eigen::VectorXd& measured) {
  return Eigen::Quaterniond(measured[6], measured[3], measured[4], measured[5]).normalized();
}

}  // namespace

ObservationResidual TrackedPoint::Evaluate(const Sight& sight,
                                           const Eigen::VectorXd& measured) const {
  const FrameView view = ViewOf(sight, MarkOf(sight));
  const Matrix3d R_tracker_link = (CarrierOf(sight) * sight.values[0].Pose()).linear().transpose() *
                                  sight.T_floor_link[0].linear();
  return {view.p - measured, ByLinks(sight, view.by_point_screw), {view.by_frame, R_tracker_link}};
}

Eigen::VectorXd TrackedPoint::Predict(const Sight& sight) const {
  return ViewOf(sight, MarkOf(sight)).p;
}

void TrackedPoint::AddLandmarks(const Sight& sight, const Eigen::VectorXd& measured,
                                Landmarks& landmarks) const {
  landmarks.emplace_back(CarrierOf(sight).inverse(Eigen::Isometry) * MarkOf(sight), measured);
}

std::vector<RowMeaning> TrackedBody::rows() const {
  std::vector<RowMeaning> rows(3, {"position", SourceUnit::kMetre});
  rows.resize(6, {"rotation", SourceUnit::kRadian});
  return rows;
}

ObservationResidual TrackedBody::Evaluate(const Sight& sight,
                                          const Eigen::VectorXd& measured) const {
  const Transform carrier = CarrierOf(sight);
  const Transform& T_floor_link = sight.T_floor_link[0];
  const Transform mount = sight.values[1].Pose();
  const Transform T_floor_body = T_floor_link * mount;
  const FrameView view = ViewOf(sight, T_floor_body.translation());
  const Matrix3d R_tracker_floor = (carrier * sight.values[0].Pose()).linear().transpose();
  const Vector3d turn = RotationVector(Attitude(measured).toRotationMatrix().transpose() *
                                       R_tracker_floor * T_floor_body.linear());
  // By a rotation of the body in its own axes: inverse of the right Jacobian.
  const Matrix3d by_own = InverseLeftJacobian(turn).transpose();
  const Matrix3d by_turn = by_own * T_floor_body.linear().transpose();

  ObservationResidual pose;
  pose.left.resize(6);
  pose.left << view.p - measured.head<3>(), turn;
  ByScrew by_screw(6, 6);
  by_screw << view.by_point_screw, by_turn * TurnByScrew();
  pose.by_link = ByLinks(sight, by_screw);
  Eigen::MatrixXd by_tracker = Eigen::MatrixXd::Zero(6, 6);
  by_tracker.topRows<3>() = view.by_frame;
  by_tracker.bottomRightCorner<3, 3>() = -by_turn * carrier.linear() * sight.values[0].Turns();
  Eigen::MatrixXd by_mount = Eigen::MatrixXd::Zero(6, 6);
  by_mount.topLeftCorner<3, 3>() = R_tracker_floor * T_floor_link.linear();
  by_mount.bottomRightCorner<3, 3>() =
      by_own * mount.linear().transpose() * sight.values[1].Turns();
  pose.by_quantity = {by_tracker, by_mount};
  return pose;
}

Eigen::VectorXd TrackedBody::Predict(const Sight& sight) const {
  const Transform pose = BodyInTracker(sight);
  Eigen::VectorXd measured(7);
  measured << pose.translation(), Eigen::Quaterniond(pose.linear()).coeffs();
  return measured;
}

void TrackedBody::AddLandmarks(const Sight& sight, const Eigen::VectorXd& measured,
                               Landmarks& landmarks) const {
  const Transform seen =
      CarrierOf(sight).inverse(Eigen::Isometry) * sight.T_floor_link[0] * sight.values[1].Pose();
  for (int corner = 0; corner < 4; ++corner) {
    Vector3d p = Vector3d::Zero();
    if (corner < 3) p[corner] = kArm;
    landmarks.emplace_back(seen * p, measured.head<3>() + Attitude(measured) * p);
  }
}

}  // namespace elastocal
