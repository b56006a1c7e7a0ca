// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastocal/calibration/floor.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/measurement/moments.hpp"

namespace elastocal {
namespace {

constexpr int kWaistBlock = BodyUnknowns::kWaistBlock;
constexpr double kExactLeg = 1e-6;  // m and rad

Eigen::Index IndexInLeg(const SupportLeg& leg, int joint) {
  return std::find(leg.joints.begin(), leg.joints.end(), joint) - leg.joints.begin();
}

}  // namespace

BodyResiduals::BodyResiduals(const ResidualInputs& inputs, const std::vector<int>& free,
                             const Eigen::VectorXd& delta, const Placement& placement)
    : in_(inputs),
      placement_(placement),
      unknowns_(inputs.model, free, delta, placement),
      jacobian_(inputs.model, GeneralizedJacobian::LoadsOfRootJoints::kTurning),
      motion_(MotionOfPostures(inputs.recording)),
      loaded_geometry_(ApplyErrors(inputs.model, delta)) {
  parameter_blocks = unknowns_.block_sizes();
  nuisance_blocks = unknowns_.WaistBlocks();
  nonnegative = unknowns_.nonnegative();
  for (int m = 0; m < in_.model.marker_count(); ++m) {
    marker_columns_.push_back(unknowns_.MapColumns(jacobian_.Columns(m)));
  }
  for (int leg = 0; leg < in_.model.leg_count(); ++leg) {
    leg_columns_.push_back(unknowns_.MapColumns(jacobian_.LegColumns(leg)));
    deflections_.push_back(unknowns_.MapDeflection(leg));
  }
  blocks_of_posture_.resize(in_.recording.posture_count());
  for (const BodyObservation& body : in_.selection.bodies) MakeBodyBlock(body);
  MakeTieBlocks();
  MakeFloorBlocks();
  residuals_.resize(residual_blocks.size());
  jacobians_.resize(residual_blocks.size());
  MakePriorBlocks();
}

void BodyResiduals::MakeBodyBlock(const BodyObservation& body) {
  ResidualBlock block{static_cast<int>(body.size()), {}, body.used};
  if (IsStandingFoot(body.posture, body.body)) {
    block.parameter_blocks = {unknowns_.FootingBlock(placement_.footing[body.posture])};
  } else {
    for (const BodyUnknowns::Columns& columns : marker_columns_[body.markers.front()]) {
      if (unknowns_.IsMarkerBlock(columns.block)) continue;
      block.parameter_blocks.push_back(
          columns.block == kWaistBlock ? unknowns_.WaistBlock(body.posture) : columns.block);
    }
  }
  for (int m : body.markers) {
    for (const BodyUnknowns::Columns& columns : marker_columns_[m]) {
      if (!unknowns_.IsMarkerBlock(columns.block)) continue;
      block.parameter_blocks.push_back(columns.block);
    }
  }
  blocks_of_posture_[body.posture].push_back(static_cast<int>(residual_blocks.size()));
  sds_.push_back(BodySds(residual_blocks.size()));
  residual_blocks.push_back(std::move(block));
}

void BodyResiduals::MakeTieBlocks() {
  if (placement_.empty()) return;
  for (int i = 0; i < in_.recording.posture_count(); ++i) {
    const int footing = placement_.footing[i];
    if (footing < 0) continue;
    const int leg = placement_.footings[footing].leg;
    ResidualBlock block{
        6, {unknowns_.WaistBlock(i), unknowns_.FootingBlock(footing)}, in_.selection.tied[i] != 0};
    if (leg >= 0) {
      for (const BodyUnknowns::Columns& columns : leg_columns_[leg]) {
        if (columns.block != kWaistBlock) block.parameter_blocks.push_back(columns.block);
      }
      if (deflections_[leg].block >= 0) block.parameter_blocks.push_back(deflections_[leg].block);
    }
    blocks_of_posture_[i].push_back(static_cast<int>(residual_blocks.size()));
    tied_postures_.push_back(i);
    sds_.emplace_back(TieSds(i));
    residual_blocks.push_back(std::move(block));
  }
}

void BodyResiduals::MakeFloorBlocks() {
  if (std::isinf(in_.options.floor_tilt_sd) && std::isinf(in_.options.floor_height_sd)) return;
  floor_footings_ = FloorFootings(placement_);
  for (int footing : floor_footings_) {
    ResidualBlock block{3, {unknowns_.FootingBlock(footing)}, true};
    const int first = unknowns_.FootingBlock(floor_footings_.front());
    if (block.parameter_blocks.front() != first) block.parameter_blocks.push_back(first);
    const int leg = placement_.footings[static_cast<std::size_t>(footing)].leg;
    const auto at = static_cast<std::size_t>(footing);
    const auto reference = static_cast<std::size_t>(floor_footings_.front());
    const FloorUse use =
        UseOfFloor(EvaluateFloor(placement_.T_ref_footing[at], placement_.T_ref_footing[reference],
                                 -in_.recording.gravity.normalized(), UpOfFoot(in_.model, leg)));
    const double unknown = std::numeric_limits<double>::infinity();
    const double tilt = use.tilt ? in_.options.floor_tilt_sd : unknown;
    sds_.emplace_back(
        Eigen::Vector3d(tilt, tilt, use.height ? in_.options.floor_height_sd : unknown));
    residual_blocks.push_back(std::move(block));
  }
}

void BodyResiduals::MakePriorBlocks() {
  const auto add = [&](int block, int first, int rows, double weight) {
    residual_blocks.push_back({rows, {block}, true});
    prior_unknowns_.push_back(first);
    prior_weights_.push_back(weight);
    residuals_.emplace_back(rows);
    RowMajorMatrix J = RowMajorMatrix::Zero(rows, parameter_blocks[block]);
    J.middleCols(first - unknowns_.first_entry(block), rows).diagonal().setConstant(weight);
    jacobians_.push_back(std::move(J));
  };
  const EarlierPart earlier = PartOf(in_.options.earlier, in_.model, unknowns_.free());
  for (std::size_t u = 0; u < unknowns_.free().size(); ++u) {
    const Parameter& parameter = in_.model.parameters[unknowns_.free()[u]];
    const int unknown = static_cast<int>(u);
    if (std::binary_search(earlier.positions.begin(), earlier.positions.end(), unknown)) continue;
    add(unknowns_.block_of(unknown), unknown, 1,
        ParameterScale(parameter) / in_.prior.Of(in_.model.tree, parameter));
  }
  for (std::size_t f = 0; f < placement_.footings.size(); ++f) {
    const int block = unknowns_.FootingBlock(static_cast<int>(f));
    add(block, unknowns_.first_entry(block), 6, BodyUnknowns::kPoseScale);
  }
  if (!earlier.positions.empty()) MakeEarlierBlock(earlier);
}

void BodyResiduals::MakeEarlierBlock(const EarlierPart& earlier) {
  const Eigen::MatrixXd whitening = earlier.Whitening();
  const int rows = static_cast<int>(whitening.rows());
  ResidualBlock block{rows, {}, true};
  for (int unknown : earlier.positions) {
    const int of = unknowns_.block_of(unknown);
    if (block.parameter_blocks.empty() || block.parameter_blocks.back() != of) {
      block.parameter_blocks.push_back(of);
    }
  }
  std::vector<int> entries;
  for (int of : block.parameter_blocks) {
    for (int i = 0; i < parameter_blocks[of]; ++i) entries.push_back(unknowns_.first_entry(of) + i);
  }
  RowMajorMatrix J = RowMajorMatrix::Zero(rows, static_cast<Eigen::Index>(entries.size()));
  for (int i = 0; i < rows; ++i) {
    const int unknown = earlier.positions[i];
    const auto column = std::find(entries.begin(), entries.end(), unknown) - entries.begin();
    J.col(column) =
        whitening.col(i) * ParameterScale(in_.model.parameters[unknowns_.free()[unknown]]);
  }
  earlier_entries_ = std::move(entries);
  earlier_offset_ = whitening * earlier.mean;
  residual_blocks.push_back(std::move(block));
  residuals_.emplace_back(rows);
  jacobians_.push_back(std::move(J));
}

Eigen::VectorXd BodyResiduals::BodySds(std::size_t body) const {
  const BodyObservation& of = in_.selection.bodies[body];
  Eigen::ArrayXd variances = of.Variances(in_.noise, in_.group[of.posture]);
  if (!in_.weights.bodies.empty()) {
    const Weight& weight = in_.weights.bodies[body];
    const Eigen::Index shared = of.shared_rows();
    variances.head(shared) /= weight.shared;
    variances.tail(variances.size() - shared) /= weight.own;
  }
  return (variances / Counts(static_cast<int>(body))).sqrt();
}

Vector6d BodyResiduals::TieSds(int posture) const {
  Vector6d sds;
  const int group = in_.group[posture];
  sds.head<3>().setConstant(in_.noise(group, NoiseSource::kWaistPosition));
  sds.tail<3>().setConstant(in_.noise(group, NoiseSource::kWaistRotation));
  if (in_.options.support_form == SupportForm::kFootRooted) sds.setConstant(kExactLeg);
  if (!in_.weights.ties.empty()) sds /= std::sqrt(in_.weights.ties[posture]);
  return sds * std::sqrt(SamplesEach(posture, &MotionCorrelation::waist));
}

double BodyResiduals::SamplesEach(int posture, Autocorrelation MotionCorrelation::*of) const {
  if (motion_[posture] < 0 || in_.noise.motion.empty()) return 1.0;
  return (in_.noise.motion[in_.group[posture]].*of).samples_each;
}

Eigen::ArrayXd BodyResiduals::Counts(int block) const {
  if (block >= body_count()) {
    const int posture = tied_postures_[block - body_count()];
    return Eigen::ArrayXd::Constant(6, 1.0 / SamplesEach(posture, &MotionCorrelation::waist));
  }
  const BodyObservation& of = in_.selection.bodies[block];
  return of.Counts(in_.noise, in_.group[of.posture],
                   SamplesEach(of.posture, &MotionCorrelation::bodies));
}

bool BodyResiduals::IsStandingFoot(int posture, int body) const {
  if (placement_.empty() || placement_.footing[posture] < 0) return false;
  const int leg = placement_.footings[placement_.footing[posture]].leg;
  return leg >= 0 && body == in_.model.tree.links[in_.model.legs[leg].link].body;
}

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
    const bool waist = columns.block == kWaistBlock;
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
