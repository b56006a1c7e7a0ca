// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/observation_residuals.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/calibration/options.hpp"

namespace elastocal {
namespace {

constexpr double kQuantityScale = 0.01;  // m, rad and other units of quantities

/// Screw on the floor from the rotation [rad] and displacement [m] of a body whose origin is at p.
Matrix6d ScrewByMotion(const Eigen::Vector3d& p) {
  Matrix6d by_motion = Matrix6d::Identity();
  by_motion.bottomLeftCorner<3, 3>() = Skew(p);
  return by_motion;
}

/// Source of the effect of a quantity that differs between sessions.
int SourceOfEffect(const Quantity& quantity, bool angle) {
  if (quantity.set_up_anew) return angle ? kTrackerTurn : kTrackerPlace;
  return angle ? kSessionTilt : kSessionHeight;
}

/// Matrix that transforms screws from one frame to another.
Matrix6d ScrewByScrew(const Transform& T) {
  Matrix6d by_screw = Matrix6d::Zero();
  by_screw.topLeftCorner<3, 3>() = T.linear();
  by_screw.bottomLeftCorner<3, 3>() = Skew(T.translation()) * T.linear();
  by_screw.bottomRightCorner<3, 3>() = T.linear();
  return by_screw;
}

}  // namespace

ObservationResiduals::ObservationResiduals(const ObservedRobot& model,
                                           const Observations& observations,
                                           const std::vector<JointLoads>& loads,
                                           const Spread& spread, const std::vector<double>& weights,
                                           const ObservationFreedom& freedom,
                                           const ObservedValues& at)
    : model_(model),
      observations_(observations),
      loads_(loads),
      spread_(spread),
      weights_(weights),
      free_(freedom),
      at_(at),
      posture_(model),
      first_entry_{0},
      by_posture_(observations.postures.size()) {
  if (free_.robot) AddRobotBlocks();
  robot_blocks_ = static_cast<int>(parameter_blocks.size());
  for (const Quantity& quantity : model.setup.quantities) {
    const bool free = quantity.of_surroundings ? free_.surroundings : free_.mountings;
    quantity_block_.push_back(free ? AddBlock(quantity.size()) : -1);
  }
  for (const SessionEffect& effect : observations.effects) {
    const int size = model.setup.quantities[effect.quantity].size();
    effect_block_.push_back(free_.effects ? AddBlock(size) : -1);
  }
  for (const auto& instrument : model.setup.instruments) layout_.push_back(LayOut(*instrument));
  for (int i = 0; i < observations.count(); ++i) {
    by_posture_[observations.all[i].posture].push_back(i);
  }
  AddObservations();
  AddPriors();
}

int ObservationResiduals::AddBlock(int size) {
  parameter_blocks.push_back(size);
  first_entry_.push_back(first_entry_.back() + size);
  scale_.conservativeResize(first_entry_.back());
  scale_.tail(size).setConstant(kQuantityScale);
  return static_cast<int>(parameter_blocks.size()) - 1;
}

void ObservationResiduals::AddRobotBlocks() {
  robot_entry_.assign(static_cast<std::size_t>(model_.unknown_count), -1);
  int joint = -1;  // joint of the current block
  for (int i = 0; i < model_.robot.parameter_count(); ++i) {
    const int unknown = model_.unknown[i];
    if (unknown < 0 || robot_entry_[unknown] >= 0) continue;
    const Parameter& parameter = model_.robot.parameters[i];
    if (parameter.joint != joint || parameter_blocks.empty()) {
      parameter_blocks.push_back(0);
      first_entry_.push_back(first_entry_.back());
      joint = parameter.joint;
    }
    robot_entry_[unknown] = first_entry_.back()++;
    ++parameter_blocks.back();
    block_of_entry_.push_back(static_cast<int>(parameter_blocks.size()) - 1);
    scale_.conservativeResize(first_entry_.back());
    scale_[robot_entry_[unknown]] = ParameterScale(parameter);
    if (IsCompliance(parameter.kind)) nonnegative.push_back(robot_entry_[unknown]);
  }
}

std::vector<ObservationResiduals::Column> ObservationResiduals::ColumnsOf(
    int leg, const std::vector<int>& first_column) const {
  std::vector<Column> columns;
  const std::vector<int>& parameters = posture_.jacobian().LegColumns(leg);
  for (std::size_t c = 0; c < parameters.size(); ++c) {
    const int unknown = model_.unknown[parameters[c]];
    const int entry = unknown < 0 ? -1 : RobotEntry(unknown);
    if (entry < 0) continue;
    const int block = block_of_entry_[entry];
    columns.push_back(
        {static_cast<int>(c), first_column[block] + entry - first_entry_[block], scale_[entry]});
  }
  return columns;
}

ObservationResiduals::InstrumentLayout ObservationResiduals::LayOut(
    const Instrument& instrument) const {
  InstrumentLayout layout;
  const int feet = static_cast<int>(model_.setup.feet.size());
  std::vector<int> moving;
  for (int foot = 0; foot < feet; ++foot) moving.push_back(foot);
  for (int link : instrument.links) {
    layout.legs.push_back(model_.leg_of_link[link]);
    if (layout.legs.back() >= 0) moving.push_back(layout.legs.back());
  }
  std::vector<char> depends(static_cast<std::size_t>(robot_blocks_), 0);
  for (int leg : moving) {
    for (int parameter : posture_.jacobian().LegColumns(leg)) {
      const int unknown = model_.unknown[parameter];
      if (unknown < 0 || RobotEntry(unknown) < 0) continue;
      depends[block_of_entry_[RobotEntry(unknown)]] = 1;
    }
  }
  std::vector<int> first_column(depends.size(), 0);
  for (int block = 0; block < robot_blocks_; ++block) {
    if (depends[block] == 0) continue;
    layout.blocks.push_back(block);
    first_column[block] = layout.width;
    layout.width += parameter_blocks[block];
  }
  for (int foot = 0; foot < feet; ++foot) {
    layout.of_feet.push_back(ColumnsOf(foot, first_column));
  }
  for (int leg : layout.legs) {
    layout.of_links.push_back(leg < 0 ? std::vector<Column>() : ColumnsOf(leg, first_column));
  }
  return layout;
}

void ObservationResiduals::AddObservations() {
  for (int i = 0; i < observations_.count(); ++i) {
    const Observation& observation = observations_.all[i];
    const Instrument& instrument = model_.instrument(observation.instrument);
    const InstrumentLayout& layout = layout_[observation.instrument];
    ResidualBlock block{instrument.size(), layout.blocks, weights_[i] > 0.0};
    int width = layout.width;
    const auto depend = [&](int on) {
      if (on < 0) return;
      block.parameter_blocks.push_back(on);
      width += parameter_blocks[on];
    };
    for (int quantity : instrument.quantities) depend(quantity_block_[quantity]);
    for (int effect : observation.effects) depend(effect_block_[effect]);
    if (model_.root_tilt >= 0) depend(quantity_block_[model_.root_tilt]);
    residual_blocks.push_back(std::move(block));
    sources_.push_back(instrument.noise);
    left_.emplace_back(Eigen::VectorXd::Zero(instrument.size()));
    residuals_.emplace_back(Eigen::VectorXd::Zero(instrument.size()));
    jacobians_.emplace_back(RowMajorMatrix::Zero(instrument.size(), width));
  }
}

/// `sources` holds the source of each entry of the block; -1: it has no prior here.
void ObservationResiduals::AddPrior(int block, const std::vector<int>& sources,
                                    const std::vector<double>& units) {
  std::vector<PriorRow> rows;
  std::vector<int> of_rows;
  for (int column = 0; column < parameter_blocks[block]; ++column) {
    if (sources[column] < 0) continue;
    of_rows.push_back(sources[column]);
    rows.push_back({column, scale_[first_entry_[block] + column] /
                                (spread_[sources[column]] * units[column])});
  }
  if (rows.empty()) return;
  const auto size = static_cast<int>(rows.size());
  residual_blocks.push_back({size, {block}});
  sources_.push_back(std::move(of_rows));
  residuals_.emplace_back(Eigen::VectorXd::Zero(size));
  jacobians_.emplace_back(RowMajorMatrix::Zero(size, parameter_blocks[block]));
  for (int row = 0; row < size; ++row) {
    jacobians_.back()(row, rows[row].column) = rows[row].weight;
  }
  priors_.push_back(std::move(rows));
}

void ObservationResiduals::AddRobotPriors() {
  const std::vector<int> parameters = ParameterOfUnknown(model_);
  const EarlierPart earlier = PartOf(model_.earlier, model_.robot, parameters);
  const std::vector<SourceOfParameter> of = SourcesOfParameters(model_);
  std::vector<std::vector<int>> sources(static_cast<std::size_t>(robot_blocks_));
  std::vector<std::vector<double>> units(sources.size());
  for (int b = 0; b < robot_blocks_; ++b) {
    sources[b].assign(static_cast<std::size_t>(parameter_blocks[b]), -1);
    units[b].assign(sources[b].size(), 1.0);
  }
  for (int unknown = 0; unknown < model_.unknown_count; ++unknown) {
    if (std::binary_search(earlier.positions.begin(), earlier.positions.end(), unknown)) continue;
    const int entry = robot_entry_[unknown];
    const int block = block_of_entry_[entry];
    sources[block][entry - first_entry_[block]] = of[parameters[unknown]].source;
    units[block][entry - first_entry_[block]] = of[parameters[unknown]].unit;
  }
  for (int b = 0; b < robot_blocks_; ++b) AddPrior(b, sources[b], units[b]);
}

/// Adds the last block, which depends on all unknowns of the robot.
void ObservationResiduals::AddEarlier() {
  const EarlierPart earlier = PartOf(model_.earlier, model_.robot, ParameterOfUnknown(model_));
  const auto count = static_cast<int>(earlier.positions.size());
  if (count == 0) return;
  const Eigen::MatrixXd whitening = earlier.Whitening();
  ResidualBlock block{count, {}};
  for (int b = 0; b < robot_blocks_; ++b) block.parameter_blocks.push_back(b);
  RowMajorMatrix jacobian = RowMajorMatrix::Zero(count, first_entry_[robot_blocks_]);
  for (int i = 0; i < count; ++i) {
    const int entry = robot_entry_[earlier.positions[i]];
    jacobian.col(entry) = scale_[entry] * whitening.col(i);
  }
  residual_blocks.push_back(std::move(block));
  sources_.emplace_back();
  residuals_.emplace_back(Eigen::VectorXd::Zero(count));
  jacobians_.push_back(std::move(jacobian));
  earlier_offset_ = whitening * earlier.mean;
}

void ObservationResiduals::AddPriors() {
  if (free_.robot) AddRobotPriors();
  for (std::size_t i = 0; i < quantity_block_.size(); ++i) {
    const std::vector<int>& sources = model_.setup.quantities[i].sources;
    if (quantity_block_[i] >= 0) {
      AddPrior(quantity_block_[i], sources, std::vector<double>(sources.size(), 1.0));
    }
  }
  for (std::size_t i = 0; i < effect_block_.size(); ++i) {
    if (effect_block_[i] < 0) continue;
    const Quantity& quantity = model_.setup.quantities[observations_.effects[i].quantity];
    std::vector<int> sources;
    for (int source : quantity.sources) {
      const bool angle = model_.setup.sources[source].unit == SourceUnit::kRadian;
      sources.push_back(SourceOfEffect(quantity, angle));
    }
    AddPrior(effect_block_[i], sources, std::vector<double>(sources.size(), 1.0));
  }
  if (free_.robot) AddEarlier();
}

Eigen::MatrixXd ObservationResiduals::RobotPriorInformation() const {
  const Eigen::Index robot = first_entry_[robot_blocks_];
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(robot, robot);
  const std::size_t first_prior = observations_.all.size();
  for (std::size_t b = first_prior; b < first_prior + priors_.size(); ++b) {
    const int block = residual_blocks[b].parameter_blocks.front();
    if (block >= robot_blocks_) break;
    const Eigen::Index first = first_entry_[block], size = jacobians_[b].cols();
    information.block(first, first, size, size) += jacobians_[b].transpose() * jacobians_[b];
  }
  if (earlier_offset_.size() > 0) {
    information += jacobians_.back().transpose() * jacobians_.back();
  }
  return information;
}

Eigen::VectorXd ObservationResiduals::Start() const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(scale_.size());
  for (int i = 0; free_.robot && i < model_.robot.parameter_count(); ++i) {
    if (model_.unknown[i] >= 0) x[robot_entry_[model_.unknown[i]]] = at_.robot[i];
  }
  const auto set = [&](int block, const Eigen::VectorXd& value) {
    if (block >= 0) x.segment(first_entry_[block], value.size()) = value;
  };
  for (std::size_t i = 0; i < quantity_block_.size(); ++i) {
    set(quantity_block_[i], at_.quantities[i].x);
  }
  for (std::size_t i = 0; i < effect_block_.size(); ++i) set(effect_block_[i], at_.effects[i]);
  return x.cwiseQuotient(scale_);
}

