#include "elastocal/calibration/loads.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/robot/leg_load.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

void Report(std::vector<int>* list, int entry) {
  if (list == nullptr || std::find(list->begin(), list->end(), entry) != list->end()) return;
  list->push_back(entry);
}

/// Torques of the leg's joints; by statics where there is no sensor.
Eigen::VectorXd LegTorques(const SupportLeg& leg, const Eigen::VectorXd& measured,
                           const JointLoads& gravity, std::vector<int>* without) {
  Eigen::VectorXd torques(static_cast<Eigen::Index>(leg.joints.size()));
  for (Eigen::Index i = 0; i < torques.size(); ++i) {
    const int joint = leg.joints[static_cast<std::size_t>(i)];
    const bool sensed = measured.size() > 0 && std::isfinite(measured[joint]);
    torques[i] = sensed ? measured[joint] : -gravity(2, joint);
    if (!sensed) Report(without, joint);
  }
  return torques;
}

/// Index of a force-torque sensor on the leg that was recorded in the posture; -1 for none.
int FindWrench(const ErrorModel& model, const Recording& recording, const SupportLeg& leg,
               int posture) {
  for (std::size_t s = 0; s < recording.wrench_links.size(); ++s) {
    const int body = model.tree.links[recording.wrench_links[s]].body;
    const bool on_leg = std::any_of(leg.joints.begin(), leg.joints.end(),
                                    [&](int joint) { return joint + 1 == body; });
    if (on_leg && recording.wrenches.row(posture).segment<6>(6 * static_cast<int>(s)).allFinite()) {
      return static_cast<int>(s);
    }
  }
  return -1;
}

void LoadWaist(const ErrorModel& model, const Recording& recording, int posture,
               const LegPosture& leg, const Eigen::VectorXd& measured, const JointLoads& gravity,
               const LoadOptions& options, LoadReport* report, PostureLoads& loads) {
  const SupportLeg& support = model.legs[leg.leg];
  loads.waist_by_bias.setZero(6, static_cast<Eigen::Index>(support.joints.size()));
  const int sensor =
      options.source == LoadSource::kWrench ? FindWrench(model, recording, support, posture) : -1;
  if (sensor >= 0) {
    const Vector6d wrench = recording.wrenches.row(posture).segment<6>(6 * sensor).transpose();
    loads.waist =
        LoadFromWrench(model, leg, recording.wrench_links[sensor], wrench, recording.gravity);
    return;
  }
  loads.waist = LoadFromStatics(model, leg, recording.gravity);
  if (options.source == LoadSource::kStatics) return;
  const Eigen::VectorXd torques = LegTorques(
      support, measured, gravity, report != nullptr ? &report->without_torques : nullptr);
  const LegLoad load =
      LoadFromTorques(leg, torques - LegWeightTorques(model, leg, recording.gravity),
                      {.max_condition = options.largest_condition});
  if (load.status != LegLoadStatus::kReliable) {
    Report(report != nullptr ? &report->badly_conditioned : nullptr, posture);
    return;
  }
  loads.waist = load.wrench;
  loads.waist_by_bias = -load.wrench_by_torque;
}

}  // namespace

std::vector<PostureLoads> ComputeLoads(const ErrorModel& model, const Recording& recording,
                                       const Eigen::VectorXd& delta, const Placement& placement,
                                       const LoadOptions& options, LoadReport* report) {
  std::vector<PostureLoads> loads(recording.posture_count());
  Geometry geometry = ApplyErrors(model, delta);
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (!placement.empty()) PlaceWaist(placement.T_ref_waist[i], Vector6d::Zero(), geometry);
    const int footing = placement.empty() ? -1 : placement.footing[i];
    const int leg = footing < 0 ? -1 : placement.footings[footing].leg;
    const Eigen::VectorXd q = recording.q.row(i).transpose();
    const Eigen::VectorXd measured = recording.torques.rows() > 0
                                         ? Eigen::VectorXd(recording.torques.row(i).transpose())
                                         : Eigen::VectorXd();
    const JointLoads gravity =
        GravityLoads(model, geometry, q, recording.gravity, leg < 0 ? 0 : model.legs[leg].link);
    loads[i].joints = gravity;
    if (measured.size() > 0) UseMeasuredTorques(measured, loads[i].joints);
    if (leg < 0) continue;
    LoadWaist(model, recording, i, PlaceLeg(model, geometry, q, leg, loads[i].joints), measured,
              gravity, options, report, loads[i]);
  }
  return loads;
}

}  // namespace elastocal
