// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/posture_regressor.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <stdexcept>

#include "elastocal/robot/leg_load.hpp"
#include "elastocal/robot/mdh_frames.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

using Eigen::Vector3d;

constexpr int kWaistColumn = -1, kMarkerColumn = -2;  // in place of a joint

bool IsJointCompliance(ParameterKind kind) {
  return kind == ParameterKind::kTorsion || kind == ParameterKind::kBending;
}

bool IsLegCompliance(ParameterKind kind) {
  return kind == ParameterKind::kLegForce || kind == ParameterKind::kLegMoment;
}

/// Whether the chain moves a joint of the leg.
bool Moves(const MovingChain& chain, const ErrorModel& model, const SupportLeg& leg) {
  return std::any_of(leg.joints.begin(), leg.joints.end(), [&](int joint) {
    return IsMovedBy(model.tree.joints[joint], chain.coordinates());
  });
}

/// The parameter that moves markers in the same way as the joint.
int MotionParameter(const ErrorModel& model, int joint) {
  const ParameterKind kind = model.tree.joints[joint].type == JointType::kRevolute
                                 ? ParameterKind::kTheta
                                 : ParameterKind::kR;
  for (int i = 0; i < model.parameter_count(); ++i) {
    if (model.parameters[i].joint == joint && model.parameters[i].kind == kind) return i;
  }
  throw std::logic_error("a joint that moves a marker has no parameter of its motion");
}

/// The columns, and those of T0, which are the model's first parameters.
std::vector<int> WithRoot(const std::vector<int>& base) {
  std::vector<int> all(kWaistParameterCount);
  std::iota(all.begin(), all.end(), 0);
  std::copy_if(base.begin(), base.end(), std::back_inserter(all),
               [](int i) { return i >= kWaistParameterCount; });
  return all;
}

}  // namespace

PostureRegressor::PostureRegressor(const ErrorModel& model, const std::vector<int>& base,
                                   const MovingChain& chain, RootPose root)
    : model_(model),
      base_(root == RootPose::kFree ? WithRoot(base) : base),
      geometry_(ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()))),
      jacobian_(model),
      free_(root == RootPose::kFree) {
  for (int i : base) {
    const auto at = std::lower_bound(base_.begin(), base_.end(), i) - base_.begin();
    asked_.push_back(static_cast<int>(at));
  }
  for (std::size_t column = 0; column < base_.size(); ++column) {
    const Parameter& parameter = model_.parameters[base_[column]];
    if (IsJointCompliance(parameter.kind)) {
      elastic_ = true;
    } else if (IsLegCompliance(parameter.kind) &&
               !Moves(chain, model_, model_.legs[parameter.leg])) {
      const int entry = parameter.axis + (parameter.kind == ParameterKind::kLegMoment ? 3 : 0);
      LegColumn& leg = legs_.emplace_back();
      leg.column = static_cast<int>(column);
      leg.leg = parameter.leg;
      leg.entry = entry;
    } else if (IsElastic(parameter.kind)) {
      throw std::invalid_argument("PostureRegressor: " + parameter.name +
                                  " depends on more than this posture");
    }
  }
  if (elastic_) {
    unit_loads_.setOnes(3, static_cast<Eigen::Index>(model_.tree.joints.size()));
    loads_ = unit_loads_;
  }
  psi_.setZero(rows(), static_cast<Eigen::Index>(base_.size()));
  LayOut(chain);
}

void PostureRegressor::LayOut(const MovingChain& chain) {
  for (int m = 0; m < model_.marker_count(); ++m) {
    std::vector<PathJoint>& path = paths_.emplace_back();
    for (int k : JointsToBody(model_.tree, model_.tree.links[model_.markers[m].link].body)) {
      const Joint& joint = model_.tree.joints[k];
      const auto& moving = chain.coordinates();
      for (const Drive& drive : DrivesOf(joint)) {
        const auto found = std::find(moving.begin(), moving.end(), drive.coordinate);
        const int variable = found == moving.end() ? -1 : static_cast<int>(found - moving.begin());
        path.push_back({k, MotionParameter(model_, k), variable, drive.multiplier});
      }
    }
    std::vector<MarkerColumn>& columns = columns_.emplace_back();
    const std::vector<int>& source = jacobian_.Columns(m);
    for (std::size_t c = 0; c < source.size(); ++c) {
      const auto found = std::lower_bound(base_.begin(), base_.end(), source[c]);
      if (found == base_.end() || *found != source[c]) continue;
      const Parameter& parameter = model_.parameters[source[c]];
      const int joint = parameter.marker >= 0  ? kMarkerColumn
                        : parameter.joint >= 0 ? parameter.joint
                                               : kWaistColumn;
      columns.push_back(
          {static_cast<int>(found - base_.begin()), static_cast<int>(c), source[c], joint});
    }
  }
}

