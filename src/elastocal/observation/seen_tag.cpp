// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/seen_tag.hpp"

#include "elastocal/observation/frame_view.hpp"

namespace elastocal {
namespace {

constexpr double kNearest = 0.1;  // m
constexpr double kFacing = 0.2;   // cosine of the largest angle between line of sight and normal

}  // namespace

Transform SeenTag::CameraParent(const Sight& sight) const {
  return camera_carried ? sight.T_floor_link.front() : Transform::Identity();
}

Transform SeenTag::TagParent(const Sight& sight) const {
  return tag_carried ? sight.T_floor_link.back() : Transform::Identity();
}

ObservationResidual SeenTag::Evaluate(const Sight& sight, const Eigen::VectorXd& measured) const {
  const Transform T_floor_camera_parent = CameraParent(sight);
  const Transform T_floor_tag_parent = TagParent(sight);
  const Transform T_parent_tag = sight.values[1].Pose();
  const Eigen::Matrix3d tag_turns = sight.values[1].Turns();
  const Camera with_errors = camera.With(sight.values[2].x);

  ObservationResidual seen;
  seen.left.resize(8);
  ByScrew by_tag_link(8, 6);
  Eigen::MatrixXd by_camera(8, 6);
  Eigen::MatrixXd by_tag(8, 6);
  Eigen::MatrixXd by_numbers(8, Camera::kNumbers);
  for (int corner = 0; corner < 4; ++corner) {
    const Eigen::Vector3d arm = T_parent_tag.linear() * p_tag_corner.col(corner);
    const Eigen::Vector3d p_floor = T_floor_tag_parent * (T_parent_tag.translation() + arm);
    const FrameView view = ViewFrom(T_floor_camera_parent, sight.values[0], p_floor);
    const Pixel pixel = PixelOf(camera, with_errors, view.p);
    const int row = 2 * corner;
    seen.left.segment<2>(row) = pixel.at - measured.segment<2>(row);
    by_tag_link.middleRows<2>(row) = pixel.by_point * view.by_point_screw;
    by_camera.middleRows<2>(row) = pixel.by_point * view.by_frame;
    // Displacement of the point in the axes of the tag's parent.
    const Eigen::Matrix<double, 2, 3> by_point =
        pixel.by_point * view.by_point_screw.rightCols<3>() * T_floor_tag_parent.linear();
    by_tag.middleRows<2>(row) << by_point, -by_point * Skew(arm) * tag_turns;
    by_numbers.middleRows<2>(row) = pixel.by_camera;
  }
  if (camera_carried) seen.by_link.emplace_back(-by_tag_link);
  if (tag_carried) seen.by_link.push_back(by_tag_link);
  seen.by_quantity = {by_camera, by_tag, by_numbers};
  return seen;
}

Eigen::VectorXd SeenTag::Predict(const Sight& sight) const {
  return Evaluate(sight, Eigen::VectorXd::Zero(8)).left;
}

bool SeenTag::Sees(const Sight& sight) const {
  const Transform T_camera_tag = (CameraParent(sight) * sight.values[0].Pose()).inverse() *
                                 TagParent(sight) * sight.values[1].Pose();
  for (int corner = 0; corner < 4; ++corner) {
    const Eigen::Vector3d p = T_camera_tag * p_tag_corner.col(corner);
    if (p.z() < kNearest || T_camera_tag.linear().col(2).dot(p) > -kFacing * p.norm()) return false;
    const Pixel pixel = PixelOf(camera, camera, p);
    if (pixel.at.minCoeff() < 0.0 || pixel.at.x() > 2.0 * camera.cx ||
        pixel.at.y() > 2.0 * camera.cy) {
      return false;
    }
  }
  return true;
}

Eigen::VectorXd CornersOfLargerTag(const Eigen::VectorXd& corners, double factor) {
  // Corners at x, y of -1 and 1 are seen at (a x + b y + c) / (g x + h y + 1).
  const Eigen::Map<const Eigen::Matrix<double, 2, 4>> at(corners.data());
  const Eigen::RowVector4d x(-1.0, 1.0, 1.0, -1.0), y(-1.0, -1.0, 1.0, 1.0);
  const Eigen::RowVector4d xy = x.cwiseProduct(y);
  const Eigen::Vector2d by_one = at.rowwise().sum(), by_x = at * x.transpose(),
                        by_y = at * y.transpose(), by_xy = at * xy.transpose();
  // xy is orthogonal to 1, x and y: by_xy + g by_y + h by_x = 0.
  const double determinant = by_y[0] * by_x[1] - by_x[0] * by_y[1];
  if (determinant == 0.0) return corners;
  const double g = (by_x[0] * by_xy[1] - by_xy[0] * by_x[1]) / determinant;
  const double h = (by_xy[0] * by_y[1] - by_y[0] * by_xy[1]) / determinant;
  const Eigen::Vector2d a = 0.25 * (by_x + g * by_one + h * by_xy);
  const Eigen::Vector2d b = 0.25 * (by_y + g * by_xy + h * by_one);
  const Eigen::Vector2d c = 0.25 * (by_one + g * by_x + h * by_y);
  Eigen::VectorXd larger(8);
  for (int corner = 0; corner < 4; ++corner) {
    const double u = factor * x[corner], v = factor * y[corner];
    larger.segment<2>(2 * corner) = (a * u + b * v + c) / (g * u + h * v + 1.0);
  }
  return larger;
}

}  // namespace elastocal
