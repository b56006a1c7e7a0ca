// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/weight_shares.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "elastocal/math/numbers.hpp"
#include "elastocal/robot/error_model.hpp"
#include "elastocal/robot/leg_load.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

constexpr double kWeightKnown = 0.2;  // relative error of a weight by masses and sensors' gains

/// Nominal model in which each foot of a recording is the end of a leg.
ErrorModel LegsOf(const RobotTree& tree, const std::vector<Marker>& markers,
                  const Recording& recording) {
  std::set<int> feet;
  for (const Trial& trial : recording.trials) {
    feet.insert(trial.support.begin(), trial.support.end());
  }
  Elasticity elasticity;
  for (int link : feet) elasticity.legs.push_back({tree.links[Size(link)].name, link});
  return MakeErrorModel(tree, markers, {}, elasticity);
}

/// Vertical force of a foot on the floor in a posture, N: the load that the waist puts on the leg,
/// by the torques of the leg's joints (eq. 6), plus the leg's own weight. NaN if the leg has fewer
/// than six joints or LoadFromTorques is not reliable.
double PressOn(const ErrorModel& model, const Geometry& geometry, int leg, int posture,
               const Recording& recording) {
  const SupportLeg& on = model.legs[Size(leg)];
  if (on.joints.size() < 6) return NAN;  // their torques do not tell the load
  const Eigen::VectorXd q = recording.q.row(posture).transpose();
  const LegPosture placed = PlaceLeg(model, geometry, q, leg);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(q.size());
  const Eigen::Vector3d up_foot =
      LinkTransforms(model.tree, zero)[Size(on.link)].linear().row(2).transpose();
  const Eigen::Vector3d gravity =
      -kGravity.norm() * (placed.T_ref_link[Size(on.link)].linear() * up_foot);
  const Eigen::VectorXd torques = recording.torques.row(posture)(on.joints).transpose();
  const LegLoad load = LoadFromTorques(placed, torques - LegWeightTorques(model, placed, gravity));
  if (load.status != LegLoadStatus::kReliable) return NAN;
  const double but_leg = LoadFromStatics(model, placed, gravity).head<3>().norm();
  return TotalMass(model.tree) * kGravity.norm() - but_leg - up_foot.dot(load.wrench.head<3>());
}

/// Vertical forces of one foot (`own`) and of all supporting feet together (`all`) on the floor, N:
/// means over the postures in which the torques tell both.
struct Pressed {
  double own = 0.0, all = 0.0;
  int postures = 0;
};

Pressed PressedOn(const ErrorModel& model, const Geometry& geometry, const Trial& trial, int link,
                  const std::vector<int>& postures, const Recording& recording) {
  Pressed mean;
  if (recording.torques.rows() == 0) return mean;
  for (int i : postures) {
    double own = 0.0, all = 0.0;
    for (int leg = 0; leg < model.leg_count(); ++leg) {
      const int foot = model.legs[Size(leg)].link;
      if (std::ranges::find(trial.support, foot) == trial.support.end()) continue;
      const double press = PressOn(model, geometry, leg, i, recording);
      all += press;
      if (foot == link) own = press;
    }
    if (!std::isfinite(own) || !std::isfinite(all)) continue;
    mean.own += own;
    mean.all += all;
    ++mean.postures;
  }
  if (mean.postures == 0) return mean;
  mean.own /= mean.postures;
  mean.all /= mean.postures;
  return mean;
}

/// Share of the weight on the foot `link` through a trial, see ShareWeights.
double ShareOfWeight(const ErrorModel& model, const Geometry& geometry, const Trial& trial,
                     int link, const std::vector<int>& postures, const Recording& recording) {
  const Pressed pressed = PressedOn(model, geometry, trial, link, postures, recording);
  if (pressed.postures == 0) return trial.support.size() == 1 ? 1.0 : NAN;
  const double weight = TotalMass(model.tree) * kGravity.norm();
  if (!(std::abs(pressed.all - weight) < kWeightKnown * weight)) return NAN;
  const double share = pressed.own / pressed.all;
  return share >= 0.0 && share <= 1.0 ? share : NAN;
}

}  // namespace

void ShareWeights(const RobotTree& tree, const std::vector<Marker>& markers,
                  const Recording& recording, const std::vector<int>& trials,
                  std::vector<FootRest>& rests) {
  std::vector<std::vector<int>> postures(recording.trials.size());
  for (std::size_t i = 0; i < recording.trial.size(); ++i) {
    postures[Size(recording.trial[i])].push_back(static_cast<int>(i));
  }
  const ErrorModel model = LegsOf(tree, markers, recording);
  Geometry geometry = ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
  PlaceWaist(Transform::Identity(), Vector6d::Zero(), geometry);
  for (FootRest& rest : rests) {
    const int t = Size(rest.trial) < trials.size() ? trials[Size(rest.trial)] : -1;
    if (t < 0) continue;
    rest.share = ShareOfWeight(model, geometry, recording.trials[Size(t)], rest.link,
                               postures[Size(t)], recording);
  }
}

}  // namespace elastocal
