// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/loads.hpp"

#include <algorithm>

#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

MeasuredLoads MeasuredLoadsOf(const ErrorModel& model, const Recording& recording, int posture,
                              int leg) {
  MeasuredLoads measured;
  if (recording.torques.rows() > 0) measured.torques = recording.torques.row(posture).transpose();
  if (leg < 0) return measured;
  for (std::size_t s = 0; s < recording.wrench_links.size(); ++s) {
    const int body = model.tree.links[recording.wrench_links[s]].body;
    const std::vector<int>& joints = model.legs[leg].joints;
    const bool on_leg = std::find(joints.begin(), joints.end(), body - 1) != joints.end();
    const auto wrench = recording.wrenches.row(posture).segment<6>(6 * static_cast<int>(s));
    if (!on_leg || !wrench.allFinite()) continue;
    measured.wrench_link = recording.wrench_links[s];
    measured.wrench = wrench.transpose();
  }
  return measured;
}

namespace {

/// Moment of the weight of all links about the origin of the root link, in its axes, N.m.
Eigen::Vector3d RootMoment(const ErrorModel& model, const Geometry& geometry,
                           const Eigen::VectorXd& q, const Eigen::Vector3d& gravity_ref) {
  const std::vector<Transform> T_ref_link = CalibratedLinkTransforms(model, geometry, q);
  const Transform T_ref_root = WaistPose(geometry);
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < model.tree.links.size(); ++i) {
    const Link& link = model.tree.links[i];
    const Eigen::Vector3d arm = T_ref_link[i] * link.com - T_ref_root.translation();
    moment += arm.cross(link.mass * gravity_ref);
  }
  return T_ref_root.linear().transpose() * moment;
}

PostureHistory HistoryOf(const Recording& recording, int posture) {
  PostureHistory history;
  if (recording.approach.rows() > 0) history.approach = recording.approach.row(posture).transpose();
  if (recording.time_s.size() > 0) {
    history.hours = recording.time_s[posture] / 3600.0;
  }
  return history;
}

/// What the corrections of the model multiply in a posture.
void AddShapes(const ErrorModel& model, const Geometry& geometry, const Recording& recording,
               int posture, JointLoads& loads) {
  PostureHistory history = HistoryOf(recording, posture);
  const Eigen::VectorXd q = recording.q.row(posture).transpose();
  history.root_moment = RootMoment(model, geometry, q, recording.gravity);
  loads.shapes = EvaluateShapes(model.tree, model.elasticity.corrections, q,
                                CorrectedLoads(geometry, loads).row(2).transpose(), history);
}

}  // namespace

std::vector<PostureLoads> ComputeLoads(const ErrorModel& model, const Recording& recording,
                                       const Eigen::VectorXd& delta, const Placement& placement,
                                       const LoadOptions& options, LoadReport* report) {
  std::vector<PostureLoads> loads;
  Geometry geometry = ApplyErrors(model, delta);
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (!placement.empty()) PlaceWaist(placement.T_ref_waist[i], Vector6d::Zero(), geometry);
    const int footing = placement.empty() ? -1 : placement.footing[i];
    const int leg = footing < 0 ? -1 : placement.footings[footing].leg;
    loads.push_back(LoadPosture(model, geometry, recording.q.row(i).transpose(), leg,
                                MeasuredLoadsOf(model, recording, i, leg), recording.gravity,
                                options));
    if (!model.elasticity.corrections.empty()) {
      AddShapes(model, geometry, recording, i, loads.back().joints);
    }
    if (report == nullptr) continue;
    if (loads.back().badly_conditioned) report->badly_conditioned.push_back(i);
    for (int joint : loads.back().without_torques) {
      std::vector<int>& without = report->without_torques;
      if (std::find(without.begin(), without.end(), joint) == without.end()) {
        without.push_back(joint);
      }
    }
  }
  return loads;
}

}  // namespace elastocal
