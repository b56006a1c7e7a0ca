// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/placed_misfit.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

/// Postures of a nominal biped with displaced markers, seen by cameras at an unknown place.
class PlacedMisfitTest : public testing::Test {
 protected:
  PlacedMisfitTest() : table_(robot_.Empty({{.name = "a", .chains = {}}}, 40)) {
    table_.trials.clear();
    table_.trial.clear();
    Random random(3);
    ErrorModel displaced = robot_.model;
    for (Marker& marker : displaced.markers) {
      marker.p_link_marker += random.NormalVector(3, 0.02);
    }
    Geometry geometry = ApplyErrors(displaced, Eigen::VectorXd::Zero(displaced.parameter_count()));
    PlaceWaist(Transform(Eigen::Translation3d(2.0, 1.0, -0.3)) * RotZ(1.0) * RotX(0.5),
               Vector6d::Zero(), geometry);
    for (int i = 0; i < table_.posture_count(); ++i) {
      table_.q.row(i) = 0.8 * RandomPosture(robot_.biped.tree, random).transpose();
      table_.markers.row(i) =
          MarkerPositions(displaced, geometry, table_.q.row(i).transpose()).reshaped().transpose();
    }
  }

  double Misfit() const { return PlacedMisfit(robot_.model, table_); }

  const StandingBiped robot_ = {};
  Recording table_;
};

TEST_F(PlacedMisfitTest, PlacesTheRootAndTheMarkers) {
  EXPECT_LT(Misfit(), 2e-3);  // the markers are displaced by 35 mm
  table_.q.col(3) *= -1.0;
  EXPECT_GT(Misfit(), 0.02);
}

TEST_F(PlacedMisfitTest, SingleSightingsDoNotCount) {
  const double before = Misfit();
  for (int i = 0; i < 40; i += 5) table_.markers.block<1, 3>(i, 6).array() += 0.5;
  table_.markers.block<5, 3>(10, 9).setConstant(std::nan(""));
  EXPECT_LT(Misfit(), before + 0.01);
}

TEST_F(PlacedMisfitTest, AFreeRootStandsAnywhere) {
  Random random(4);
  for (int i = 0; i < table_.posture_count(); ++i) {
    const Eigen::Vector3d shift = random.NormalVector(3, 0.5);
    for (int m = 0; m < table_.marker_count(); ++m) {
      table_.markers.block<1, 3>(i, 3 * m) += shift.transpose();
    }
  }
  EXPECT_GT(Misfit(), 0.1);
  table_.free_root = true;
  EXPECT_LT(Misfit(), 5e-3);
}

}  // namespace
}  // namespace elastocal
