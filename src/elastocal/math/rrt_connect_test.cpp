// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/rrt_connect.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

/// Two rooms of 2 m x 2 m with a wall between them at x = 0. The wall is 0.2 m thick and has a door
/// of the given width at its upper end.
FreeSpace Rooms(double door) {
  FreeSpace space;
  space.lower = Eigen::Vector2d(-2.0, 0.0);
  space.upper = Eigen::Vector2d(2.0, 2.0);
  space.free = [door](const Eigen::VectorXd& x) {
    return std::abs(x[0]) > 0.1 || x[1] > 2.0 - door;
  };
  return space;
}

const Eigen::Vector2d kHere(-1.0, 0.5), kThere(1.0, 0.5);

TEST(ConnectByTrees, GoesThroughTheDoor) {
  const FreeSpace rooms = Rooms(0.3);
  EXPECT_FALSE(StraightWayIsFree(rooms, kHere, kThere));
  const auto corners = ConnectByTrees(rooms, kHere, kThere);
  ASSERT_TRUE(corners);
  EXPECT_EQ(corners->row(0).transpose(), kHere);
  EXPECT_EQ(corners->bottomRows<1>().transpose(), kThere);
  double length = 0.0;
  for (Eigen::Index i = 0; i + 1 < corners->rows(); ++i) {
    const Eigen::Vector2d a = corners->row(i).transpose(), b = corners->row(i + 1).transpose();
    EXPECT_TRUE(StraightWayIsFree(rooms, a, b)) << i;
    length += (b - a).norm();
  }
  // The shortest path is 3.20 m long. Unneeded corners are cut off.
  EXPECT_LT(length, 5.0);
  EXPECT_LE(corners->rows(), 6);
  EXPECT_EQ(ConnectByTrees(rooms, kHere, kThere), corners);
}

TEST(ConnectByTrees, FindsNothingWhereNothingIs) {
  EXPECT_FALSE(ConnectByTrees(Rooms(0.0), kHere, kThere));
  // In free space only the straight path remains.
  FreeSpace open = Rooms(0.0);
  open.free = [](const Eigen::VectorXd&) { return true; };
  EXPECT_EQ(ConnectByTrees(open, kHere, kThere)->rows(), 2);
}

TEST(ReachableSpace, IsTheRoomsThatADoorJoins) {
  const ReachableSpace joined(Rooms(0.3), kHere), closed(Rooms(0.0), kHere);
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    Eigen::Vector2d x;
    x[0] = random.Uniform(-2.0, 2.0);
    x[1] = random.Uniform(0.0, 2.0);
    if (!Rooms(0.0).free(x)) continue;  // inside the wall or the door
    EXPECT_TRUE(joined.Reaches(x)) << x.transpose();
    EXPECT_EQ(closed.Reaches(x), x[0] < 0.0) << x.transpose();
  }
}

TEST(AlongPolygon, IsAtEqualDistances) {
  Eigen::MatrixXd corners(4, 2);
  corners << 0, 0, 3, 0, 3, 0, 3, 1;  // one corner occurs twice
  Eigen::MatrixXd wanted(3, 2);
  wanted << 1, 0, 2, 0, 3, 0;
  EXPECT_LT((AlongPolygon(corners, 3) - wanted).norm(), 1e-12);
}

}  // namespace
}  // namespace elastocal
