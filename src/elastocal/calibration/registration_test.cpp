// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/registration.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

Recording RecordFrom(const ErrorModel& model, int postures) {
  Random random(1);
  Recording recording;
  for (const Marker& marker : model.markers) recording.marker_names.push_back(marker.name);
  recording.q.resize(postures, model.tree.coordinate_count());
  recording.markers.resize(postures, 3 * model.marker_count());
  const Geometry geometry = ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
  for (int i = 0; i < postures; ++i) {
    recording.q.row(i) = RandomPosture(model.tree, random);
    recording.markers.row(i) =
        MarkerPositions(model, geometry, recording.q.row(i).transpose()).reshaped().transpose();
  }
  return recording;
}

TEST(Registration, FindsTheWaistOfANominalRobot) {
  ErrorModel model = TalosLegModel();
  const ErrorModel nominal = model;
  model.T_ref_waist = FromXyzRpy({3.0, -2.0, 1.0}, {2.0, -1.0, 3.0});
  Recording recording = RecordFrom(model, 5);
  recording.markers.block<1, 3>(1, 6).setConstant(std::numeric_limits<double>::quiet_NaN());
  const Transform found = RegisterWaist(nominal, recording);
  EXPECT_LT((found.matrix() - model.T_ref_waist.matrix()).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Registration, FindsTheWaistOfEachPostureThatShowsThreeMarkers) {
  ErrorModel model = TalosLegModel();
  const ErrorModel nominal = model;
  model.T_ref_waist = FromXyzRpy({3.0, -2.0, 1.0}, {2.0, -1.0, 3.0});
  Recording recording = RecordFrom(model, 3);
  const Transform moved = FromXyzRpy({0.5, 0.0, 0.0}, {0.0, 0.0, 0.7});
  for (int m = 0; m < model.marker_count(); ++m) {
    recording.markers.block<1, 3>(2, 3 * m) = (moved * MarkerPosition(recording, 2, m)).transpose();
  }
  recording.markers.row(1)
      .tail(3 * (model.marker_count() - 2))
      .setConstant(std::numeric_limits<double>::quiet_NaN());
  const auto found = RegisterWaistByPosture(nominal, recording);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_FALSE(found[1]);
  ASSERT_TRUE(found[0] && found[2]);
  EXPECT_TRUE(found[0]->isApprox(model.T_ref_waist, 1e-12));
  EXPECT_TRUE(found[2]->isApprox(moved * model.T_ref_waist, 1e-12));
}

TEST(Registration, MirrorsNothingForPointsInAPlane) {
  // Markers of a planar arm lie in a plane, which a reflection would fit as well as a rotation.
  RobotTree arm = PlanarArm();
  ErrorModel model = MakeErrorModel(arm, {{"A", 2, {0.3, 0.0, 0.0}}, {"B", 1, {0.2, 0.1, 0.0}}});
  const ErrorModel nominal = model;
  model.T_ref_waist = FromXyzRpy({0.1, 0.2, 0.3}, {0.4, 0.5, 0.6});
  const Transform found = RegisterWaist(nominal, RecordFrom(model, 6));
  EXPECT_NEAR(found.linear().determinant(), 1.0, 1e-12);
  EXPECT_LT((found.matrix() - model.T_ref_waist.matrix()).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace elastocal