double PostureRegressor::Load(int parameter) const {
  const Parameter& p = model_.parameters[parameter];
  return IsJointCompliance(p.kind) ? loads_(p.axis, p.joint) : 1.0;
}

double PostureRegressor::LoadOn(const LegColumn& column, const Eigen::VectorXd& q) const {
  return LoadFromStatics(model_, PlaceLeg(model_, geometry_, q, column.leg),
                         kGravity)[column.entry];
}

void PostureRegressor::EvaluateLegs(const Eigen::VectorXd& q) {
  const Vector3d waist = jacobian_.WaistPose().translation();
  for (LegColumn& column : legs_) {
    const Vector3d direction =  // the foot's axes
        jacobian_.LegPose(column.leg).linear().col(column.entry % 3);
    column.axis = column.entry < 3 ? Vector3d::Zero().eval() : direction;
    column.translation = column.entry < 3 ? direction : waist.cross(direction).eval();
    column.load = LoadOn(column, q);
    for (int m = 0; m < model_.marker_count(); ++m) {
      psi_.block<3, 1>(3 * m, column.column) = column.load * column.Of(jacobian_.Position(m));
    }
  }
}

Eigen::MatrixXd PostureRegressor::Evaluate(MovingChain& chain, const Eigen::VectorXd& x,
                                           const Eigen::VectorXd& shown) {
  x_ = x;
  const Eigen::VectorXd q = chain.FullPosture(x);
  jacobian_.Evaluate(geometry_, q, unit_loads_);
  if (elastic_) loads_ = GravityLoads(model_, geometry_, q, kGravity, 0);
  for (int m = 0; m < model_.marker_count(); ++m) {
    const auto block = jacobian_.Block(m);
    for (const MarkerColumn& c : columns_[m]) {
      psi_.block<3, 1>(3 * m, c.column) = Load(c.parameter) * block.col(c.source);
    }
  }
  EvaluateLegs(q);
  shown_ = shown;
  if (shown.size() > 0) psi_ = shown.asDiagonal() * psi_;
  if (!free_) return psi_;
  projection_.emplace(psi_.leftCols<kWaistParameterCount>());
  return projection_->Apply(psi_(Eigen::all, asked_));
}

Eigen::MatrixXd PostureRegressor::Unprojected(const Eigen::MatrixXd& weight) const {
  const RootProjection::Weights weights = projection_->Derivative(psi_(Eigen::all, asked_), weight);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(psi_.rows(), psi_.cols());
  result(Eigen::all, asked_) = weights.psi;
  result.leftCols<kWaistParameterCount>() += weights.root;
  return result;
}

Eigen::VectorXd PostureRegressor::Gradient(MovingChain& chain, const Eigen::MatrixXd& weight) {
  Eigen::MatrixXd own = free_ ? Unprojected(weight) : weight;
  if (shown_.size() > 0) own = shown_.asDiagonal() * own;
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(chain.size());
  for (int m = 0; m < model_.marker_count(); ++m) AddMarkerGradient(m, own, gradient);
  if (elastic_ || !legs_.empty()) AddLoadGradient(chain, own, gradient);
  return gradient;
}

