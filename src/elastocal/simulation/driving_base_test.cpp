// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/driving_base.hpp"

#include <gtest/gtest.h>

#include "elastocal/simulation/given_motion.hpp"

namespace elastocal {
namespace {

/// Rests of a second at 0, 1 and 2 rad with motions of a second between them, and a sine at the
/// end.
Motion RestsAndASine() {
  Motion motion;
  const auto at = [](double value) { return Eigen::VectorXd::Constant(1, value); };
  for (int k = 0; k < 3; ++k) {
    motion.segments.push_back({.duration_s = 1.0, .from = at(k), .to = at(k)});
    if (k < 2) motion.segments.push_back({.duration_s = 1.0, .from = at(k), .to = at(k + 1)});
  }
  motion.segments.push_back({.duration_s = 2.0,
                             .from = at(2),
                             .to = at(2),
                             .coordinate = 0,
                             .centre = 2.0,
                             .amplitude = 0.5,
                             .frequency_hz = 1.0});
  return motion;
}

TEST(DriveBase, StandsWhereTheRobotRestsAndIsElsewhereAtTheNextRest) {
  const Motion motion = RestsAndASine();
  const Transform T_camera_world = FromXyzRpy({1.0, 2.0, 0.3}, {0.0, 0.0, 0.7});
  TrueMotion held;
  const int frames = 700;
  held.markers.resize(frames, 6);
  const Eigen::Vector3d a(0.1, 0.2, 0.5), b(0.4, -0.2, 0.9);
  for (int i = 0; i < frames; ++i) {
    held.markers.row(i) << (T_camera_world * a).transpose(), (T_camera_world * b).transpose();
    held.T_camera_waist.push_back(T_camera_world);
  }
  TrueMotion played = held;
  DriveBase(motion, T_camera_world, 5, played);

  double fastest = 0.0;
  for (int i = 0; i < frames; ++i) {
    // Relative to its root, the robot is unchanged. Its base is on a level floor.
    const Transform T_camera_root = played.T_camera_waist[static_cast<std::size_t>(i)];
    const Eigen::Vector3d first = played.markers.block<1, 3>(i, 0).transpose();
    const Eigen::Vector3d second = played.markers.block<1, 3>(i, 3).transpose();
    EXPECT_LT((T_camera_root.inverse() * first - a).norm(), 1e-12);
    EXPECT_LT((T_camera_root.inverse() * second - b).norm(), 1e-12);
    const Transform placed = T_camera_world.inverse() * T_camera_root;
    EXPECT_NEAR(placed.translation().z(), 0.0, 1e-12);
    EXPECT_NEAR(placed.linear()(2, 2), 1.0, 1e-12);
    EXPECT_LE(placed.translation().cwiseAbs().maxCoeff(), kDrivingSpan + 1e-12);
    if (i > 0) {
      const double moved = (first - played.markers.block<1, 3>(i - 1, 0).transpose()).norm();
      fastest = std::max(fastest, moved * played.rate_hz);
      const bool resting = (i % 200 > 1 && i % 200 < 99 && i < 500);
      if (resting) {
        EXPECT_LT(moved, 1e-12) << i;
      }
    }
  }
  const auto base = [&](int frame) {
    return played.T_camera_waist[static_cast<std::size_t>(frame)].translation();
  };
  EXPECT_GT((base(250) - base(50)).norm(), 0.01);
  EXPECT_GT((base(450) - base(250)).norm(), 0.01);
  // The base moves during the whole sine, whose turning points are no rests.
  EXPECT_GT((base(699) - base(450)).norm(), 0.01);
  EXPECT_LT(fastest, 3.0);  // at most 0.85 m and 1 rad in a second, with 1.9 times the mean speed

  TrueMotion again = held;
  DriveBase(motion, T_camera_world, 5, again);
  EXPECT_EQ(again.markers, played.markers);
}

}  // namespace
}  // namespace elastocal
