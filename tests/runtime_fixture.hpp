// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/legs.hpp"
#include "elastocal/robot/statics.hpp"
#include "elastocal/runtime/compensator.hpp"
#include "tests/runtime_calibration.hpp"
#include "tests/test_files.hpp"

namespace elastocal {

// Rounding along a chain of 14 joints: a few units in the last place of a metre.
inline constexpr double kRounding = 1e-13;

inline const Eigen::VectorXd kNoTorque;

inline double Distance(const Eigen::Isometry3d& a, const Transform& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

class Runtime : public testing::Test {
 protected:
  Runtime()
      : project_(ReadProject(SourceFile("models/talos/project.yaml"))),
        stored_(RandomCalibration(project_, 1)),
        robot_(RestoreRobot(project_, stored_)),
        geometry_(ApplyErrors(robot_.model, robot_.errors)) {
    // The root link is the reference, so the errors of the waist are zero.
    PlaceWaist(Transform::Identity(), Vector6d::Zero(), geometry_);
  }

  Compensator Make(RuntimeContent content = RuntimeContent::kEverything) const {
    return Compensator(MakeRuntimeModel(project_, stored_, content));
  }

  /// The posture of rest. The right elbow opens to 6 degrees from straight and closes again within
  /// so many steps.
  std::vector<Eigen::VectorXd> StretchOfElbow(int steps) const {
    const int elbow = FindJoint(project_.tree, "arm_right_4_joint");
    const int c = project_.tree.joints[static_cast<std::size_t>(elbow)].coordinate;
    std::vector<Eigen::VectorXd> plans;
    for (int i = 0; i <= steps; ++i) {
      plans.push_back(project_.motion.rest);
      plans.back()[c] = -0.1 - 0.45 * (1.0 + std::cos(2.0 * M_PI * i / steps));
    }
    return plans;
  }

  /// A standing posture with random arms and legs.
  Eigen::VectorXd Posture(std::uint64_t seed) const {
    Random random(seed);
    Eigen::VectorXd q = project_.motion.rest;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      q[i] += 0.3 * random.Uniform(-0.5, 0.5);
    }
    return q.cwiseMax(project_.motion.lower).cwiseMin(project_.motion.upper);
  }

  /// Gravity in the root link's frame if the foot of leg `leg` is flat on the floor.
  Eigen::Vector3d Gravity(const std::vector<Transform>& T_root_link, int leg) const {
    const std::vector<Leg> legs = Legs();
    const Leg& on = legs[static_cast<std::size_t>(leg)];
    return T_root_link[static_cast<std::size_t>(on.foot_link)].linear() *
           (on.R_floor_foot.transpose() * kGravity);
  }

  std::vector<Leg> Legs() const {
    std::vector<NamedChain> chains;
    for (const Chain& chain : project_.chains) {
      chains.push_back({chain.name, chain.from_link, chain.tip_link});
    }
    return FindLegs(project_.tree, chains);
  }

  Project project_;
  StoredCalibration stored_;
  StoredRobot robot_;
  Geometry geometry_;
};

}  // namespace elastocal
