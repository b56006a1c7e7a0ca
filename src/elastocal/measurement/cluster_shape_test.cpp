// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/cluster_shape.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

TEST(PairColumn, NumbersThePairsInOrder) {
  int column = 0;
  for (int i = 0; i < 5; ++i) {
    for (int j = i + 1; j < 5; ++j, ++column) {
      EXPECT_EQ(PairColumn(i, j, 5), column);
      EXPECT_EQ(PairColumn(j, i, 5), column);
    }
  }
}

TEST(MeasureDistances, GivesThePairsAndNanForHiddenMarkers) {
  MarkerTrajectories trajectories;
  trajectories.names = {"a", "b", "c"};
  trajectories.positions.resize(2, 9);
  trajectories.positions << 0, 0, 0, 3, 4, 0, 0, 0, 2,  //
      0, 0, 0, 1, 0, 0, 0, 0, 0;
  trajectories.positions.block<1, 3>(1, 6).setConstant(std::numeric_limits<double>::quiet_NaN());
  const DistanceTable table = MeasureDistances(trajectories, {0, 1, 2});
  EXPECT_DOUBLE_EQ(table(0, 0), 5.0);
  EXPECT_DOUBLE_EQ(table(0, 1), 2.0);
  EXPECT_DOUBLE_EQ(table(0, 2), std::sqrt(29.0));
  EXPECT_DOUBLE_EQ(table(1, 0), 1.0);
  EXPECT_TRUE(std::isnan(table(1, 1)) && std::isnan(table(1, 2)));
  // Another order of markers gives another order of columns.
  EXPECT_DOUBLE_EQ(MeasureDistances(trajectories, {2, 0, 1})(0, 0), 2.0);
}

// Distances of 3, 4 and 5 cm with noise of 0.1 mm.
DistanceTable NoisyTriangle(int frames) {
  Random random(4);
  DistanceTable table(frames, 3);
  for (int frame = 0; frame < frames; ++frame) {
    for (int pair = 0; pair < 3; ++pair)
      table(frame, pair) = 0.03 + 0.01 * pair + random.Normal(1e-4);
  }
  return table;
}

TEST(MeasureShape, FindsDistancesTolerancesAndSeparation) {
  const ClusterShape shape = MeasureShape(NoisyTriangle(3000), 3, 6.0, 1e-6);
  EXPECT_EQ(shape.permutations.size(), 6u);
  for (int pair = 0; pair < 3; ++pair) {
    EXPECT_NEAR(shape.distances[pair], 0.03 + 0.01 * pair, 1e-5);  // 5 standard deviations
    EXPECT_NEAR(shape.tolerances[pair], 6e-4, 0.6e-4);
  }
  EXPECT_NEAR(shape.separation, 0.01 / 6e-4, 2.0);  // any exchange changes two distances by 1 cm
  EXPECT_EQ(MeasureShape(NoisyTriangle(100), 3, 6.0, 0.002).tolerances[0], 0.002);
}

TEST(MeasureShape, TakesTheDistanceOfTheLongerPart) {
  DistanceTable table = NoisyTriangle(3000);
  table.col(0).tail(1400).array() += 0.005;  // the median of all is at the edge of the first part
  const ClusterShape shape = MeasureShape(table, 3, 6.0, 1e-6);
  EXPECT_NEAR(shape.distances[0], 0.03, 1e-5);
  EXPECT_NEAR(shape.tolerances[0], 6e-4, 0.6e-4);
}

TEST(MeasureShape, SeesNoSeparationInAnIsoscelesTriangle) {
  DistanceTable table = NoisyTriangle(1000);
  table.col(1).array() -= 0.01;
  EXPECT_LT(MeasureShape(table, 3, 6.0, 1e-6).separation, 0.1);
}

TEST(ClusterShape, FitsUnderTheRightOrderOnly) {
  const ClusterShape shape = MeasureShape(NoisyTriangle(1000), 3, 6.0, 1e-6);
  const Eigen::RowVector3d exchanged(0.03, 0.05, 0.04);  // labels 0 and 1 are exchanged
  EXPECT_FALSE(shape.Fits(exchanged, {0, 1, 2}));
  EXPECT_TRUE(shape.Fits(exchanged, {1, 0, 2}));
  EXPECT_FALSE(shape.Fits(exchanged, {2, 1, 0}));
  EXPECT_TRUE(shape.Fits(exchanged, {0, 1, 2}, 2));  // the distance between 0 and 1 still fits
  EXPECT_FALSE(shape.Fits(exchanged, {0, 1, 2}, 1));
}

}  // namespace
}  // namespace elastocal
