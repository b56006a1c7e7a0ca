#include "elastocal/contact/contact_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "elastocal/calibration/options.hpp"

namespace elastocal {
namespace {

constexpr double kPlaneScale = 0.01;    // m and rad: of plates, tables and sessions
constexpr double kUnknownHeight = 1.0;  // m: nobody knows how high a table is
constexpr int kNoSource = -1;

constexpr int Index(ContactSource source) { return static_cast<int>(source); }

}  // namespace

std::vector<StandingFoot> FeetOf(const ContactModel& model, const GeneralizedJacobian& jacobian) {
  std::vector<StandingFoot> feet;
  for (std::size_t i = 0; i < model.setup.feet.size(); ++i) {
    const ContactFoot& foot = model.setup.feet[i];
    feet.push_back({jacobian.LegPose(static_cast<int>(i)), foot.T_floor_foot, foot.share});
  }
  return feet;
}

std::vector<JointLoads> ContactLoads(const ContactModel& model, const Touches& touches,
                                     const Eigen::VectorXd& errors) {
  const Geometry geometry = ApplyErrors(model.robot, errors);
  GeneralizedJacobian jacobian(model.robot);
  std::vector<int> links;
  for (const ContactFoot& foot : model.setup.feet) links.push_back(foot.link);
  std::vector<JointLoads> loads;
  for (int i = 0; i < touches.count(); ++i) {
    const Eigen::VectorXd q = touches.q.row(i);
    JointLoads load;
    for (int step = 0; step < 2; ++step) {  // of the rigid, then of the deflected robot
      jacobian.Evaluate(geometry, q, load);
      load = SharedSupportLoads(model.robot, geometry, q, links, FeetOf(model, jacobian), load);
    }
    loads.push_back(std::move(load));
  }
  return loads;
}

ContactValues NominalContacts(const ContactModel& model, const Touches& touches) {
  const std::size_t plates = model.setup.plates.size();
  ContactValues values;
  values.robot = Eigen::VectorXd::Zero(model.robot.parameter_count());
  values.plate_tilts.assign(plates, Eigen::Vector2d::Zero());
  values.tables.resize(plates);
  values.sessions.assign(touches.sessions.size(), Eigen::Vector3d::Zero());
  const Geometry geometry = ApplyErrors(model.robot, values.robot);
  GeneralizedJacobian jacobian(model.robot);
  std::vector<int> count(plates, 0);
  for (int i = 0; i < touches.count(); ++i) {
    const int plate = touches.touches[i].plate;
    jacobian.Evaluate(geometry, touches.q.row(i));
    const Transform T_floor_root = PlaceRootOnFeet(FeetOf(model, jacobian)).T_floor_root;
    const int leg = static_cast<int>(model.setup.feet.size()) + plate;
    values.tables[plate].pivot +=
        T_floor_root * (jacobian.LegPose(leg) * model.setup.plates[plate].face.p_link_face);
    ++count[plate];
  }
  for (std::size_t p = 0; p < plates; ++p) {
    if (count[p] > 0) values.tables[p].pivot /= count[p];
  }
  return values;
}

ContactResiduals::ContactResiduals(const ContactModel& model, const Touches& touches,
                                   const std::vector<JointLoads>& loads,
                                   const ContactSpread& spread, const std::vector<double>& weights,
                                   const ContactFreedom& freedom, const ContactValues& at)
    : model_(model),
      touches_(touches),
      loads_(loads),
      spread_(spread),
      weights_(weights),
      free_(freedom),
      at_(at),
      jacobian_(model.robot),
      first_entry_{0},
      left_(touches.touches.size(), Eigen::Vector3d::Zero()) {
  if (free_.robot) AddRobotBlocks();
  const int plates = static_cast<int>(model.setup.plates.size());
  plate_block_ = static_cast<int>(parameter_blocks.size());
  for (int p = 0; free_.plates && p < plates; ++p) AddBlock(2, kPlaneScale);
  table_block_ = static_cast<int>(parameter_blocks.size());
  for (int p = 0; free_.tables && p < plates; ++p) AddBlock(3, kPlaneScale);
  session_block_ = static_cast<int>(parameter_blocks.size());
  for (std::size_t s = 0; free_.sessions && s < touches.sessions.size(); ++s) {
    AddBlock(3, kPlaneScale);
  }
  for (int p = 0; p < plates; ++p) LayOutPlate(p);
  AddTouches();
  AddPriors();
}

void ContactResiduals::AddBlock(int size, double scale) {
  parameter_blocks.push_back(size);
  first_entry_.push_back(first_entry_.back() + size);
  scale_.conservativeResize(first_entry_.back());
  scale_.tail(size).setConstant(scale);
}

void ContactResiduals::AddRobotBlocks() {
  robot_entry_.assign(static_cast<std::size_t>(model_.unknown_count), -1);
  int joint = -1;  // of the block in hand
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

void ContactResiduals::LayOutPlate(int plate) {
  PlateLayout layout;
  std::vector<int> legs(model_.setup.feet.size());
  for (std::size_t i = 0; i < legs.size(); ++i) legs[i] = static_cast<int>(i);
  legs.push_back(static_cast<int>(legs.size()) + plate);
  std::map<int, int> first;  // column of each block
  const auto entry_of = [&](int parameter) {
    return model_.unknown[parameter] < 0 ? -1 : RobotEntry(model_.unknown[parameter]);
  };
  for (int leg : legs) {
    for (int parameter : jacobian_.LegColumns(leg)) {
      if (entry_of(parameter) >= 0) first[block_of_entry_[entry_of(parameter)]] = 0;
    }
  }
  for (auto& [block, column] : first) {
    layout.blocks.push_back(block);
    column = layout.width;
    layout.width += parameter_blocks[block];
  }
  for (int leg : legs) {
    std::vector<Column> columns;
    const std::vector<int>& parameters = jacobian_.LegColumns(leg);
    for (std::size_t c = 0; c < parameters.size(); ++c) {
      const int entry = entry_of(parameters[c]);
      if (entry < 0) continue;
      const int block = block_of_entry_[entry];
      columns.push_back(
          {static_cast<int>(c), first[block] + entry - first_entry_[block], scale_[entry]});
    }
    layout.of_legs.push_back(std::move(columns));
  }
  layout_.push_back(std::move(layout));
}

void ContactResiduals::AddTouches() {
  for (int i = 0; i < touches_.count(); ++i) {
    const Touch& touch = touches_.touches[i];
    ResidualBlock block{3, layout_[touch.plate].blocks, weights_[i] > 0.0};
    int width = layout_[touch.plate].width;
    const auto depends = [&](bool free, int on, int size) {
      if (!free) return;
      block.parameter_blocks.push_back(on);
      width += size;
    };
    depends(free_.plates, PlateBlock(touch.plate), 2);
    depends(free_.tables, TableBlock(touch.plate), 3);
    depends(free_.sessions, SessionBlock(touch.session), 3);
    residual_blocks.push_back(std::move(block));
    sources_.push_back(
        {Index(ContactSource::kHeight), Index(ContactSource::kTilt), Index(ContactSource::kTilt)});
    residuals_.emplace_back(Eigen::VectorXd::Zero(3));
    jacobians_.emplace_back(RowMajorMatrix::Zero(3, width));
  }
}

double ContactResiduals::SdOf(int source) const {
  return source == kNoSource ? kUnknownHeight : spread_.sd[source];
}

void ContactResiduals::AddPrior(int block, const std::vector<int>& sources,
                                const std::vector<double>& units) {
  const int size = parameter_blocks[block];
  residual_blocks.push_back({size, {block}});
  sources_.push_back(sources);
  residuals_.emplace_back(Eigen::VectorXd::Zero(size));
  jacobians_.emplace_back(RowMajorMatrix::Zero(size, size));
  std::vector<double> weights;
  for (int row = 0; row < size; ++row) {
    weights.push_back(scale_[first_entry_[block] + row] / (SdOf(sources[row]) * units[row]));
    jacobians_.back()(row, row) = weights.back();
  }
  weights_of_priors_.push_back(std::move(weights));
}

void ContactResiduals::AddPriors() {
  if (free_.robot) {
    const std::vector<SourceOfParameter> of = SourcesOfParameters(model_);
    std::vector<std::vector<int>> sources(static_cast<std::size_t>(plate_block_));
    std::vector<std::vector<double>> units(sources.size());
    std::vector<char> done(robot_entry_.size(), 0);
    for (int i = 0; i < model_.robot.parameter_count(); ++i) {
      const int unknown = model_.unknown[i];
      if (unknown < 0 || done[unknown] != 0) continue;
      done[unknown] = 1;
      const int block = block_of_entry_[robot_entry_[unknown]];
      sources[block].push_back(Index(of[i].source));
      units[block].push_back(of[i].unit);
    }
    for (int b = 0; b < plate_block_; ++b) AddPrior(b, sources[b], units[b]);
  }
  const auto plane = [&](int block, int height, ContactSource tilt) {
    AddPrior(block, {height, Index(tilt), Index(tilt)}, {1.0, 1.0, 1.0});
  };
  for (int b = plate_block_; b < table_block_; ++b) {
    AddPrior(b, std::vector<int>(2, Index(ContactSource::kPlateTilt)), {1.0, 1.0});
  }
  for (int b = table_block_; b < session_block_; ++b)
    plane(b, kNoSource, ContactSource::kTableTilt);
  for (int b = session_block_; b < static_cast<int>(parameter_blocks.size()); ++b) {
    plane(b, Index(ContactSource::kSessionHeight), ContactSource::kSessionTilt);
  }
}

Eigen::VectorXd ContactResiduals::Start() const {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(scale_.size());
  for (int i = 0; free_.robot && i < model_.robot.parameter_count(); ++i) {
    if (model_.unknown[i] >= 0) x[robot_entry_[model_.unknown[i]]] = at_.robot[i];
  }
  for (std::size_t p = 0; p < at_.plate_tilts.size(); ++p) {
    const int plate = static_cast<int>(p);
    if (free_.plates) x.segment<2>(FirstEntry(PlateBlock(plate))) = at_.plate_tilts[p];
    if (free_.tables) x.segment<3>(FirstEntry(TableBlock(plate))) = at_.tables[p].height_tilts;
  }
  for (std::size_t s = 0; free_.sessions && s < at_.sessions.size(); ++s) {
    x.segment<3>(FirstEntry(SessionBlock(static_cast<int>(s)))) = at_.sessions[s];
  }
  return x.cwiseQuotient(scale_);
}

ContactValues ContactResiduals::ToValues(const Eigen::VectorXd& x) const {
  const Eigen::VectorXd si = x.cwiseProduct(scale_);
  ContactValues values = at_;
  for (int i = 0; free_.robot && i < model_.robot.parameter_count(); ++i) {
    if (model_.unknown[i] >= 0) values.robot[i] = si[robot_entry_[model_.unknown[i]]];
  }
  for (std::size_t p = 0; p < values.plate_tilts.size(); ++p) {
    const int plate = static_cast<int>(p);
    if (free_.plates) values.plate_tilts[p] = si.segment<2>(FirstEntry(PlateBlock(plate)));
    if (free_.tables) values.tables[p].height_tilts = si.segment<3>(FirstEntry(TableBlock(plate)));
  }
  for (std::size_t s = 0; free_.sessions && s < values.sessions.size(); ++s) {
    values.sessions[s] = si.segment<3>(FirstEntry(SessionBlock(static_cast<int>(s))));
  }
  return values;
}

void ContactResiduals::Evaluate(const Eigen::VectorXd& x, bool with_jacobians) {
  const ContactValues values = ToValues(x);
  const Geometry geometry = ApplyErrors(model_.robot, values.robot);
  for (int i = 0; i < touches_.count(); ++i) {
    EvaluateTouchBlock(i, values, geometry, with_jacobians);
  }
  for (std::size_t p = 0; p < weights_of_priors_.size(); ++p) {
    const std::size_t block = touches_.touches.size() + p;
    const int first = first_entry_[residual_blocks[block].parameter_blocks.front()];
    for (std::size_t row = 0; row < weights_of_priors_[p].size(); ++row) {
      const auto r = static_cast<Eigen::Index>(row);
      residuals_[block][r] = weights_of_priors_[p][row] * x[first + r];
    }
  }
}

void ContactResiduals::EvaluateTouchBlock(int i, const ContactValues& values,
                                          const Geometry& geometry, bool with_jacobians) {
  const Touch& touch = touches_.touches[i];
  jacobian_.Evaluate(geometry, touches_.q.row(i), loads_.empty() ? JointLoads() : loads_[i]);
  const RootOnFeet root = PlaceRootOnFeet(FeetOf(model_, jacobian_));
  const int feet = static_cast<int>(model_.setup.feet.size());
  TablePlane table = values.tables[touch.plate];
  table.height_tilts += values.sessions[touch.session];
  const TouchResidual at =
      EvaluateTouch(model_.setup.plates[touch.plate].face, values.plate_tilts[touch.plate], table,
                    root.T_floor_root, jacobian_.LegPose(feet + touch.plate));
  left_[i] = at.residual;
  Eigen::Vector3d weight;
  for (int row = 0; row < 3; ++row) {
    weight[row] = std::sqrt(std::max(weights_[i], 1e-300)) / SdOf(sources_[i][row]);
  }
  if (weights_[i] <= 0.0) {  // as if it counted whole
    for (int row = 0; row < 3; ++row) weight[row] = 1.0 / SdOf(sources_[i][row]);
  }
  residuals_[i] = weight.cwiseProduct(at.residual);
  if (!with_jacobians) return;
  RowMajorMatrix& J = jacobians_[i];
  J.setZero();
  const PlateLayout& layout = layout_[touch.plate];
  for (int leg = 0; leg <= feet; ++leg) {
    const Matrix3x6d by_screw =
        leg < feet ? Matrix3x6d(at.by_root * root.by_foot[leg]) : at.by_link;
    const auto& screws = jacobian_.LegScrews(leg < feet ? leg : feet + touch.plate);
    for (const Column& column : layout.of_legs[leg]) {
      J.col(column.target) += column.scale * (by_screw * screws.col(column.source));
    }
  }
  Eigen::Index column = layout.width;
  if (free_.plates) {
    J.middleCols<2>(column) = kPlaneScale * at.by_plate;
    column += 2;
  }
  for (bool free : {free_.tables, free_.sessions}) {
    if (!free) continue;
    J.middleCols<3>(column) = kPlaneScale * at.by_table;
    column += 3;
  }
  J = weight.asDiagonal() * J;
}

}  // namespace elastocal
