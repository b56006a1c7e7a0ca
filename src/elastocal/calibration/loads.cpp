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

PostureHistory HistoryOf(const Recording& recording, int posture) {
  PostureHistory history;
  if (recording.approach.rows() > 0) history.approach = recording.approach.row(posture).transpose();
  if (recording.time_s.size() > 0) {
    history.hours = recording.time_s[posture] / 3600.0;
  }
  return history;
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
      AddShapes(model, geometry, recording.q.row(i).transpose(), recording.gravity,
                HistoryOf(recording, i), loads.back().joints);
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
