// SPDX-License-Identifier: Apache-2.0
// Robots at run time whose planar chains a test can solve by hand.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "elastocal/runtime/compensator.hpp"
#include "elastocal/runtime/core_poses.h"

namespace elastocal {

inline constexpr double kThigh = 0.4, kShank = 0.4, kFoot = 0.1;  // m

inline ec_pose Shift(double x, double y) {
  ec_pose pose;
  ec_identity(&pose);
  pose.p[0] = x;
  pose.p[1] = y;
  return pose;
}

/// A rigid planar chain without weight. Joint k turns about z at `at[k]` in the body before it.
struct PlanarChain {
  std::vector<ec_pose> nominal_at, calibrated_at;
  std::vector<double> lower, upper;
  double end = kFoot;
  bool lift = false;  ///< the first joint slides along y

  Compensator Make() const {
    RuntimeModel model;
    const std::size_t count = lower.size();
    for (std::size_t k = 0; k < count; ++k) {
      ec_joint joint{};
      joint.parent = joint.coordinate = static_cast<int>(k);
      joint.multiplier = 1.0;
      ec_identity(&joint.twisted);
      ec_identity(&joint.body);
      if (k == 0 && lift) {
        joint.prismatic = 1;
        const double R[9] = {1, 0, 0, 0, 0, 1, 0, -1, 0};     // z along the world's y
        const double back[9] = {1, 0, 0, 0, 0, -1, 0, 1, 0};  // the inverse turn
        std::copy(R, R + 9, joint.twisted.R);
        std::copy(back, back + 9, joint.body.R);
      }
      std::copy(nominal_at[k].p, nominal_at[k].p + 3, joint.twisted.p);
      model.nominal.push_back(joint);
      std::copy(calibrated_at[k].p, calibrated_at[k].p + 3, joint.twisted.p);
      model.calibrated.push_back(joint);
      model.joint_names.push_back("joint" + std::to_string(k));
    }
    model.coordinate_names = model.joint_names;
    model.mass.assign(count + 1, 0.0);
    model.moment.assign(3 * (count + 1), 0.0);
    model.leg_of_body.assign(count + 1, -1);
    ec_tip tip{};
    tip.frame.body = static_cast<int>(count);
    tip.frame.pose = Shift(end, 0.0);
    tip.foot = -1;
    model.links = {tip.frame};
    model.link_names = model.tip_names = {"end"};
    model.tips = {tip};
    model.lower = lower;
    model.upper = upper;
    return Compensator(std::move(model));
  }
};

/// Hip, knee and ankle. The real shank is longer than the nominal one by `longer`.
inline PlanarChain PlanarLeg(double longer, double knee_lower, double knee_upper) {
  PlanarChain leg;
  leg.nominal_at = {Shift(0, 0), Shift(kThigh, 0), Shift(kShank, 0)};
  leg.calibrated_at = {Shift(0, 0), Shift(kThigh, 0), Shift(kShank + longer, 0)};
  leg.lower = {-1.5, knee_lower, -1.0};
  leg.upper = {1.5, knee_upper, 1.0};
  return leg;
}

}  // namespace elastocal
