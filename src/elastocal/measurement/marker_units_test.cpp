// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/marker_units.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

/// Three markers of a link that moves about 2 m from the cameras' origin, and two of another link.
class MarkerUnits : public testing::Test {
 protected:
  MarkerUnits() : positions_(20, 15) {
    for (int i = 0; i < 20; ++i) {
      for (int m = 0; m < 5; ++m) {
        const Eigen::Vector3d at(1.5 + 0.3 * std::sin(i), 1.0, 0.8 - 0.2 * std::cos(2 * i));
        positions_.block<1, 3>(i, 3 * m) = (at + robot_[m].p_link_marker).transpose();
      }
    }
  }

  std::vector<Marker> robot_ = {{"A_1", 0, {0.0, 0.0, 0.0}},
                                {"A_2", 0, {0.06, 0.0, 0.0}},
                                {"A_3", 0, {0.0, 0.09, 0.02}},
                                {"B_1", 1, {0.3, 0.0, 0.0}},
                                {"B_2", 1, {0.3, 0.0, 0.1}}};
  std::vector<std::string> names_ = {"A_1", "A_2", "A_3", "B_1", "B_2"};
  Eigen::MatrixXd positions_;
};

TEST_F(MarkerUnits, AMarkerInMetresAmongMillimetresIsNamed) {
  positions_.middleCols<3>(3) *= 1e-3;
  positions_.row(4).setConstant(std::nan(""));
  const auto found = FindOtherUnit(positions_, names_, robot_);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->marker, "A_2");
  EXPECT_DOUBLE_EQ(found->factor, 1000.0);
  EXPECT_NE(Describe(*found).find("A_2: its coordinates are 1000 times too small"),
            std::string::npos);
}

TEST_F(MarkerUnits, AMarkerThatIsTooFarIsNamed) {
  positions_.middleCols<3>(6) *= 10.0;
  const auto found = FindOtherUnit(positions_, names_, robot_);
  ASSERT_TRUE(found);
  EXPECT_NE(Describe(*found).find("A_3: its coordinates are 10 times too large"),
            std::string::npos);
}

TEST_F(MarkerUnits, AllInAnotherUnitAreNamed) {
  positions_ *= 1e-3;  // values in metres, read as millimetres
  const auto found = FindOtherUnit(positions_, names_, robot_);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->marker.empty());
  EXPECT_DOUBLE_EQ(found->factor, 1000.0);
  EXPECT_EQ(Describe(*found).find("all positions are 1000 times too small: two markers of one link "
                                  "are 0.06 mm apart, where the project has 60 mm"),
            0U);
  // A project that draws its clusters half as large has no other unit.
  for (Marker& marker : robot_) marker.p_link_marker *= 0.5;
  EXPECT_FALSE(FindOtherUnit(1e3 * positions_, names_, robot_));
}

TEST_F(MarkerUnits, SoundMarkersExchangedOnesAndThoseOfAnotherPlaceAreNot) {
  EXPECT_FALSE(FindOtherUnit(positions_, names_, robot_));
  Eigen::MatrixXd exchanged = positions_;
  exchanged.middleCols<3>(3).swap(exchanged.middleCols<3>(9));
  EXPECT_FALSE(FindOtherUnit(exchanged, names_, robot_));
  Eigen::MatrixXd zero = positions_;
  zero.middleCols<3>(3).setZero();  // some trackers write zeros for unseen markers
  EXPECT_FALSE(FindOtherUnit(zero, names_, robot_));
  positions_.middleCols<3>(9) *= 1e-3;  // one other marker on the link is not enough
  EXPECT_FALSE(FindOtherUnit(positions_, names_, robot_));
}

}  // namespace
}  // namespace elastocal
