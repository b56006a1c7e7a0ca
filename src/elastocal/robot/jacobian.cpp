#include "elastocal/robot/jacobian.hpp"

#include <cmath>

namespace elastocal {
namespace {

using Eigen::Vector3d;
using Screws = Eigen::Array<double, Eigen::Dynamic, 6>;

constexpr int kBaseParameters = 6;

void SetRotation(Screws& screws, int row, const Vector3d& axis, const Vector3d& point) {
  screws.row(row) << axis.transpose().array(), point.cross(axis).transpose().array();
}

void SetTranslation(Screws& screws, int row, const Vector3d& direction) {
  screws.row(row) << 0.0, 0.0, 0.0, direction.transpose().array();
}

}  // namespace

GeneralizedJacobian::GeneralizedJacobian(const ErrorModel& model)
    : model_(model),
      first_parameter_(model.tree.joints.size(), -1),
      R_(model.tree.body_count()),
      p_(model.tree.body_count()),
      positions_(3, model.marker_count()) {
  const int screw_count = model.parameter_count() - 3 * model.marker_count();
  std::vector<int> parameter_count(model.tree.joints.size(), 0);
  for (int i = screw_count - 1; i >= kBaseParameters; --i) {
    first_parameter_[model.parameters[i].joint] = i;
    ++parameter_count[model.parameters[i].joint];
  }
  screws_.setZero(screw_count, 6);

  Eigen::Index offset = 0;
  for (int m = 0; m < model.marker_count(); ++m) {
    MarkerLayout layout;
    layout.body = model.tree.links[model.markers[m].link].body;
    layout.segments = {{0, kBaseParameters}};
    for (int joint : JointsToBody(model.tree, layout.body)) {
      Segment& last = layout.segments.back();
      if (last.begin + last.size == first_parameter_[joint]) {
        last.size += parameter_count[joint];
      } else {
        layout.segments.push_back({first_parameter_[joint], parameter_count[joint]});
      }
    }
    for (const Segment& segment : layout.segments) {
      for (int i = 0; i < segment.size; ++i) layout.columns.push_back(segment.begin + i);
    }
    for (int i = 0; i < 3; ++i) layout.columns.push_back(screw_count + 3 * m + i);
    layout.offset = offset;
    offset += 3 * static_cast<Eigen::Index>(layout.columns.size());
    layout_.push_back(std::move(layout));
  }
  values_.setZero(offset);
}

void GeneralizedJacobian::EvaluateFrames(const Geometry& geometry, const Eigen::VectorXd& q) {
  // One joint of eq. 1 (or the waist, eq. 2), in the order of its parameters.
  const auto place = [&](const Geometry::JointConstants& joint, const Eigen::Matrix3d& R_parent,
                         const Vector3d& p_parent, bool general, bool parallel, double theta,
                         double r, int row, int body) {
    if (general) {
      const Vector3d z = R_parent * joint.z_pre;
      SetRotation(screws_, row++, z, p_parent + R_parent * joint.p_pre);
      SetTranslation(screws_, row++, z);
    }
    if (parallel) {
      SetRotation(screws_, row++, R_parent * joint.y_beta, p_parent + R_parent * joint.p_beta);
    }
    const Eigen::Matrix3d R = R_parent * joint.R_parent_twisted;
    const Vector3d p = p_parent + R_parent * joint.p_parent_twisted;
    SetRotation(screws_, row++, R.col(0), p);
    SetTranslation(screws_, row++, R.col(0));
    SetRotation(screws_, row++, R.col(2), p);
    SetTranslation(screws_, row, R.col(2));
    const double c = std::cos(theta);
    const double s = std::sin(theta);
    R_[body].col(0) = c * R.col(0) + s * R.col(1);
    R_[body].col(1) = c * R.col(1) - s * R.col(0);
    R_[body].col(2) = R.col(2);
    p_[body] = p + r * R.col(2);
  };

  place(geometry.base, Eigen::Matrix3d::Identity(), Vector3d::Zero(), true, false,
        geometry.base.theta, geometry.base.r, 0, 0);
  R_[0] = R_[0] * geometry.T_joint_waist.linear();
  for (int k : model_.active_joints) {
    const Joint& joint = model_.tree.joints[k];
    const JointPlacement& placement = model_.placements[k];
    const Geometry::JointConstants& constants = geometry.joints[k];
    const double position = JointPosition(joint, q);
    const bool revolute = joint.type == JointType::kRevolute;
    place(constants, R_[joint.parent_body], p_[joint.parent_body], placement.general,
          placement.parallel, constants.theta + (revolute ? position : 0.0),
          constants.r + (revolute ? 0.0 : position), first_parameter_[k], k + 1);
  }
}

void GeneralizedJacobian::EvaluateMarker(int marker) {
  const MarkerLayout& layout = layout_[marker];
  const double px = positions_(0, marker);
  const double py = positions_(1, marker);
  const double pz = positions_(2, marker);
  const auto width = static_cast<Eigen::Index>(layout.columns.size());
  double* const row_x = values_.data() + layout.offset;
  double* const row_y = row_x + width;
  double* const row_z = row_y + width;
  Eigen::Index at = 0;
  for (const Segment& segment : layout.segments) {
    const auto screws = screws_.middleRows(segment.begin, segment.size);
    const auto ax = screws.col(0);
    const auto ay = screws.col(1);
    const auto az = screws.col(2);
    using Run = Eigen::Map<Eigen::ArrayXd>;
    Run(row_x + at, segment.size) = ay * pz - az * py + screws.col(3);
    Run(row_y + at, segment.size) = az * px - ax * pz + screws.col(4);
    Run(row_z + at, segment.size) = ax * py - ay * px + screws.col(5);
    at += segment.size;
  }
}

void GeneralizedJacobian::Evaluate(const Geometry& geometry, const Eigen::VectorXd& q) {
  EvaluateFrames(geometry, q);
  for (int m = 0; m < model_.marker_count(); ++m) {
    const int body = layout_[m].body;
    positions_.col(m) = p_[body] + R_[body] * geometry.p_joint_marker[m];
    EvaluateMarker(m);
    const auto width = static_cast<Eigen::Index>(layout_[m].columns.size());
    Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>> block(
        values_.data() + layout_[m].offset, 3, width);
    block.rightCols<3>() = R_[body] * geometry.R_joint_link[m];
  }
}

Eigen::MatrixXd GeneralizedJacobian::Dense() const {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * model_.marker_count(),
                                                model_.parameter_count());
  for (int m = 0; m < model_.marker_count(); ++m) {
    dense(Eigen::seqN(3 * m, 3), Columns(m)) = Block(m);
  }
  return dense;
}

}  // namespace elastocal
