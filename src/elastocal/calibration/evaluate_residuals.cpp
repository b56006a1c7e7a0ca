// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "elastocal/calibration/floor.hpp"
#include "elastocal/calibration/residuals.hpp"
#include "elastocal/math/rotation_vector.hpp"

// The residuals and their Jacobians at given errors; residuals.cpp has what does not change.

namespace elastocal {
namespace {

Eigen::Index IndexInLeg(const SupportLeg& leg, int joint) {
  return std::find(leg.joints.begin(), leg.joints.end(), joint) - leg.joints.begin();
}

}  // namespace

Eigen::MatrixXd BodyResiduals::Whiten(int body, const Eigen::MatrixXd& displacement) const {
  return sds_[body].cwiseInverse().asDiagonal() *
         (in_.selection.bodies[body].basis.transpose() * displacement);
}

void BodyResiduals::Evaluate(const Eigen::VectorXd& x, bool with_jacobians) {
  x_ = x;
  geometry_ = ApplyErrors(in_.model, unknowns_.ToErrors(x));
  for (int i = 0; i < in_.recording.posture_count(); ++i) {
    if (blocks_of_posture_[i].empty()) continue;
    if (!placement_.empty()) {
      PlaceWaist(placement_.T_ref_waist[i], unknowns_.PoseStep(x, unknowns_.WaistBlock(i)),
                 geometry_);
    }
    jacobian_.Evaluate(geometry_, in_.recording.q.row(i).transpose(), LoadsNow(i));
    for (int block : blocks_of_posture_[i]) {
      if (block >= body_count()) {
        EvaluateTie(block, i);
      } else if (IsStandingFoot(i, in_.selection.bodies[block].body)) {
        EvaluateFoot(block, with_jacobians);
      } else {
        EvaluateBody(block, with_jacobians);
      }
    }
  }
  EvaluateFloors();
  const bool has_earlier = !earlier_entries_.empty();
  if (has_earlier) residuals_.back() = jacobians_.back() * x_(earlier_entries_) - earlier_offset_;
  const std::size_t first = residuals_.size() - prior_unknowns_.size() - (has_earlier ? 1 : 0);
  for (std::size_t p = 0; p < prior_unknowns_.size(); ++p) {
    Eigen::VectorXd& residual = residuals_[first + p];
    residual = prior_weights_[p] * x_.segment(prior_unknowns_[p], residual.size());
  }
}

void BodyResiduals::EvaluateFloors() {
  if (floor_footings_.empty()) return;
  const Eigen::Vector3d up = -in_.recording.gravity.normalized();
  const int first = floor_footings_.front();
  auto block = static_cast<std::size_t>(body_count()) + tied_postures_.size();
  for (int footing : floor_footings_) {
    const int leg = placement_.footings[static_cast<std::size_t>(footing)].leg;
    const FloorResidual at =
        EvaluateFloor(unknowns_.FootingPose(x_, footing), unknowns_.FootingPose(x_, first), up,
                      UpOfFoot(in_.model, leg));
    RowMajorMatrix& J = jacobians_[block];
    J.setZero(3, footing == first ? 6 : 12);
    J.leftCols<6>() = at.by_foot * unknowns_.FootingChart(x_, footing);
    if (footing == first) {
      J.row(2).setZero();  // its height refers to itself
    } else {
      J.row(2).rightCols<6>() = at.height_by_first * unknowns_.FootingChart(x_, first);
    }
    const Eigen::Vector3d weights = sds_[block].cwiseInverse();
    residuals_[block] = weights.cwiseProduct(at.residual);
    J = weights.asDiagonal() * J;
    ++block;
  }
}

void BodyResiduals::EvaluateBody(int block, bool with_jacobians) {
  const BodyObservation& body = in_.selection.bodies[block];
  const auto& shape = residual_blocks[block];
  raw_.resize(shape.size);
  Eigen::Index width = 0;
  for (int k : shape.parameter_blocks) width += parameter_blocks[k];
  if (with_jacobians) raw_jacobian_.setZero(shape.size, width);
  Eigen::Index own = 0;  // first column of the marker's own coordinates
  for (std::size_t n = 0; n < body.markers.size(); ++n) {
    const int marker = body.markers[n];
    const auto row = 3 * static_cast<Eigen::Index>(n);
    raw_.segment<3>(row) =
        MarkerPosition(in_.recording, body.posture, marker) - jacobian_.Position(marker);
    if (!with_jacobians) continue;
    const auto all = jacobian_.Block(marker);
    Eigen::Index at = 0;
    for (const BodyUnknowns::Columns& columns : marker_columns_[marker]) {
      const bool is_marker = unknowns_.IsMarkerBlock(columns.block);
      if (is_marker) at = std::max(at, own);
      for (std::size_t c = 0; c < columns.source.size(); ++c) {
        raw_jacobian_.block<3, 1>(row, at++) =
            -columns.scale[static_cast<Eigen::Index>(c)] * all.col(columns.source[c]);
      }
      if (is_marker) own = at;
    }
  }
  residuals_[block].noalias() = body.basis.transpose() * raw_;
  residuals_[block].array() /= sds_[block].array();
  if (!with_jacobians) return;
  jacobians_[block].noalias() = body.basis.transpose() * raw_jacobian_;
  jacobians_[block].array().colwise() /= sds_[block].array();
}

void BodyResiduals::EvaluateFoot(int block, bool with_jacobians) {
  const BodyObservation& body = in_.selection.bodies[block];
  const int footing = placement_.footing[body.posture];
  const int link = in_.model.legs[placement_.footings[footing].leg].link;
  const Transform T_ref_foot = unknowns_.FootingPose(x_, footing);
  const auto& shape = residual_blocks[block];
  raw_.resize(shape.size);
  Eigen::Index width = 0;
  for (int k : shape.parameter_blocks) width += parameter_blocks[k];
  if (with_jacobians) raw_jacobian_.setZero(shape.size, width);
  Eigen::Index at = 6;
  for (std::size_t n = 0; n < body.markers.size(); ++n) {
    const int marker = body.markers[n];
    const auto row = 3 * static_cast<Eigen::Index>(n);
    const MarkerInLink on_foot = PlaceMarker(in_.model, geometry_, marker, link);
    raw_.segment<3>(row) =
        MarkerPosition(in_.recording, body.posture, marker) - T_ref_foot * on_foot.position;
    if (!with_jacobians) continue;
    Eigen::Matrix<double, 3, 6> by_foot;
    by_foot << Eigen::Matrix3d::Identity(), -Skew(on_foot.position);
    raw_jacobian_.block<3, 6>(row, 0) =
        -T_ref_foot.linear() * by_foot * unknowns_.FootingChart(x_, footing);
    // The marker's own coordinates are its last three columns; corrections, which come before them,
    // are not applied on a foot that stands (PlaceMarker).
    const Eigen::Matrix3d by_marker = T_ref_foot.linear() * on_foot.axes;
    const auto first = static_cast<int>(jacobian_.Columns(marker).size()) - 3;
    for (const BodyUnknowns::Columns& own : marker_columns_[marker]) {
      if (!unknowns_.IsMarkerBlock(own.block)) continue;
      for (Eigen::Index c = 0; c < own.scale.size(); ++c, ++at) {
        const int axis = own.source[static_cast<std::size_t>(c)] - first;
        if (axis < 0) continue;
        raw_jacobian_.block<3, 1>(row, at) = -own.scale[c] * by_marker.col(axis);
      }
    }
  }
  residuals_[block] = (body.basis.transpose() * raw_).cwiseQuotient(sds_[block]);
  if (!with_jacobians) return;
  jacobians_[block] =
      sds_[block].cwiseInverse().asDiagonal() * (body.basis.transpose() * raw_jacobian_);
}

void BodyResiduals::EvaluateTie(int block, int posture) {
  const int footing = placement_.footing[posture];
  const int leg = placement_.footings[footing].leg;
  const PostureLoads load = in_.loads.empty() ? PostureLoads() : in_.loads[posture];
  const Vector6d wrench =
      leg < 0 ? Vector6d(Vector6d::Zero()) : load.WaistLoad(in_.model, geometry_, leg);
  SupportTie tie;
  tie.T_ref_waist = jacobian_.WaistPose();
  tie.T_ref_foot = unknowns_.FootingPose(x_, footing);
  tie.T_ref_foot_predicted = leg < 0 ? tie.T_ref_waist : jacobian_.LegPose(leg);
  if (leg >= 0) tie.deflection = geometry_.leg_compliance[leg].cwiseProduct(wrench);
  const TieResidual at = elastocal::EvaluateTie(tie);

  const Vector6d weight = sds_[block].cwiseInverse();
  residuals_[block] = weight.cwiseProduct(at.residual);

  RowMajorMatrix& J = jacobians_[block];
  Eigen::Index width = 0;
  for (int k : residual_blocks[block].parameter_blocks) width += parameter_blocks[k];
  J.resize(6, width);
  J.middleCols<6>(6) = at.by_foot * unknowns_.FootingChart(x_, footing);
  if (leg < 0) {
    J.leftCols<6>() = BodyUnknowns::kPoseScale * at.by_waist * jacobian_.WaistScrews();
  } else {
    FillTieJacobian(leg, load, wrench, at, J);
  }
  J = weight.asDiagonal() * J;
}

void BodyResiduals::FillTieJacobian(int leg, const PostureLoads& load, const Vector6d& wrench,
                                    const TieResidual& at, RowMajorMatrix& J) const {
  const auto& screws = jacobian_.LegScrews(leg);
  Eigen::Index next = 12;  // after waist and footing
  for (const BodyUnknowns::Columns& columns : leg_columns_[leg]) {
    const bool waist = columns.block == BodyUnknowns::kWaistBlock;
    Eigen::Index to = waist ? 0 : next;
    for (std::size_t c = 0; c < columns.source.size(); ++c) {
      J.col(to++) = columns.scale[static_cast<Eigen::Index>(c)] *
                    ((waist ? at.by_waist : at.by_leg) * screws.col(columns.source[c]));
    }
    if (!waist) next = to;
  }
  const BodyUnknowns::Deflection& deflection = deflections_[leg];
  for (std::size_t c = 0; c < deflection.parameters.size(); ++c) {
    const Parameter& parameter = in_.model.parameters[deflection.parameters[c]];
    Vector6d by = Vector6d::Zero();
    if (parameter.kind != ParameterKind::kTorqueBias) {
      const int axis = parameter.axis + (parameter.kind == ParameterKind::kLegMoment ? 3 : 0);
      by[axis] = wrench[axis];
    } else if (load.waist_by_bias.cols() > 0) {
      by = geometry_.leg_compliance[leg].cwiseProduct(
          load.waist_by_bias.col(IndexInLeg(in_.model.legs[leg], parameter.joint)));
    }
    J.col(next++) = deflection.scale[static_cast<Eigen::Index>(c)] * (at.by_deflection * by);
  }
}

}  // namespace elastocal
