// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/jacobian.hpp"

#include <algorithm>

#include "elastocal/math/interruption.hpp"
#include "elastocal/robot/linkage_errors.hpp"

namespace elastocal {
namespace {

using Eigen::Vector3d;
using Screws = Eigen::Array<double, Eigen::Dynamic, 6>;

void SetRotation(Screws& screws, int row, const Vector3d& axis, const Vector3d& point) {
  screws.row(row) << axis.transpose().array(), point.cross(axis).transpose().array();
}

void AddRotation(Screws& screws, int row, const Vector3d& axis, const Vector3d& point) {
  screws.row(row).head<3>() += axis.transpose().array();
  screws.row(row).tail<3>() += point.cross(axis).transpose().array();
}

void SetTranslation(Screws& screws, int row, const Vector3d& direction) {
  screws.row(row) << 0.0, 0.0, 0.0, direction.transpose().array();
}

}  // namespace

GeneralizedJacobian::GeneralizedJacobian(const ErrorModel& model, LoadsOfRootJoints root_joints)
    : model_(model),
      root_joints_(root_joints),
      first_parameter_(model.tree.joints.size(), -1),
      compliances_(model.tree.joints.size(), 0),
      corrections_(model.tree.joints.size(), 0),
      frames_(model.tree.body_count()),
      positions_(3, model.marker_count()),
      T_ref_foot_(model.legs.size(), Transform::Identity()) {
  const int screw_count = model.parameter_count() - 3 * model.marker_count();
  std::vector<int> parameter_count(model.tree.joints.size(), 0);
  for (int i = screw_count - 1; i >= kWaistParameterCount; --i) {
    const Parameter& parameter = model.parameters[i];
    if (parameter.leg >= 0 || parameter.linkage >= 0 || parameter.joint < 0) continue;
    first_parameter_[parameter.joint] = i;
    ++parameter_count[parameter.joint];
    if (IsCompliance(parameter.kind)) ++compliances_[parameter.joint];
    if (parameter.kind == ParameterKind::kCorrection) ++corrections_[parameter.joint];
  }
  CountCorrections(screw_count);
  first_load_row_ = screw_count;
  row_count_ = screw_count + load_corrections_ * model.tree.body_count();

  Eigen::Index offset = 0;
  for (int m = 0; m < model.marker_count(); ++m) {
    MarkerLayout layout{LayOut(model.tree.links[model.markers[m].link].body, parameter_count),
                        offset};
    for (int i = first_marker_correction_; i < screw_count; ++i) {
      const int correction = model.parameters[i].correction;
      if (model.elasticity.corrections[correction].marker != m) continue;
      layout.segments.push_back({i, 1});
      layout.columns.push_back(i);
    }
    for (int i = 0; i < 3; ++i) layout.columns.push_back(screw_count + 3 * m + i);
    offset += 3 * static_cast<Eigen::Index>(layout.columns.size());
    layout_.push_back(std::move(layout));
  }
  values_.setZero(offset);
  for (const SupportLeg& leg : model.legs) {
    legs_.push_back(LayOut(model.tree.links[leg.link].body, parameter_count));
    leg_screws_.emplace_back(6, static_cast<Eigen::Index>(legs_.back().columns.size()));
  }
  screws_.setZero(row_count_, 6);
}

void GeneralizedJacobian::CountCorrections(int screw_count) {
  first_marker_correction_ = screw_count;
  for (int i = kWaistParameterCount; i < screw_count; ++i) {
    const Parameter& parameter = model_.parameters[i];
    if (parameter.kind != ParameterKind::kCorrection) continue;
    switch (TargetOf(model_.elasticity.corrections[parameter.correction])) {
      case CorrectionTarget::kRoot:
        ++root_corrections_;
        break;
      case CorrectionTarget::kLoads:
        ++load_corrections_;
        break;
      case CorrectionTarget::kMarker:
        first_marker_correction_ = std::min(first_marker_correction_, i);
        break;
      default:
        break;
    }
  }
}

GeneralizedJacobian::Segment GeneralizedJacobian::LinkageSegment(int linkage,
                                                                 const std::vector<int>& path) {
  const int parameter = FirstLinkageParameter(model_, linkage);
  const Linkage& of = model_.tree.linkages[static_cast<std::size_t>(linkage)];
  std::vector<int> moved;
  for (std::size_t j = 0; j < of.joints.size(); ++j) {
    const bool beyond = std::find(path.begin(), path.end(), of.joints[j]) != path.end();
    if (beyond) moved.push_back(static_cast<int>(j));
  }
  if (moved.empty() || parameter < 0) return {0, 0, 0};
  for (const LinkageRows& rows : linkage_rows_) {
    if (rows.linkage == linkage && rows.moved == moved) return {rows.row, rows.count, parameter};
  }
  linkage_rows_.push_back({linkage, row_count_, of.error_count(), std::move(moved)});
  row_count_ += of.error_count();
  return {linkage_rows_.back().row, of.error_count(), parameter};
}

GeneralizedJacobian::BodyLayout GeneralizedJacobian::LayOut(
    int body, const std::vector<int>& parameter_count) {
  const int first_load = kWaistParameterCount + root_corrections_;
  BodyLayout layout{body, {{0, first_load}}, {}};
  if (load_corrections_ > 0) {
    layout.segments.push_back(
        {first_load_row_ + body * load_corrections_, load_corrections_, first_load});
  }
  const std::vector<int> path = JointsToBody(model_.tree, body);
  for (int joint : path) {
    Segment& last = layout.segments.back();
    if (last.begin + last.size == first_parameter_[joint]) {
      last.size += parameter_count[joint];
    } else {
      layout.segments.push_back({first_parameter_[joint], parameter_count[joint]});
    }
  }
  for (int i = 0; i < static_cast<int>(model_.tree.linkages.size()); ++i) {
    const Segment segment = LinkageSegment(i, path);
    if (segment.size > 0) layout.segments.push_back(segment);
  }
  for (const Segment& segment : layout.segments) {
    const int first = segment.parameter < 0 ? segment.begin : segment.parameter;
    for (int i = 0; i < segment.size; ++i) layout.columns.push_back(first + i);
  }
  return layout;
}

void GeneralizedJacobian::SetCompliances(int joint, int row,
                                         const Geometry::JointConstants& constants,
                                         const MdhFrame& twisted, const JointLoads& loads) {
  const bool loaded = loads.cols() > 0;
  const Vector3d load = loaded ? Vector3d(loads.col(joint)) : Vector3d::Zero();
  const bool revolute = model_.tree.joints[joint].type == JointType::kRevolute;
  Eigen::Matrix3d axes = twisted.R;
  if (revolute && loaded) axes *= LeftJacobian(constants.compliance.cwiseProduct(load));
  const Vector3d centre = twisted.p + constants.centre * twisted.R.col(2);
  for (const int end = row + compliances_[joint]; row < end; ++row) {
    const int axis = model_.parameters[row].axis;
    if (axis >= kRootAxis) {
      SetRootCompliance(row, axis - kRootAxis, constants, loads.about_root, joint);
    } else if (revolute) {
      SetRotation(screws_, row, load[axis] * axes.col(axis), centre);
    } else {
      SetTranslation(screws_, row, load[axis] * axes.col(axis));
    }
  }
}

void GeneralizedJacobian::SetRootCompliance(int row, int axis,
                                            const Geometry::JointConstants& constants,
                                            const Eigen::Matrix3Xd& about_root, int joint) {
  if (about_root.cols() == 0) {
    screws_.row(row).setZero();
    return;
  }
  const Vector3d moment = about_root.col(joint);
  const Eigen::Matrix3d axes =
      frames_[0].R * LeftJacobian(constants.root_compliance.cwiseProduct(moment));
  SetRotation(screws_, row, moment[axis] * axes.col(axis), frames_[0].p);
}

/// Adds to the screws of a root joint's rotations the deflection by its load, which turns with
/// them.
void GeneralizedJacobian::TurnLoads(int joint, const Geometry::JointConstants& constants,
                                    const MdhFrame& twisted, const JointLoads& loads) {
  const auto turn_about_root = [&](int row, const Vector3d& axis) {
    if (loads.about_root.cols() == 0) return;
    const Vector3d moment = loads.about_root.col(joint);
    const Vector3d& compliance = constants.root_compliance;
    const Vector3d turn = compliance.cwiseProduct(axis.cross(moment));
    AddRotation(screws_, row, frames_[0].R * (LeftJacobian(compliance.cwiseProduct(moment)) * turn),
                frames_[0].p);
  };
  int row = first_parameter_[joint];
  if (model_.placements[joint].general) {
    turn_about_root(row, constants.z_pre);
    row += 2;
  }
  if (model_.placements[joint].parallel) turn_about_root(row++, constants.y_beta);
  turn_about_root(row, constants.R_parent_twisted.col(0));
  row += 2;
  turn_about_root(row, constants.R_parent_twisted.col(2));
  if (model_.tree.joints[joint].type != JointType::kRevolute) return;
  const Vector3d load = loads.col(joint), by_theta(-load.y(), load.x(), 0.0);
  const Eigen::Matrix3d axes = twisted.R * LeftJacobian(constants.compliance.cwiseProduct(load));
  AddRotation(screws_, row, axes * constants.compliance.cwiseProduct(by_theta),
              twisted.p + constants.centre * twisted.R.col(2));
}

void GeneralizedJacobian::SetCorrections(int joint, int row, const MdhFrame& deflected,
                                         const JointLoads& loads) {
  const bool revolute = model_.tree.joints[joint].type == JointType::kRevolute;
  for (const int end = row + corrections_[joint]; row < end; ++row) {
    const int correction = model_.parameters[row].correction;
    const double shape = loads.shapes.size() > 0 ? loads.shapes[correction] : 0.0;
    if (revolute) {
      SetRotation(screws_, row, shape * deflected.R.col(2), deflected.p);
    } else {
      SetTranslation(screws_, row, shape * deflected.R.col(2));
    }
  }
}

void GeneralizedJacobian::SetRootCorrections(const Geometry& geometry, const JointLoads& loads) {
  const int end = kWaistParameterCount + root_corrections_;
  if (loads.shapes.size() == 0) {
    screws_.middleRows(kWaistParameterCount, root_corrections_).setZero();
    return;
  }
  const Vector3d turn = RootCorrection(model_, geometry, loads).tail<3>();
  const Eigen::Matrix3d before = frames_[0].R * RotationFromVector(-turn);
  const Eigen::Matrix3d axes = before * LeftJacobian(turn);
  for (int row = kWaistParameterCount; row < end; ++row) {
    const int index = model_.parameters[row].correction;
    const int axis = model_.elasticity.corrections[index].axis;
    if (axis < 3) {
      SetTranslation(screws_, row, loads.shapes[index] * before.col(axis));
    } else {
      SetRotation(screws_, row, loads.shapes[index] * axes.col(axis - 3), frames_[0].p);
    }
  }
}

/// Sets how corrections of loads displace the body that a joint moves: by the displacement of the
/// body before, plus the joint's deflection under the load that the correction adds.
void GeneralizedJacobian::AddLoadCorrections(int joint, const Geometry::JointConstants& constants,
                                             const MdhFrame& twisted, const JointLoads& acting,
                                             const JointLoads& loads) {
  const int n = load_corrections_;
  const auto rows_of = [&](int body) { return first_load_row_ + body * n; };
  const Joint& moved = model_.tree.joints[joint];
  screws_.middleRows(rows_of(joint + 1), n) = screws_.middleRows(rows_of(moved.parent_body), n);
  if (loads.by_correction.empty()) return;
  const bool revolute = moved.type == JointType::kRevolute;
  Eigen::Matrix3d axes = twisted.R;
  if (revolute) axes *= LeftJacobian(constants.compliance.cwiseProduct(acting.col(joint)));
  const Vector3d centre = twisted.p + constants.centre * twisted.R.col(2);
  const int first = kWaistParameterCount + root_corrections_;
  for (int i = 0; i < n; ++i) {
    const auto correction = static_cast<std::size_t>(model_.parameters[first + i].correction);
    const Vector3d step =
        axes * constants.compliance.cwiseProduct(loads.by_correction[correction].col(joint));
    const int row = rows_of(joint + 1) + i;
    if (revolute) {
      AddRotation(screws_, row, step, centre);
    } else {
      screws_.row(row).tail<3>() += step.transpose().array();
    }
  }
}

void GeneralizedJacobian::SetMarkerCorrections(const Geometry& geometry, const JointLoads& loads) {
  const int end = model_.parameter_count() - 3 * model_.marker_count();
  for (int row = first_marker_correction_; row < end; ++row) {
    const int index = model_.parameters[row].correction;
    const Correction& correction = model_.elasticity.corrections[index];
    const double shape = loads.shapes.size() > 0 ? loads.shapes[index] : 0.0;
    const MdhFrame& frame = frames_[layout_[correction.marker].body];
    const Eigen::Matrix3d axes = frame.R * geometry.R_joint_link[correction.marker];
    SetTranslation(screws_, row, shape * axes.col(correction.axis));
  }
}

/// Sets the screws of linkages: an error of a linkage displaces all that is beyond its joints as
/// motions of these joints do.
void GeneralizedJacobian::SetLinkages(const Geometry& geometry, const Eigen::VectorXd& q) {
  const LinkedPosture posture = PlaceLinkages(model_.tree, geometry.linkage_errors, q);
  for (const LinkageRows& rows : linkage_rows_) {
    const auto index = static_cast<std::size_t>(rows.linkage);
    const Linkage& linkage = model_.tree.linkages[index];
    auto screws = screws_.middleRows(rows.row, rows.count);
    screws.setZero();
    for (int j : rows.moved) {
      const int joint = linkage.joints[static_cast<std::size_t>(j)];
      const MdhFrame& frame = frames_[joint + 1];  // its z is the joint's axis
      Eigen::Array<double, 1, 6> axis;
      axis << frame.R.col(2).transpose().array(), frame.p.cross(frame.R.col(2)).transpose().array();
      screws += (posture.by_errors[index].row(j).transpose() * axis.matrix()).array();
    }
  }
}

void GeneralizedJacobian::EvaluateScrews(const Geometry& geometry, const Eigen::VectorXd& q,
                                         const JointLoads& loads) {
  const bool reloaded = !loads.by_correction.empty();
  const JointLoads with_corrections = reloaded ? CorrectedLoads(geometry, loads) : JointLoads();
  const JointLoads& acting = reloaded ? with_corrections : loads;
  // Sets the screws in the order of the parameters of one joint, or of the waist.
  const auto visit = [&](int joint, const Geometry::JointConstants& constants,
                         const MdhFrame& parent, const MdhFrame& twisted,
                         const MdhFrame& deflected) {
    const bool waist = joint == kWaist;
    int row = waist ? 0 : first_parameter_[joint];
    if (waist || model_.placements[joint].general) {
      const Vector3d z = parent.R * constants.z_pre;
      SetRotation(screws_, row++, z, parent.p + parent.R * constants.p_pre);
      SetTranslation(screws_, row++, z);
    }
    if (!waist && model_.placements[joint].parallel) {
      SetRotation(screws_, row++, parent.R * constants.y_beta,
                  parent.p + parent.R * constants.p_beta);
    }
    SetRotation(screws_, row++, twisted.R.col(0), twisted.p);
    SetTranslation(screws_, row++, twisted.R.col(0));
    SetRotation(screws_, row++, deflected.R.col(2), deflected.p);
    // An error of r also moves the physical centre, so its direction is the axis before deflection.
    SetTranslation(screws_, row++, twisted.R.col(2));
    if (waist) return;
    if (compliances_[joint] > 0) SetCompliances(joint, row, constants, twisted, acting);
    if (load_corrections_ > 0) AddLoadCorrections(joint, constants, twisted, acting, loads);
    SetCorrections(joint, row + compliances_[joint], deflected, loads);
    if (root_joints_ == LoadsOfRootJoints::kTurning && acting.cols() > 0 &&
        model_.tree.joints[joint].parent_body == 0) {
      TurnLoads(joint, constants, twisted, acting);
    }
  };
  EvaluateMdhFrames(model_, geometry, q, acting, frames_, visit);
  if (!linkage_rows_.empty()) SetLinkages(geometry, q);
  if (root_corrections_ > 0) SetRootCorrections(geometry, loads);
  SetMarkerCorrections(geometry, loads);
}

void GeneralizedJacobian::EvaluateMarker(int marker) {
  const MarkerLayout& layout = layout_[marker];
  const double px = positions_(0, marker);
  const double py = positions_(1, marker);
  const double pz = positions_(2, marker);
  const auto width = static_cast<Eigen::Index>(layout.columns.size());
  double* const row_x = values_.data() + layout.offset;
  double* const row_y = row_x + width;
  double* const row_z = row_y + width;
  Eigen::Index at = 0;
  for (const Segment& segment : layout.segments) {
    const auto screws = screws_.middleRows(segment.begin, segment.size);
    const auto ax = screws.col(0);
    const auto ay = screws.col(1);
    const auto az = screws.col(2);
    using Run = Eigen::Map<Eigen::ArrayXd>;
    Run(row_x + at, segment.size) = ay * pz - az * py + screws.col(3);
    Run(row_y + at, segment.size) = az * px - ax * pz + screws.col(4);
    Run(row_z + at, segment.size) = ax * py - ay * px + screws.col(5);
    at += segment.size;
  }
}

void GeneralizedJacobian::EvaluateLeg(int leg) {
  const Link& foot = model_.tree.links[model_.legs[leg].link];
  const MdhFrame& frame = frames_[foot.body];
  Transform T_ref_joint = Transform::Identity();
  T_ref_joint.linear() = frame.R;
  T_ref_joint.translation() = frame.p;
  T_ref_foot_[leg] = T_ref_joint * model_.placements[foot.body - 1].T_joint_body * foot.T_body_link;
  Eigen::Index at = 0;
  for (const Segment& segment : legs_[leg].segments) {
    leg_screws_[leg].middleCols(at, segment.size) =
        screws_.middleRows(segment.begin, segment.size).matrix().transpose();
    at += segment.size;
  }
}

void GeneralizedJacobian::Evaluate(const Geometry& geometry, const Eigen::VectorXd& q,
                                   const JointLoads& loads) {
  InterruptionPoint();
  EvaluateScrews(geometry, q, loads);
  for (int leg = 0; leg < model_.leg_count(); ++leg) EvaluateLeg(leg);
  for (int m = 0; m < model_.marker_count(); ++m) {
    const MdhFrame& frame = frames_[layout_[m].body];
    positions_.col(m) = frame.p + frame.R * MarkerInBody(model_, geometry, loads, m);
    EvaluateMarker(m);
    const auto width = static_cast<Eigen::Index>(layout_[m].columns.size());
    Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>> block(
        values_.data() + layout_[m].offset, 3, width);
    block.rightCols<3>() = frame.R * geometry.R_joint_link[m];
  }
}

Eigen::MatrixXd GeneralizedJacobian::Dense() const {
  Eigen::MatrixXd dense =
      Eigen::MatrixXd::Zero(3 * model_.marker_count(), model_.parameter_count());
  for (int m = 0; m < model_.marker_count(); ++m) {
    dense(Eigen::seqN(3 * m, 3), Columns(m)) = Block(m);
  }
  return dense;
}

}  // namespace elastocal
