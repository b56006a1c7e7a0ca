// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/check_alternatives.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/math/transform.hpp"

namespace elastocal {
namespace {

/// Postures of four markers at random positions within a metre.
Recording FourMarkers(Eigen::MatrixXd& predicted) {
  Random random(7);
  Recording recording;
  recording.marker_names = {"a", "b", "c", "d"};
  recording.q = Eigen::MatrixXd::Zero(6, 1);
  predicted = Eigen::MatrixXd(6, 12);
  for (double& value : predicted.reshaped()) value = random.Uniform(-1.0, 1.0);
  recording.markers = predicted;
  return recording;
}

TEST(CheckAlternatives, TheScaleOfMarkersIsThatOfTheCameras) {
  Eigen::MatrixXd predicted;
  Recording recording = FourMarkers(predicted);
  EXPECT_NEAR(ScaleOfMarkers(recording, predicted), 1.0, 1e-12);
  recording.markers *= 1.01;
  recording.markers(2, 4) = std::nan("");
  EXPECT_NEAR(ScaleOfMarkers(recording, predicted), 1.01, 1e-12);
  recording.markers.array() += 0.3;  // the cameras' frame is elsewhere
  EXPECT_NEAR(ScaleOfMarkers(recording, predicted), 1.01, 1e-12);
}

// If each posture has its own pose, its place tells nothing about the scale.
TEST(CheckAlternatives, TheScaleOfAFreeRootIsWithinPostures) {
  Eigen::MatrixXd predicted;
  Recording recording = FourMarkers(predicted);
  recording.free_root = true;
  recording.markers *= 0.99;
  for (int i = 0; i < 6; ++i) recording.markers.row(i).array() += 0.2 * i;
  EXPECT_NEAR(ScaleOfMarkers(recording, predicted), 0.99, 1e-12);
}

TEST(CheckAlternatives, NothingSeenTellsNoScale) {
  Eigen::MatrixXd predicted;
  Recording recording = FourMarkers(predicted);
  recording.markers.setConstant(std::nan(""));
  EXPECT_EQ(ScaleOfMarkers(recording, predicted), 1.0);
}

}  // namespace
}  // namespace elastocal
