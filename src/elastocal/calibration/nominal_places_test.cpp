// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/nominal_places.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

/// The biped with each cluster displaced along the axes of its link. These displacements are then
/// estimated.
class NominalPlacesTest : public testing::Test {
 protected:
  NominalPlacesTest() {
    result_.model = robot_.model;
    result_.delta.setZero(robot_.model.parameter_count());
    for (int i = 0; i < robot_.model.parameter_count(); ++i) {
      if (robot_.model.parameters[static_cast<std::size_t>(i)].kind != ParameterKind::kMarker) {
        continue;
      }
      result_.posterior.parameters.push_back(i);
    }
    const auto count = static_cast<Eigen::Index>(result_.posterior.parameters.size());
    result_.posterior.covariance = 1e-8 * Eigen::MatrixXd::Identity(count, count);
  }

  /// Displaces every coordinate of every marker independently.
  void Scatter(double sd, std::uint64_t seed) {
    Random random(seed);
    for (int i : result_.posterior.parameters) result_.delta[i] += random.Normal(sd);
  }

  std::string NameOf(int parameter) const {
    return robot_.model.parameters[static_cast<std::size_t>(parameter)].name;
  }

  const StandingBiped robot_ = {};
  CalibrationResult result_;
};

TEST_F(NominalPlacesTest, AreAsFarOffAsTheirClustersAreDisplaced) {
  double squares = 0.0;
  constexpr int kRobots = 5;
  for (int seed = 1; seed <= kRobots; ++seed) {
    result_.delta.setZero();
    Scatter(3e-3, static_cast<std::uint64_t>(seed));
    const NominalPlaces places = AssessNominalPlaces(result_);
    EXPECT_TRUE(places.told()) << places.directions;
    EXPECT_NEAR(places.sd, 3e-3, 3.0 * 3e-3 / std::sqrt(2.0 * places.directions));
    squares += places.sd * places.sd / kRobots;
  }
  EXPECT_NEAR(std::sqrt(squares), 3e-3, 0.4e-3);
}

// The markers of a plate are where they were drawn on the plate, even if the plate is fixed
// elsewhere.
TEST_F(NominalPlacesTest, TheShapeOfAClusterTellsNothing) {
  for (int i : result_.posterior.parameters) {
    if (NameOf(i).ends_with(".x")) result_.delta[i] = 20e-3;
  }
  const NominalPlaces places = AssessNominalPlaces(result_);
  // Independent errors of this size would displace a cluster by 20 mm along one of three axes, and
  // turn it about none of three.
  EXPECT_NEAR(places.sd, 20e-3 * std::sqrt(3.0 / 6.0), 1e-5);
}

TEST_F(NominalPlacesTest, DirectionsThatNothingTellsDoNotCount) {
  Scatter(3e-3, 1);
  const NominalPlaces all = AssessNominalPlaces(result_);
  for (std::size_t k = 0; k < result_.posterior.parameters.size(); ++k) {
    const int i = result_.posterior.parameters[k];
    if (!NameOf(i).ends_with(".z")) continue;
    const auto row = static_cast<Eigen::Index>(k);
    result_.delta[i] = 0.5;
    result_.posterior.covariance(row, row) = 1.0;
  }
  const NominalPlaces some = AssessNominalPlaces(result_);
  EXPECT_LT(some.directions, 0.8 * all.directions);
  EXPECT_NEAR(some.sd, all.sd, 1.5e-3);
}

TEST_F(NominalPlacesTest, OfNoClustersNothingIsTold) {
  result_.posterior.parameters.clear();
  result_.posterior.covariance.resize(0, 0);
  EXPECT_FALSE(AssessNominalPlaces(result_).told());
}

}  // namespace
}  // namespace elastocal