void PostureRegressor::AddMarkerGradient(int marker, const Eigen::MatrixXd& weight,
                                         Eigen::VectorXd& gradient) const {
  // A column v = a x p + m turns as a whole with the joints before its own, dv = z x v; the joints
  // from its own one on move the marker alone, dv = a x dp. Weighted by w these are z . (v x w) and
  // dp . (w x a), so that running sums over the columns along the chain serve for all joints.
  const Vector3d p = jacobian_.Position(marker);
  Vector3d turned = Vector3d::Zero();  // sum of v x w over the columns beyond the joint
  Vector3d moved = Vector3d::Zero();   // sum of w x a over the columns before it
  const auto v_cross_w = [&](const MarkerColumn& c) -> Vector3d {
    const Vector3d v = psi_.block<3, 1>(3 * marker, c.column);
    return v.cross(Vector3d(weight.block<3, 1>(3 * marker, c.column)));
  };
  const auto w_cross_a = [&](const MarkerColumn& c) -> Vector3d {
    const Vector3d a = Load(c.parameter) * jacobian_.Screw(c.parameter).head<3>();
    return Vector3d(weight.block<3, 1>(3 * marker, c.column)).cross(a);
  };
  const std::vector<MarkerColumn>& columns = columns_[marker];
  for (const MarkerColumn& c : columns) {
    if (c.joint == kWaistColumn) {
      moved += w_cross_a(c);
    } else {
      turned += v_cross_w(c);
    }
  }
  for (const LegColumn& leg : legs_) {
    const Vector3d w = weight.block<3, 1>(3 * marker, leg.column);
    moved += w.cross(leg.load * leg.axis);
  }
  auto next = std::find_if(columns.begin(), columns.end(),
                           [](const MarkerColumn& c) { return c.joint != kWaistColumn; });
  for (const PathJoint& joint : paths_[marker]) {
    for (; next != columns.end() && next->joint == joint.joint; ++next) {
      turned -= v_cross_w(*next);
      moved += w_cross_a(*next);
    }
    if (joint.variable < 0) continue;
    const Eigen::Matrix<double, 6, 1> motion = jacobian_.Screw(joint.motion);
    const Vector3d z = motion.head<3>();
    gradient[joint.variable] +=
        joint.multiplier * (z.dot(turned) + (z.cross(p) + motion.tail<3>()).dot(moved));
  }
}

void PostureRegressor::AddLoadGradient(MovingChain& chain, const Eigen::MatrixXd& weight,
                                       Eigen::VectorXd& gradient) const {
  Eigen::MatrixXd by_load =
      Eigen::MatrixXd::Zero(3, static_cast<Eigen::Index>(model_.tree.joints.size()));
  for (int m = 0; m < model_.marker_count(); ++m) {
    const auto block = jacobian_.Block(m);
    for (const MarkerColumn& c : columns_[m]) {
      const Parameter& p = model_.parameters[c.parameter];
      if (!IsJointCompliance(p.kind)) continue;
      by_load(p.axis, p.joint) += block.col(c.source).dot(weight.block<3, 1>(3 * m, c.column));
    }
  }
  // In the root link's axes, like everything in MovingChain.
  const Transform T_root_ref = jacobian_.WaistPose().inverse();
  std::vector<LoadComponent> components;
  const auto visit = [&](int k, const Geometry::JointConstants& constants, const MdhFrame&,
                         const MdhFrame& twisted, const MdhFrame&) {
    if (k == kWaist || by_load.col(k).isZero(0.0)) return;
    const Vector3d centre = twisted.p + constants.centre * twisted.R.col(2);
    const Vector3d direction = twisted.R * by_load.col(k);
    components.push_back({k, T_root_ref * centre, T_root_ref.linear() * direction});
  };
  std::vector<MdhFrame> frames(static_cast<std::size_t>(model_.tree.body_count()));
  if (elastic_) EvaluateMdhFrames(model_, geometry_, chain.FullPosture(x_), {}, frames, visit);
  for (const LegColumn& leg : legs_) {
    if (leg.entry < 3) continue;  // the weight does not change
    double sum = 0.0;
    for (int m = 0; m < model_.marker_count(); ++m) {
      sum += leg.Of(jacobian_.Position(m)).dot(weight.block<3, 1>(3 * m, leg.column));
    }
    components.push_back({-1, Vector3d::Zero(), T_root_ref.linear() * (sum * leg.axis)});
  }
  chain.Move(x_);
  gradient += chain.LoadGradient(components, T_root_ref.linear() * kGravity);
}

}  // namespace elastocal
