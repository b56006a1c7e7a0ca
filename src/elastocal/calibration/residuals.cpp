#include "elastocal/calibration/residuals.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "elastocal/calibration/support_tie.hpp"
#include "elastocal/math/rotation_vector.hpp"

namespace elastocal {
namespace {

constexpr int kWaistBlock = -1;        // in BlockColumns: the block of the posture's waist
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

double ParameterScale(const Parameter& parameter, const Prior& prior) {
  const double sd = prior[parameter.kind];
  return std::isfinite(sd) ? sd : 0.01;
}

BodyResiduals::BodyResiduals(const ResidualInputs& inputs, const std::vector<int>& free,
                             const Eigen::VectorXd& delta, const Placement& placement)
    : in_(inputs), fixed_(delta), placement_(placement), free_(free), jacobian_(inputs.model) {
  MakeParameterBlocks(free);
  MakePoseBlocks();
  for (int m = 0; m < in_.model.marker_count(); ++m) {
    marker_columns_.push_back(MapColumns(jacobian_.Columns(m)));
  }
  for (int leg = 0; leg < in_.model.leg_count(); ++leg) {
    leg_columns_.push_back(MapColumns(jacobian_.LegColumns(leg)));
    deflections_.push_back(MapDeflection(leg));
  }
  blocks_of_posture_.resize(in_.recording.posture_count());
  MakeMarkerBlocks();
  MakeTieBlocks();
  residuals_.resize(meanings_.size());
  jacobians_.resize(meanings_.size());
  MakePriorBlocks();
}

void BodyResiduals::MakeParameterBlocks(const std::vector<int>& free) {
  scale_.resize(static_cast<Eigen::Index>(free.size()));
  const Parameter* previous = nullptr;
  const auto same_block = [&](const Parameter& parameter) {
    if (previous == nullptr || previous->marker != parameter.marker ||
        previous->leg != parameter.leg) {
      return false;
    }
    return parameter.leg >= 0 || previous->joint == parameter.joint;
  };
  std::vector<int> markers;
  for (std::size_t u = 0; u < free.size(); ++u) {
    const Parameter& parameter = in_.model.parameters[free[u]];
    scale_[static_cast<Eigen::Index>(u)] = ParameterScale(parameter, in_.prior);
    if (IsCompliance(parameter.kind)) nonnegative.push_back(static_cast<int>(u));
    if (!same_block(parameter)) {
      if (parameter.marker >= 0) markers.push_back(static_cast<int>(parameter_blocks.size()));
      parameter_blocks.push_back(0);
    }
    ++parameter_blocks.back();
    block_of_.push_back(static_cast<int>(parameter_blocks.size()) - 1);
    previous = &parameter;
  }
  // Elimination needs something to eliminate from, and gains nothing for a single block.
  if (placement_.empty() && markers.size() < parameter_blocks.size() && markers.size() > 1) {
    eliminated_blocks = markers;
  }
}

void BodyResiduals::MakePoseBlocks() {
  first_footing_block_ = static_cast<int>(parameter_blocks.size());
  parameter_blocks.insert(parameter_blocks.end(), placement_.footings.size(), 6);
  first_waist_block_ = static_cast<int>(parameter_blocks.size());
  parameter_blocks.insert(parameter_blocks.end(), placement_.T_ref_waist.size(), 6);
  if (!placement_.empty()) eliminated_blocks = WaistBlocks();
  first_entry_.assign(parameter_blocks.size() + 1, 0);
  std::partial_sum(parameter_blocks.begin(), parameter_blocks.end(), first_entry_.begin() + 1);
}

std::vector<int> BodyResiduals::WaistBlocks() const {
  std::vector<int> blocks(placement_.T_ref_waist.size());
  std::iota(blocks.begin(), blocks.end(), first_waist_block_);
  return blocks;
}

std::vector<BodyResiduals::BlockColumns> BodyResiduals::MapColumns(
    const std::vector<int>& columns) const {
  std::vector<BlockColumns> blocks;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool waist = !placement_.empty() && columns[c] < kBaseParameterCount;
    const auto found = std::lower_bound(free_.begin(), free_.end(), columns[c]);
    if (!waist && (found == free_.end() || *found != columns[c])) continue;
    const auto unknown = found - free_.begin();
    const int block = waist ? kWaistBlock : block_of_[unknown];
    if (blocks.empty() || blocks.back().block != block) blocks.push_back({block, {}, {}});
    BlockColumns& last = blocks.back();
    last.source.push_back(static_cast<int>(c));
    last.scale.conservativeResize(last.scale.size() + 1);
    last.scale[last.scale.size() - 1] = waist ? kPoseScale : scale_[unknown];
  }
  return blocks;
}

BodyResiduals::Deflection BodyResiduals::MapDeflection(int leg) const {
  Deflection deflection;
  for (std::size_t u = 0; u < free_.size(); ++u) {
    if (in_.model.parameters[free_[u]].leg != leg) continue;
    deflection.block = block_of_[u];
    deflection.parameters.push_back(free_[u]);
    deflection.scale.conservativeResize(deflection.scale.size() + 1);
    deflection.scale[deflection.scale.size() - 1] = scale_[static_cast<Eigen::Index>(u)];
  }
  return deflection;
}

bool BodyResiduals::IsMarkerBlock(int block) const {
  const auto first = std::find(block_of_.begin(), block_of_.end(), block);
  return first != block_of_.end() &&
         in_.model.parameters[free_[first - block_of_.begin()]].marker >= 0;
}

void BodyResiduals::MakeMarkerBlocks() {
  const ObservationMask seen = SeenMask(in_.recording);
  for (int i = 0; i < seen.rows(); ++i) {
    for (int m = 0; m < seen.cols(); ++m) {
      if (!seen(i, m) || marker_columns_[m].empty()) continue;
      ResidualBlock block{3, {}, true, in_.used(i, m)};
      if (OnStandingFoot(i, m)) {
        block.parameter_blocks = {first_footing_block_ + placement_.footing[i]};
        const int last = marker_columns_[m].back().block;
        if (IsMarkerBlock(last)) block.parameter_blocks.push_back(last);
      } else {
        for (const BlockColumns& columns : marker_columns_[m]) {
          block.parameter_blocks.push_back(columns.block == kWaistBlock ? first_waist_block_ + i
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
        6, {first_waist_block_ + i, first_footing_block_ + footing}, true, in_.tied[i] != 0};
    if (leg >= 0) {
      for (const BlockColumns& columns : leg_columns_[leg]) {
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
  for (std::size_t u = 0; u < free_.size(); ++u) {
    if (!std::isfinite(in_.prior[in_.model.parameters[free_[u]].kind])) continue;
    residual_blocks.push_back({1, {block_of_[u]}, false, true});
    prior_unknowns_.push_back(static_cast<int>(u));
  }
}

Eigen::VectorXd BodyResiduals::Start() const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(first_entry_.back());
  x.head(scale_.size()) = fixed_(free_).cwiseQuotient(scale_);
  return x;
}

Eigen::VectorXd BodyResiduals::ToErrors(const Eigen::VectorXd& x) const {
  Eigen::VectorXd delta = fixed_;
  delta(free_) = scale_.cwiseProduct(x.head(scale_.size()));
  return delta;
}

Placement BodyResiduals::ToPlacement(const Eigen::VectorXd& x) const {
  Placement placement = placement_;
  for (std::size_t f = 0; f < placement.footings.size(); ++f) {
    placement.T_ref_footing[f] = FootingPose(x, static_cast<int>(f));
  }
  Geometry geometry = ApplyErrors(in_.model, fixed_);
  for (std::size_t i = 0; i < placement.T_ref_waist.size(); ++i) {
    const Vector6d step =
        kPoseScale * x.segment<6>(first_entry_[first_waist_block_ + static_cast<int>(i)]);
    PlaceWaist(placement_.T_ref_waist[i], step, geometry);
    placement.T_ref_waist[i] = WaistPose(geometry);
  }
  return placement;
}

double BodyResiduals::MarkerSd(int posture, int marker) const {
  const bool exact = in_.form == SupportForm::kPenalty && !placement_.empty() &&
                     placement_.footing[posture] >= 0 &&
                     in_.model.tree.links[in_.model.markers[marker].link].body == 0;
  return exact ? kExactMarker : in_.noise.marker_sd[in_.group[posture]];
}

Vector6d BodyResiduals::PoseAt(int block) const {
  return kPoseScale * x_.segment<6>(first_entry_[block]);
}

bool BodyResiduals::OnStandingFoot(int posture, int marker) const {
  if (placement_.empty() || placement_.footing[posture] < 0) return false;
  const int leg = placement_.footings[placement_.footing[posture]].leg;
  const auto body = [&](int link) { return in_.model.tree.links[link].body; };
  return leg >= 0 && body(in_.model.markers[marker].link) == body(in_.model.legs[leg].link);
}

Transform BodyResiduals::FootingPose(const Eigen::VectorXd& x, int footing) const {
  const Vector6d step = kPoseScale * x.segment<6>(first_entry_[first_footing_block_ + footing]);
  Transform T = placement_.T_ref_footing[footing];
  T.translation() += T.linear() * step.head<3>();
  T.linear() = T.linear() * RotationFromVector(step.tail<3>());
  return T;
}

Matrix6d BodyResiduals::FootingChart(int footing) const {
  const Vector6d step = PoseAt(first_footing_block_ + footing);
  Matrix6d chart = Matrix6d::Identity();
  chart.topLeftCorner<3, 3>() = RotationFromVector(-step.tail<3>());
  chart.bottomRightCorner<3, 3>() = LeftJacobian(step.tail<3>()).transpose();
  return kPoseScale * chart;
}

void BodyResiduals::Evaluate(const Eigen::VectorXd& x, bool /*with_jacobians*/) {
  x_ = x;
  delta_ = ToErrors(x);
  geometry_ = ApplyErrors(in_.model, delta_);
  for (int i = 0; i < in_.recording.posture_count(); ++i) {
    if (blocks_of_posture_[i].empty()) continue;
    if (!placement_.empty()) {
      PlaceWaist(placement_.T_ref_waist[i], PoseAt(first_waist_block_ + i), geometry_);
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
  for (const BlockColumns& columns : marker_columns_[marker]) width += columns.scale.size();
  J.resize(3, width);
  Eigen::Index at = 0;
  for (const BlockColumns& columns : marker_columns_[marker]) {
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
  const Transform T_ref_foot = FootingPose(x_, footing);
  const double weight = 1.0 / MarkerSd(posture, marker);
  residuals_[block] =
      weight * (MarkerPosition(in_.recording, posture, marker) - T_ref_foot * on_foot.position);
  RowMajorMatrix& J = jacobians_[block];
  const bool estimated = residual_blocks[block].parameter_blocks.size() > 1;
  const BlockColumns& own = marker_columns_[marker].back();
  J.resize(3, estimated ? 6 + own.scale.size() : 6);
  Eigen::Matrix<double, 3, 6> by_foot;
  by_foot << Eigen::Matrix3d::Identity(), -Skew(on_foot.position);
  J.leftCols(6) = -weight * T_ref_foot.linear() * by_foot * FootingChart(footing);
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
  tie.T_ref_foot = FootingPose(x_, footing);
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
  J.middleCols<6>(6) = at.by_foot * FootingChart(footing);
  if (leg < 0) {
    J.leftCols<6>() = kPoseScale * at.by_waist * jacobian_.WaistScrews();
  } else {
    FillTieJacobian(leg, load, wrench, at, J);
  }
  J = weight.asDiagonal() * J;
}

void BodyResiduals::FillTieJacobian(int leg, const PostureLoads& load, const Vector6d& wrench,
                                    const TieResidual& at, RowMajorMatrix& J) const {
  const auto& screws = jacobian_.LegScrews(leg);
  Eigen::Index next = 12;  // after waist and footing
  for (const BlockColumns& columns : leg_columns_[leg]) {
    const bool waist = columns.block == kWaistBlock;
    Eigen::Index to = waist ? 0 : next;
    for (std::size_t c = 0; c < columns.source.size(); ++c) {
      J.col(to++) = columns.scale[static_cast<Eigen::Index>(c)] *
                    ((waist ? at.by_waist : at.by_leg) * screws.col(columns.source[c]));
    }
    if (!waist) next = to;
  }
  const Deflection& deflection = deflections_[leg];
  for (std::size_t c = 0; c < deflection.parameters.size(); ++c) {
    const Parameter& parameter = in_.model.parameters[deflection.parameters[c]];
    Vector6d by = Vector6d::Zero();
    if (parameter.kind != ParameterKind::kTorqueBias) {
      const int axis = parameter.axis + (parameter.kind == ParameterKind::kBaseMoment ? 3 : 0);
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
                  first_entry_[residual_blocks[block].parameter_blocks[0]]) = 1.0;
}

}  // namespace elastocal