ObservedValues ObservationResiduals::ToValues(const Eigen::VectorXd& x) const {
  const Eigen::VectorXd si = x.cwiseProduct(scale_);
  ObservedValues values = at_;
  for (int i = 0; free_.robot && i < model_.robot.parameter_count(); ++i) {
    if (model_.unknown[i] >= 0) values.robot[i] = si[robot_entry_[model_.unknown[i]]];
  }
  const auto take = [&](int block, Eigen::VectorXd& value) {
    if (block >= 0) value = si.segment(first_entry_[block], value.size());
  };
  for (std::size_t i = 0; i < quantity_block_.size(); ++i) {
    take(quantity_block_[i], values.quantities[i].x);
  }
  for (std::size_t i = 0; i < effect_block_.size(); ++i) take(effect_block_[i], values.effects[i]);
  return values;
}

void ObservationResiduals::Evaluate(const Eigen::VectorXd& x, bool with_jacobians) {
  const ObservedValues values = ToValues(x);
  const Geometry geometry = ApplyErrors(model_.robot, values.robot);
  for (std::size_t i = 0; i < by_posture_.size(); ++i) {
    if (by_posture_[i].empty()) continue;
    posture_.Evaluate(geometry, values, observations_.q.row(static_cast<Eigen::Index>(i)),
                      loads_.empty() ? JointLoads() : loads_[i]);
    for (int index : by_posture_[i]) EvaluateObservation(index, values, with_jacobians);
  }
  for (std::size_t p = 0; p < priors_.size(); ++p) {
    const std::size_t block = observations_.all.size() + p;
    const int first = first_entry_[residual_blocks[block].parameter_blocks.front()];
    for (std::size_t row = 0; row < priors_[p].size(); ++row) {
      const PriorRow& of = priors_[p][row];
      residuals_[block][static_cast<Eigen::Index>(row)] = of.weight * x[first + of.column];
    }
  }
  if (earlier_offset_.size() > 0) {
    residuals_.back() = jacobians_.back() * x.head(first_entry_[robot_blocks_]) - earlier_offset_;
  }
}

