#include "elastocal/calibration/residuals.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

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

MarkerResiduals::MarkerResiduals(const ErrorModel& model, const Recording& recording,
                                 const ObservationMask& mask, const std::vector<int>& free,
                                 const Eigen::VectorXd& fixed, const Prior& prior, double marker_sd)
    : model_(model),
      recording_(recording),
      fixed_(fixed),
      marker_sd_(marker_sd),
      free_(free),
      jacobian_(model) {
  MakeParameterBlocks(free, prior);
  MakeResidualBlocks(mask, prior);
}

void MarkerResiduals::MakeParameterBlocks(const std::vector<int>& free, const Prior& prior) {
  scale_.resize(static_cast<Eigen::Index>(free.size()));
  const Parameter* previous = nullptr;
  for (std::size_t u = 0; u < free.size(); ++u) {
    const Parameter& parameter = model_.parameters[free[u]];
    scale_[static_cast<Eigen::Index>(u)] = ParameterScale(parameter, prior);
    const bool same = previous != nullptr && previous->joint == parameter.joint &&
                      previous->marker == parameter.marker;
    if (!same) {
      if (parameter.marker >= 0) {
        eliminated_blocks.push_back(static_cast<int>(parameter_blocks.size()));
      }
      parameter_blocks.push_back(0);
    }
    ++parameter_blocks.back();
    block_of_.push_back(static_cast<int>(parameter_blocks.size()) - 1);
    previous = &parameter;
  }
  // Elimination needs something to eliminate from, and gains nothing for a single block.
  if (eliminated_blocks.size() == parameter_blocks.size() || eliminated_blocks.size() < 2) {
    eliminated_blocks.clear();
  }

  for (int m = 0; m < model_.marker_count(); ++m) {
    const std::vector<int>& columns = jacobian_.Columns(m);
    std::vector<BlockColumns>& blocks = marker_columns_.emplace_back();
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto found = std::lower_bound(free.begin(), free.end(), columns[c]);
      if (found == free.end() || *found != columns[c]) continue;
      const auto unknown = found - free.begin();
      if (blocks.empty() || blocks.back().block != block_of_[unknown]) {
        blocks.push_back({block_of_[unknown], {}, {}});
      }
      BlockColumns& block = blocks.back();
      block.source.push_back(static_cast<int>(c));
      block.scale.conservativeResize(block.scale.size() + 1);
      block.scale[block.scale.size() - 1] = -scale_[unknown] / marker_sd_;
    }
  }
}

void MarkerResiduals::MakeResidualBlocks(const ObservationMask& mask, const Prior& prior) {
  for (int i = 0; i < mask.rows(); ++i) {
    for (int m = 0; m < mask.cols(); ++m) {
      if (!mask(i, m) || marker_columns_[m].empty()) continue;
      ResidualBlock block{3, {}, true};
      for (const BlockColumns& columns : marker_columns_[m]) {
        block.parameter_blocks.push_back(columns.block);
      }
      residual_blocks.push_back(std::move(block));
      observations_.push_back({i, m});
    }
  }
  for (std::size_t u = 0; u < free_.size(); ++u) {
    if (!std::isfinite(prior[model_.parameters[free_[u]].kind])) continue;
    residual_blocks.push_back({1, {block_of_[u]}, false});
    prior_unknowns_.push_back(static_cast<int>(u));
  }
  residuals_.resize(3, static_cast<Eigen::Index>(observations_.size()));
  jacobians_.resize(observations_.size());
}

Eigen::VectorXd MarkerResiduals::ToErrors(const Eigen::VectorXd& x) const {
  Eigen::VectorXd delta = fixed_;
  delta(free_) = scale_.cwiseProduct(x);
  return delta;
}

Eigen::VectorXd MarkerResiduals::FromErrors(const Eigen::VectorXd& delta) const {
  return delta(free_).cwiseQuotient(scale_);
}

void MarkerResiduals::Evaluate(const Eigen::VectorXd& x, bool with_jacobians) {
  x_ = x;
  const Geometry geometry = ApplyErrors(model_, ToErrors(x));
  Eigen::Matrix3Xd predicted;
  int posture = -1;
  for (std::size_t i = 0; i < observations_.size(); ++i) {
    const Observation& observation = observations_[i];
    if (observation.posture != posture) {
      posture = observation.posture;
      const Eigen::VectorXd q = recording_.q.row(posture).transpose();
      if (with_jacobians)
        jacobian_.Evaluate(geometry, q);
      else
        predicted = MarkerPositions(model_, geometry, q);
    }
    const int m = observation.marker;
    const Eigen::Vector3d position =
        with_jacobians ? Eigen::Vector3d(jacobian_.Position(m)) : Eigen::Vector3d(predicted.col(m));
    residuals_.col(static_cast<Eigen::Index>(i)) =
        (MarkerPosition(recording_, posture, m) - position) / marker_sd_;
    if (with_jacobians) jacobians_[i] = jacobian_.Block(m);
  }
}

void MarkerResiduals::Residual(int block, Eigen::Map<Eigen::VectorXd> residual) const {
  const int observation_count = static_cast<int>(observations_.size());
  if (block < observation_count) {
    residual = residuals_.col(block);
  } else {
    const int unknown = prior_unknowns_[block - observation_count];
    residual[0] = x_[unknown];  // scaled by the prior's standard deviation already
  }
}

void MarkerResiduals::Jacobian(int block, int k, Eigen::Map<RowMajorMatrix> jacobian) const {
  const int observation_count = static_cast<int>(observations_.size());
  if (block < observation_count) {
    const BlockColumns& columns = marker_columns_[observations_[block].marker][k];
    for (Eigen::Index c = 0; c < jacobian.cols(); ++c) {
      jacobian.col(c) = columns.scale[c] * jacobians_[block].col(columns.source[c]);
    }
    return;
  }
  const int unknown = prior_unknowns_[block - observation_count];
  const int parameter_block = residual_blocks[block].parameter_blocks[0];
  const auto first = std::lower_bound(block_of_.begin(), block_of_.end(), parameter_block);
  jacobian.setZero();
  jacobian(0, unknown - (first - block_of_.begin())) = 1.0;
}

}  // namespace elastocal
