// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/body_unknowns.hpp"

#include <algorithm>
#include <numeric>

#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

BodyUnknowns::BodyUnknowns(const ErrorModel& model, const std::vector<int>& free,
                           const Eigen::VectorXd& delta, const Placement& placement)
    : model_(model), placement_(placement), free_(free), fixed_(delta) {
  MakeParameterBlocks();
  first_footing_block_ = static_cast<int>(block_sizes_.size());
  block_sizes_.insert(block_sizes_.end(), placement_.footings.size(), 6);
  first_waist_block_ = static_cast<int>(block_sizes_.size());
  block_sizes_.insert(block_sizes_.end(), placement_.T_ref_waist.size(), 6);
  is_marker_.resize(block_sizes_.size(), 0);
  first_entry_.assign(block_sizes_.size() + 1, 0);
  std::partial_sum(block_sizes_.begin(), block_sizes_.end(), first_entry_.begin() + 1);
}

void BodyUnknowns::MakeParameterBlocks() {
  scale_.resize(static_cast<Eigen::Index>(free_.size()));
  const Parameter* previous = nullptr;
  const auto same_block = [&](const Parameter& parameter) {
    if (previous == nullptr || previous->marker != parameter.marker ||
        previous->leg != parameter.leg || previous->linkage != parameter.linkage) {
      return false;
    }
    return parameter.leg >= 0 || previous->joint == parameter.joint;
  };
  for (std::size_t u = 0; u < free_.size(); ++u) {
    const Parameter& parameter = model_.parameters[free_[u]];
    scale_[static_cast<Eigen::Index>(u)] = ParameterScale(parameter);
    if (IsCompliance(parameter.kind)) nonnegative_.push_back(static_cast<int>(u));
    if (!same_block(parameter)) {
      block_sizes_.push_back(0);
      is_marker_.push_back(parameter.marker >= 0 ? 1 : 0);
    }
    ++block_sizes_.back();
    block_of_.push_back(static_cast<int>(block_sizes_.size()) - 1);
    previous = &parameter;
  }
}

std::vector<int> BodyUnknowns::WaistBlocks() const {
  std::vector<int> blocks(placement_.T_ref_waist.size());
  std::iota(blocks.begin(), blocks.end(), first_waist_block_);
  return blocks;
}

Eigen::VectorXd BodyUnknowns::Start() const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(first_entry_.back());
  x.head(scale_.size()) = fixed_(free_).cwiseQuotient(scale_);
  return x;
}

Eigen::VectorXd BodyUnknowns::ToErrors(const Eigen::VectorXd& x) const {
  Eigen::VectorXd delta = fixed_;
  delta(free_) = scale_.cwiseProduct(x.head(scale_.size()));
  return delta;
}

Placement BodyUnknowns::ToPlacement(const Eigen::VectorXd& x) const {
  Placement placement = placement_;
  for (std::size_t f = 0; f < placement.footings.size(); ++f) {
    placement.T_ref_footing[f] = FootingPose(x, static_cast<int>(f));
  }
  Geometry geometry = ApplyErrors(model_, fixed_);
  for (std::size_t i = 0; i < placement.T_ref_waist.size(); ++i) {
    PlaceWaist(placement_.T_ref_waist[i], PoseStep(x, WaistBlock(static_cast<int>(i))), geometry);
    placement.T_ref_waist[i] = WaistPose(geometry);
  }
  return placement;
}

Vector6d BodyUnknowns::PoseStep(const Eigen::VectorXd& x, int block) const {
  return kPoseScale * x.segment<6>(first_entry_[block]);
}

Transform BodyUnknowns::FootingPose(const Eigen::VectorXd& x, int footing) const {
  const Vector6d step = PoseStep(x, FootingBlock(footing));
  Transform T = placement_.T_ref_footing[footing];
  T.translation() += T.linear() * step.head<3>();
  T.linear() = T.linear() * RotationFromVector(step.tail<3>());
  return T;
}

Matrix6d BodyUnknowns::FootingChart(const Eigen::VectorXd& x, int footing) const {
  const Vector6d step = PoseStep(x, FootingBlock(footing));
  Matrix6d chart = Matrix6d::Identity();
  chart.topLeftCorner<3, 3>() = RotationFromVector(-step.tail<3>());
  chart.bottomRightCorner<3, 3>() = LeftJacobian(step.tail<3>()).transpose();
  return kPoseScale * chart;
}

std::vector<BodyUnknowns::Columns> BodyUnknowns::MapColumns(
    const std::vector<int>& parameters) const {
  std::vector<Columns> blocks;
  for (std::size_t c = 0; c < parameters.size(); ++c) {
    const bool waist = !placement_.empty() && parameters[c] < kWaistParameterCount;
    const auto found = std::lower_bound(free_.begin(), free_.end(), parameters[c]);
    if (!waist && (found == free_.end() || *found != parameters[c])) continue;
    const auto unknown = found - free_.begin();
    const int block = waist ? kWaistBlock : block_of_[unknown];
    if (blocks.empty() || blocks.back().block != block) blocks.push_back({block, {}, {}});
    Columns& last = blocks.back();
    last.source.push_back(static_cast<int>(c));
    last.scale.conservativeResize(last.scale.size() + 1);
    last.scale[last.scale.size() - 1] = waist ? kPoseScale : scale_[unknown];
  }
  return blocks;
}

BodyUnknowns::Deflection BodyUnknowns::MapDeflection(int leg) const {
  Deflection deflection;
  for (std::size_t u = 0; u < free_.size(); ++u) {
    if (model_.parameters[free_[u]].leg != leg) continue;
    deflection.block = block_of_[u];
    deflection.parameters.push_back(free_[u]);
    deflection.scale.conservativeResize(deflection.scale.size() + 1);
    deflection.scale[deflection.scale.size() - 1] = scale_[static_cast<Eigen::Index>(u)];
  }
  return deflection;
}

}  // namespace elastocal