void ObservationResiduals::EvaluateObservation(int index, const ObservedValues& values,
                                               bool with_jacobians) {
  const Observation& observation = observations_.all[index];
  const Instrument& instrument = model_.instrument(observation.instrument);
  const Sight sight = posture_.SightOf(observations_, observation, values);
  const ObservationResidual at = instrument.Evaluate(sight, observation.measured);
  left_[index] = at.left;
  // An observation with weight 0 is evaluated with weight 1.
  const double weight = weights_[index] > 0.0 ? std::sqrt(weights_[index]) : 1.0;
  const Eigen::MatrixXd weights = weight * instrument.Weights(spread_);
  residuals_[index] = weights * at.left;
  if (!with_jacobians) return;
  FillJacobian(index, at);
  jacobians_[index] = (weights * jacobians_[index]).eval();
}

void ObservationResiduals::FillJacobian(int index, const ObservationResidual& at) {
  const Observation& observation = observations_.all[index];
  const Instrument& instrument = model_.instrument(observation.instrument);
  const InstrumentLayout& layout = layout_[observation.instrument];
  RowMajorMatrix& J = jacobians_[index];
  J.setZero();
  const auto add = [&](const ByScrew& by_screw, int leg, const std::vector<Column>& columns) {
    const auto& screws = posture_.jacobian().LegScrews(leg);
    for (const Column& column : columns) {
      J.col(column.target) += column.scale * (by_screw * screws.col(column.source));
    }
  };
  ByScrew by_root = ByScrew::Zero(instrument.size(), 6);
  const Matrix6d floor_by_root = ScrewByScrew(posture_.T_floor_root());
  for (std::size_t link = 0; link < at.by_link.size(); ++link) {
    by_root += at.by_link[link];
    const int leg = layout.legs[link];
    if (leg >= 0) add(at.by_link[link] * floor_by_root, leg, layout.of_links[link]);
  }
  const ByScrew by_motion = by_root * ScrewByMotion(posture_.T_floor_root().translation());
  for (std::size_t foot = 0; foot < posture_.root_by_foot().size(); ++foot) {
    add(by_motion * posture_.root_by_foot()[foot], static_cast<int>(foot), layout.of_feet[foot]);
  }
  Eigen::Index column = layout.width;
  const auto put = [&](int block, const Eigen::MatrixXd& derivatives) {
    if (block < 0) return;
    J.middleCols(column, derivatives.cols()) = kQuantityScale * derivatives;
    column += derivatives.cols();
  };
  for (std::size_t i = 0; i < instrument.quantities.size(); ++i) {
    put(quantity_block_[instrument.quantities[i]], at.by_quantity[i]);
  }
  for (int effect : observation.effects) {
    const int quantity = observations_.effects[effect].quantity;
    const auto found =
        std::find(instrument.quantities.begin(), instrument.quantities.end(), quantity);
    put(effect_block_[effect], at.by_quantity[found - instrument.quantities.begin()]);
  }
  if (model_.root_tilt >= 0)
    put(quantity_block_[model_.root_tilt], by_motion * posture_.root_by_tilt());
}

}  // namespace elastocal
