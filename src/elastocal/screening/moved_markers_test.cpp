// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/moved_markers.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

/// Four markers on a body at another place in each of 30 postures, seen with noise of 0.2 mm.
class MovedMarkers : public testing::Test {
 protected:
  MovedMarkers() { recording_.marker_names = {"A_1", "A_2", "A_3", "A_4"}; }

  /// Finds knocks if the marker moves at posture 12.
  std::vector<Knock> Find(int marker, const Eigen::Vector3d& by) {
    Random random(1);
    Eigen::Matrix3Xd places(3, 4);
    places << 50, 0, -35, -5, 0, 40, -25, 8, 0, 10, 25, -30;
    recording_.markers.resize(30, 12);
    recording_.q = Eigen::MatrixXd::Zero(30, 1);
    for (int i = 0; i < 30; ++i) {
      const Eigen::Quaterniond turn(Eigen::Vector4d(random.NormalVector(4, 1.0)).normalized());
      Eigen::Matrix3Xd here = 1e-3 * places;
      if (i >= 12) here.col(marker) += by;
      for (int m = 0; m < 4; ++m) {
        const Eigen::Vector3d at =
            turn * here.col(m) + Eigen::Vector3d(random.NormalVector(3, 2e-4));
        recording_.markers.block<1, 3>(i, 3 * m) = at.transpose();
      }
    }
    if (exchanged_) {
      const Eigen::MatrixXd first = recording_.markers.block(12, 0, 18, 3);
      recording_.markers.block(12, 0, 18, 3) = recording_.markers.block(12, 3, 18, 3);
      recording_.markers.block(12, 3, 18, 3) = first;
    }
    return FindMovedMarkers(recording_, {{"A", {0, 1, 2, 3}}});
  }

  Recording recording_;
  bool exchanged_ = false;
};

TEST_F(MovedMarkers, TheOneWhoseDistancesChangeIsFoundWithItsPosture) {
  const std::vector<Knock> found = Find(3, {4e-3, -3e-3, 2e-3});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].markers, std::vector<int>{3});
  EXPECT_EQ(found[0].posture, 12);
  EXPECT_EQ(found[0].last_before, 11);
}

TEST_F(MovedMarkers, NoneOfACleanTableOrOfExchangedLabels) {
  EXPECT_TRUE(Find(0, {0, 0, 0}).empty());
  exchanged_ = true;
  EXPECT_TRUE(Find(0, {0, 0, 0}).empty());
}

}  // namespace
}  // namespace elastocal
