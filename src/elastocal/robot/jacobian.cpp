#include "elastocal/robot/jacobian.hpp"

namespace elastocal {
namespace {

using Eigen::Vector3d;
using Screws = Eigen::Array<double, Eigen::Dynamic, 6>;

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
      frames_(model.tree.body_count()),
      positions_(3, model.marker_count()) {
  const int screw_count = model.parameter_count() - 3 * model.marker_count();
  std::vector<int> parameter_count(model.tree.joints.size(), 0);
  for (int i = screw_count - 1; i >= kBaseParameterCount; --i) {
    first_parameter_[model.parameters[i].joint] = i;
    ++parameter_count[model.parameters[i].joint];
  }
  screws_.setZero(screw_count, 6);

  Eigen::Index offset = 0;
  for (int m = 0; m < model.marker_count(); ++m) {
    MarkerLayout layout;
    layout.body = model.tree.links[model.markers[m].link].body;
    layout.segments = {{0, kBaseParameterCount}};
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

void GeneralizedJacobian::EvaluateScrews(const Geometry& geometry, const Eigen::VectorXd& q) {
  // In the order of the parameters of one joint, or of the waist.
  const auto visit = [this](int joint, const Geometry::JointConstants& constants,
                            const MdhFrame& parent, const MdhFrame& twisted) {
    const bool waist = joint == kWaist;
    int row = waist ? 0 : first_parameter_[joint];
    if (waist || model_.placements[joint].general) {
      const Vector3d z = parent.R * constants.z_pre;
      SetRotation(screws_, row++, z, parent.p + parent.R * constants.p_pre);
      SetTranslation(screws_, row++, z);
    }
    if (!waist && model_.placements[joint].parallel) {
      SetRotation(screws_, row++, parent.R * constants.y_beta,
                  parent.p + parent.R * constants.p_beta);
    }
    SetRotation(screws_, row++, twisted.R.col(0), twisted.p);
    SetTranslation(screws_, row++, twisted.R.col(0));
    SetRotation(screws_, row++, twisted.R.col(2), twisted.p);
    SetTranslation(screws_, row, twisted.R.col(2));
  };
  EvaluateMdhFrames(model_, geometry, q, frames_, visit);
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
  EvaluateScrews(geometry, q);
  for (int m = 0; m < model_.marker_count(); ++m) {
    const MdhFrame& frame = frames_[layout_[m].body];
    positions_.col(m) = frame.p + frame.R * geometry.p_joint_marker[m];
    EvaluateMarker(m);
    const auto width = static_cast<Eigen::Index>(layout_[m].columns.size());
    Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>> block(
        values_.data() + layout_[m].offset, 3, width);
    block.rightCols<3>() = frame.R * geometry.R_joint_link[m];
  }
}

Eigen::MatrixXd GeneralizedJacobian::Dense() const {
  Eigen::MatrixXd dense =
      Eigen::MatrixXd::Zero(3 * model_.marker_count(), model_.parameter_count());
  for (int m = 0; m < model_.marker_count(); ++m) {
    dense(Eigen::seqN(3 * m, 3), Columns(m)) = Block(m);
  }
  return dense;
}

}  // namespace elastocal
