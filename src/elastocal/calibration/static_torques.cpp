// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/static_torques.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastocal/robot/kinematics.hpp"
#include "elastocal/robot/statics.hpp"

namespace elastocal {
namespace {

/// Whether the joint is between the root and one of the links.
bool Carries(const RobotTree& tree, int joint, const std::vector<int>& links) {
  for (int link : links) {
    for (int on_way : JointsToBody(tree, tree.links[link].body)) {
      if (on_way == joint) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<TorquePairs> PairTorques(const ErrorModel& model, const Recording& recording,
                                     const Placement& placement) {
  const std::size_t joints = model.tree.joints.size();
  std::vector<TorquePairs> pairs(joints);
  for (int i = 0; i < recording.posture_count(); ++i) {
    const Trial& trial = recording.trials[recording.trial[i]];
    const int fixed = trial.support.size() == 1 ? trial.support[0] : 0;
    const Eigen::Vector3d gravity_waist =
        placement.T_ref_waist[i].linear().transpose() * recording.gravity;
    const std::vector<CarriedLoad> carried =
        CarriedLoads(model.tree, LinkTransforms(model.tree, recording.q.row(i).transpose()), fixed);
    const Eigen::VectorXd expected =
        StaticTorques(model.tree, recording.q.row(i).transpose(), gravity_waist, fixed);
    for (std::size_t k = 0; k < joints; ++k) {
      const int joint = static_cast<int>(k);
      const double measured = recording.torques(i, joint);
      // How two feet share the load, statics does not say.
      const bool shared = trial.support.size() > 1 && Carries(model.tree, joint, trial.support);
      if (!std::isfinite(measured) || shared) continue;
      pairs[k].expected.push_back(expected[model.tree.joints[k].coordinate]);
      pairs[k].measured.push_back(measured);
      pairs[k].posture.push_back(i);
      pairs[k].weight = std::max(pairs[k].weight, recording.gravity.norm() * carried[k].mass);
    }
  }
  return pairs;
}

double TorqueDisagreement(const ErrorModel& model, const Recording& recording,
                          const Placement& placement, int leg) {
  double squares = 0.0, all = 0.0;
  if (recording.torques.rows() > 0 && TotalMass(model.tree) > 0.0) {
    const std::vector<TorquePairs> pairs = PairTorques(model, recording, placement);
    const auto on_this_leg = [&](int posture) {
      return recording.trials[recording.trial[posture]].support ==
             std::vector{model.legs[leg].link};
    };
    for (int joint : model.legs[leg].joints) {
      const TorquePairs& of = pairs[joint];
      for (std::size_t j = 0; j < of.posture.size(); ++j) {
        if (!on_this_leg(of.posture[j])) continue;
        squares += std::pow(of.measured[j] - of.expected[j], 2);
        all += std::pow(of.measured[j], 2);
      }
    }
  }
  return all > 0.0 ? std::sqrt(squares / all) : std::numeric_limits<double>::infinity();
}

}  // namespace elastocal
