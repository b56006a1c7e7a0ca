// SPDX-License-Identifier: Apache-2.0
#include "elastocal/description/series_springs.hpp"

#include <algorithm>
#include <utility>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

constexpr const char* kAxisNames[] = {"x", "y", "z"};

/// The twisted frame of a joint in its child link at position 0.
Transform TwistedInChild(const ErrorModel& model, const Geometry& geometry,
                         const RobotTree& calibrated, int k) {
  const Joint& joint = model.tree.joints[static_cast<std::size_t>(k)];
  const Geometry::JointConstants& constants = geometry.joints[static_cast<std::size_t>(k)];
  Transform T_parent_twisted = Transform::Identity();
  T_parent_twisted.linear() = constants.R_parent_twisted;
  T_parent_twisted.translation() = constants.p_parent_twisted;
  Transform T_parent_link =
      model.tree.links[static_cast<std::size_t>(joint.parent_link)].T_body_link;
  if (joint.parent_body > 0) {
    T_parent_link = model.placements[static_cast<std::size_t>(joint.parent_body - 1)].T_joint_body *
                    T_parent_link;
  }
  return (T_parent_link * calibrated.joints[static_cast<std::size_t>(k)].T_parent_child).inverse() *
         T_parent_twisted;
}

/// The leg whose first joint is `k`, if `k` belongs to no other leg; else null.
const Leg* LegFrom(const std::vector<Leg>& legs, int k) {
  const Leg* found = nullptr;
  for (const Leg& leg : legs) {
    if (leg.joints.empty() || leg.joints.front() != k) continue;
    if (found != nullptr) return nullptr;
    found = &leg;
  }
  return found;
}

/// Adds springs about one point whose compliance is positive.
class SpringCollector {
 public:
  std::vector<SeriesSpring> springs;

  void Add(int joint, SpringPlace place, const std::string& name, bool slides,
           const Eigen::Vector3d& axis, const Eigen::Vector3d& anchor, double compliance,
           double unloaded = 0.0) {
    if (!(compliance > 0.0)) return;
    springs.push_back({.joint = joint,
                       .place = place,
                       .name = name,
                       .slides = slides,
                       .axis = axis,
                       .anchor = anchor,
                       .compliance = compliance,
                       .unloaded = unloaded});
  }
};

/// What the leg that begins with a joint weighs.
struct LegWeight {
  double share = 0.0;     ///< of the robot's
  Eigen::Vector3d force;  ///< in the axes of the root link, N
};

LegWeight WeightOfLeg(const RobotTree& tree, int joint) {
  std::vector<bool> beyond(Size(tree.body_count()), false);
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    beyond[k + 1] = static_cast<int>(k) == joint || beyond[Size(tree.joints[k].parent_body)];
  }
  double all = 0.0, mass = 0.0;
  for (const Link& link : tree.links) {
    all += link.mass;
    if (beyond[Size(link.body)]) mass += link.mass;
  }
  return {.share = all > 0.0 ? mass / all : 0.0, .force = mass * kGravity};
}

void AddLegSprings(const ErrorModel& model, const Geometry& geometry, const Leg& leg, int joint,
                   const LegWeight& weight, SpringCollector& to) {
  for (std::size_t i = 0; i < geometry.leg_compliance.size(); ++i) {
    if (model.legs[i].link != leg.foot_link) continue;
    for (int axis = 0; axis < 6; ++axis) {
      const bool slides = axis < 3;
      const Eigen::Vector3d along = leg.R_floor_foot.col(axis % 3);
      const std::string name =
          model.legs[i].name + ".compliance_" + (slides ? "" : "r") + kAxisNames[axis % 3];
      double compliance = geometry.leg_compliance[i][axis], unloaded = 0.0;
      if (slides) {
        compliance *= 1.0 - weight.share;
        unloaded = -compliance * along.dot(weight.force);
      }
      to.Add(joint, SpringPlace::kLeg, name, slides, along, Eigen::Vector3d::Zero(), compliance,
             unloaded);
    }
  }
}

}  // namespace

std::vector<SeriesSpring> SeriesSprings(const CalibrationResult& calibration,
                                        const RobotTree& calibrated, const std::vector<Leg>& legs) {
  const ErrorModel& model = calibration.model;
  const Geometry geometry = ApplyErrors(model, calibration.delta);
  SpringCollector collector;
  for (int k : model.active_joints) {
    const Joint& joint = model.tree.joints[static_cast<std::size_t>(k)];
    const Geometry::JointConstants& constants = geometry.joints[static_cast<std::size_t>(k)];
    if (joint.parent_body == 0) {
      if (const Leg* leg = LegFrom(legs, k)) {
        AddLegSprings(model, geometry, *leg, k, WeightOfLeg(calibrated, k), collector);
      }
      for (int axis = 0; axis < 3; ++axis) {
        collector.Add(
            k, SpringPlace::kRootLink, joint.name + ".compliance_root_" + kAxisNames[axis], false,
            Eigen::Vector3d::Unit(axis), Eigen::Vector3d::Zero(), constants.root_compliance[axis]);
      }
    }
    const Transform T_child_twisted = TwistedInChild(model, geometry, calibrated, k);
    const bool slides = joint.type == JointType::kPrismatic;
    for (int axis = slides ? 2 : 0; axis < 3; ++axis) {
      collector.Add(k, SpringPlace::kJoint, joint.name + ".compliance_" + kAxisNames[axis], slides,
                    T_child_twisted.linear().col(axis),
                    T_child_twisted * Eigen::Vector3d(0, 0, constants.centre),
                    constants.compliance[axis]);
    }
  }
  return std::move(collector.springs);
}

std::vector<SeriesSpring> SpringsOfSoles(const std::vector<SoleSpring>& soles,
                                         const RobotTree& calibrated,
                                         const std::vector<Leg>& legs) {
  SpringCollector collector;
  for (const SoleSpring& sole : soles) {
    const auto leg = std::ranges::find(legs, sole.leg, &Leg::chain);
    if (!sole.told() || leg == legs.end() || leg->joints.empty()) continue;
    const int last = leg->joints.back();
    const Link& ankle = calibrated.links[Size(calibrated.joints[Size(last)].child_link)];
    const Transform T_ankle_foot =
        ankle.T_body_link.inverse() * calibrated.links[Size(leg->foot_link)].T_body_link;
    const Eigen::Vector3d up = leg->R_floor_foot.transpose() * Eigen::Vector3d::UnitZ();
    collector.Add(last, SpringPlace::kSole, sole.leg + ".compliance_sole", true,
                  T_ankle_foot.linear() * up, T_ankle_foot.translation(), sole.compliance);
  }
  return std::move(collector.springs);
}

}  // namespace elastocal
