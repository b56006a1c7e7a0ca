#include "elastocal/calibration/residuals.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/calibration/support_tie.hpp"
#include "elastocal/math/rotation_vector.hpp"

namespace elastocal {
namespace {

constexpr int kWaistBlock = BodyUnknowns::kWaistBlock;
constexpr double kExactMarker = 1e-6;  // m: "exact", yet well conditioned
constexpr double kExactLeg = 1e-6;     // m and rad

Eigen::Index IndexInLeg(const SupportLeg& leg, int joint) {
  return std::find(leg.joints.begin(), leg.joints.end(), joint) - leg.joints.begin();
}

}  // namespace

ObservationMask SeenMask(const Recording& recording) {
  ObservationMask mask(recording.posture_count(), recording.marker_count());
  for (int i = 0; i < mask.rows(); ++i) {
    for (int m = 0; m < mask.cols(); ++m) mask(i, m) = Seen(recording, i, m);
  }
  return mask;
}

BodyResiduals::BodyResiduals(const ResidualInputs& inputs, const std::vector<int>& free,
                             const Eigen::VectorXd& delta, const Placement& placement)
    : in_(inputs),
      placement_(placement),
      unknowns_(inputs.model, inputs.prior, free, delta, placement),
      jacobian_(inputs.model) {
  parameter_blocks = unknowns_.block_sizes();
  eliminated_blocks = unknowns_.EliminatedBlocks();
  nonnegative = unknowns_.nonnegative();
  for (int m = 0; m < in_.model.marker_count(); ++m) {
    marker_columns_.push_back(unknowns_.MapColumns(jacobian_.Columns(m)));
  }
  for (int leg = 0; leg < in_.model.leg_count(); ++leg) {
    leg_columns_.push_back(unknowns_.MapColumns(jacobian_.LegColumns(leg)));
    deflections_.push_back(unknowns_.MapDeflection(leg));
  }
  blocks_of_posture_.resize(in_.recording.posture_count());
  MakeMarkerBlocks();
  MakeTieBlocks();
  residuals_.resize(meanings_.size());
  jacobians_.resize(meanings_.size());
  MakePriorBlocks();
}

void BodyResiduals::MakeMarkerBlocks() {
  const ObservationMask seen = SeenMask(in_.recording);
  for (int i = 0; i < seen.rows(); ++i) {
    for (int m = 0; m < seen.cols(); ++m) {
      if (!seen(i, m) || marker_columns_[m].empty()) continue;
      ResidualBlock block{3, {}, true, in_.used(i, m)};
      if (OnStandingFoot(i, m)) {
        block.parameter_blocks = {unknowns_.FootingBlock(placement_.footing[i])};
        const int last = marker_columns_[m].back().block;
        if (unknowns_.IsMarkerBlock(last)) block.parameter_blocks.push_back(last);
      } else {
        for (const BodyUnknowns::Columns& columns : marker_columns_[m]) {
          block.parameter_blocks.push_back(columns.block == kWaistBlock ? unknowns_.WaistBlock(i)
                                                                        : columns.block);
        }
      }
      blocks_of_posture_[i].push_back(static_cast<int>(residual_blocks.size()));
      residual_blocks.push_back(std::move(block));
      meanings_.push_back({i, m});
    }
  }
}

void BodyResiduals::MakeTieBlocks() {
  if (placement_.empty()) return;
  for (int i = 0; i < in_.recording.posture_count(); ++i) {
    const int footing = placement_.footing[i];
    if (footing < 0) continue;
    const int leg = placement_.footings[footing].leg;
    ResidualBlock block{
        6, {unknowns_.WaistBlock(i), unknowns_.FootingBlock(footing)}, true, in_.tied[i] != 0};
    if (leg >= 0) {
      for (const BodyUnknowns::Columns& columns : leg_columns_[leg]) {
        if (columns.block != kWaistBlock) block.parameter_blocks.push_back(columns.block);
      }
      if (deflections_[leg].block >= 0) block.parameter_blocks.push_back(deflections_[leg].block);
    }
    blocks_of_posture_[i].push_back(static_cast<int>(residual_blocks.size()));
    residual_blocks.push_back(std::move(block));
    meanings_.push_back({i, -1});
  }
}

void BodyResiduals::MakePriorBlocks() {
  for (std::size_t u = 0; u < unknowns_.free().size(); ++u) {
    if (!std::isfinite(in_.prior[in_.model.parameters[unknowns_.free()[u]].kind])) continue;
    residual_blocks.push_back({1, {unknowns_.block_of(static_cast<int>(u))}, false, true});
    prior_unknowns_.push_back(static_cast<int>(u));
  }
}

double BodyResiduals::MarkerSd(int posture, int marker) const {
  const bool exact = in_.form == SupportForm::kPenalty && !placement_.empty() &&
                     placement_.footing[posture] >= 0 &&
                     in_.model.tree.links[in_.model.markers[marker].link].body == 0;
  return exact ? kExactMarker : in_.noise.marker_sd[in_.group[posture]];
}

bool BodyResiduals::OnStandingFoot(int posture, int marker) const {
  if (placement_.empty() || placement_.footing[posture] < 0) return false;
  const int leg = placement_.footings[placement_.footing[posture]].leg;
  const auto body = [&](int link) { return in_.model.tree.links[link].body; };
  return leg >= 0 && body(in_.model.markers[marker].link) == body(in_.model.legs[leg].link);
}

void BodyResiduals::Evaluate(const Eigen::VectorXd& x, bool /*with_jacobians*/) {
  x_ = x;
  geometry_ = ApplyErrors(in_.model, unknowns_.ToErrors(x));
  for (int i = 0; i < in_.recording.posture_count(); ++i) {
    if (blocks_of_posture_[i].empty()) continue;
    if (!placement_.empty()) {
      PlaceWaist(placement_.T_ref_waist[i], unknowns_.PoseStep(x, unknowns_.WaistBlock(i)),
                 geometry_);
    }
    jacobian_.Evaluate(geometry_, in_.recording.q.row(i).transpose(),
                       in_.loads.empty() ? JointLoads() : in_.loads[i].joints);
    for (int block : blocks_of_posture_[i]) {
      const int m = meanings_[block].marker;
      if (m < 0) {
        EvaluateTieBlock(block, i);
      } else if (OnStandingFoot(i, m)) {
        EvaluateFootMarker(block, i, m);
      } else {
        EvaluateMarker(block, i, m);
      }
    }
  }
}

void BodyResiduals::EvaluateMarker(int block, int posture, int marker) {
  const double weight = 1.0 / MarkerSd(posture, marker);
  residuals_[block] =
      weight * (MarkerPosition(in_.recording, posture, marker) - jacobian_.Position(marker));
  const auto all = jacobian_.Block(marker);
  RowMajorMatrix& J = jacobians_[block];
  Eigen::Index width = 0;
  for (const BodyUnknowns::Columns& columns : marker_columns_[marker])
    width += columns.scale.size();
  J.resize(3, width);
  Eigen::Index at = 0;
  for (const BodyUnknowns::Columns& columns : marker_columns_[marker]) {
    for (std::size_t c = 0; c < columns.source.size(); ++c) {
      J.col(at++) =
          (-weight * columns.scale[static_cast<Eigen::Index>(c)]) * all.col(columns.source[c]);
    }
  }
}

void BodyResiduals::EvaluateFootMarker(int block, int posture, int marker) {
  const int footing = placement_.footing[posture];
  const int link = in_.model.legs[placement_.footings[footing].leg].link;
  const MarkerInLink on_foot = PlaceMarker(in_.model, geometry_, marker, link);
  const Transform T_ref_foot = unknowns_.FootingPose(x_, footing);
  const double weight = 1.0 / MarkerSd(posture, marker);
  residuals_[block] =
      weight * (MarkerPosition(in_.recording, posture, marker) - T_ref_foot * on_foot.position);
  RowMajorMatrix& J = jacobians_[block];
  const bool estimated = residual_blocks[block].parameter_blocks.size() > 1;
  const BodyUnknowns::Columns& own = marker_columns_[marker].back();
  J.resize(3, estimated ? 6 + own.scale.size() : 6);
  Eigen::Matrix<double, 3, 6> by_foot;
  by_foot << Eigen::Matrix3d::Identity(), -Skew(on_foot.position);
  J.leftCols(6) = -weight * T_ref_foot.linear() * by_foot * unknowns_.FootingChart(x_, footing);
  if (!estimated) return;
  // The marker's own coordinates are the last three columns of its block.
  const Eigen::Matrix3d by_marker = T_ref_foot.linear() * on_foot.axes;
  const auto first = static_cast<int>(jacobian_.Columns(marker).size()) - 3;
  for (Eigen::Index c = 0; c < own.scale.size(); ++c) {
    J.col(6 + c) =
        -weight * own.scale[c] * by_marker.col(own.source[static_cast<std::size_t>(c)] - first);
  }
}

void BodyResiduals::EvaluateTieBlock(int block, int posture) {
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
  const TieResidual at = EvaluateTie(tie);

  const int group = in_.group[posture];
  Vector6d weight;
  weight.head<3>().setConstant(1.0 / in_.noise.waist_position_sd[group]);
  weight.tail<3>().setConstant(1.0 / in_.noise.waist_rotation_sd[group]);
  if (in_.form == SupportForm::kFootRooted) weight.setConstant(1.0 / kExactLeg);
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

void BodyResiduals::Residual(int block, Eigen::Map<Eigen::VectorXd> residual) const {
  const auto observation_count = static_cast<int>(meanings_.size());
  if (block < observation_count) {
    residual = residuals_[block];
  } else {
    residual[0] = x_[prior_unknowns_[block - observation_count]];  // in units of the prior already
  }
}

void BodyResiduals::Jacobian(int block, int k, Eigen::Map<RowMajorMatrix> jacobian) const {
  const auto observation_count = static_cast<int>(meanings_.size());
  if (block < observation_count) {
    Eigen::Index at = 0;
    for (int before = 0; before < k; ++before) {
      at += parameter_blocks[residual_blocks[block].parameter_blocks[before]];
    }
    jacobian = jacobians_[block].middleCols(at, jacobian.cols());
    return;
  }
  jacobian.setZero();
  jacobian(0, prior_unknowns_[block - observation_count] -
                  unknowns_.first_entry(residual_blocks[block].parameter_blocks[0])) = 1.0;
}

}  // namespace elastocal
