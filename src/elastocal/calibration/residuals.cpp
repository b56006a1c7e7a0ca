// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "elastocal/calibration/floor.hpp"
#include "elastocal/measurement/moments.hpp"

namespace elastocal {
namespace {

constexpr int kWaistBlock = BodyUnknowns::kWaistBlock;
constexpr double kExactLeg = 1e-6;  // m and rad

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

}  // namespace elastocal
