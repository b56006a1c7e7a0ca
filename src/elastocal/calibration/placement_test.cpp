// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/placement.hpp"

#include <gtest/gtest.h>

#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

class FootingsTest : public testing::Test {
 protected:
  /// Moves the markers of a cluster along x, from the given posture to the last one.
  void Shift(const std::string& cluster, int posture, double by, Recording& recording) const {
    for (int m = 0; m < robot_.model.marker_count(); ++m) {
      if (!robot_.model.markers[m].name.starts_with(cluster)) continue;
      recording.markers.col(3 * m).tail(recording.posture_count() - posture).array() += by;
    }
  }

  const StandingBiped robot_ = {};
};

TEST_F(FootingsTest, OneForEachTrialOnOneLegOrWithItsRootHeld) {
  const Recording recording =
      robot_.Empty({{.name = "both", .chains = {}, .support = {robot_.left, robot_.right}},
                    {.name = "left", .chains = {}, .support = {robot_.left}},
                    {.name = "held", .chains = {}},
                    {.name = "free", .chains = {}, .support = {}, .free_root = true}},
                   2);
  const std::vector<Footing> footings = FindFootings(robot_.model, recording, 1e-3);
  ASSERT_EQ(footings.size(), 2u);
  EXPECT_EQ(footings[0].trial, 1);
  EXPECT_EQ(footings[0].leg, 0);
  EXPECT_EQ(footings[0].postures, (std::vector<int>{2, 3}));
  EXPECT_EQ(footings[1].trial, 2);
  EXPECT_EQ(footings[1].leg, -1);
  EXPECT_EQ(footings[1].postures, (std::vector<int>{4, 5}));
}

TEST_F(FootingsTest, ASlipOfTheStandingFootBeginsAnother) {
  Recording recording = robot_.Empty({{.name = "left", .chains = {}, .support = {robot_.left}}}, 6);
  Shift("LFOOT", 2, 3e-3, recording);
  Shift("LFOOT", 5, 0.9e-3, recording);  // less than the threshold
  Shift("RFOOT", 1, 0.1, recording);     // this foot swings
  std::vector<Slip> slips;
  const std::vector<Footing> footings = FindFootings(robot_.model, recording, 1e-3, &slips);
  ASSERT_EQ(footings.size(), 2u);
  EXPECT_EQ(footings[0].postures, (std::vector<int>{0, 1}));
  EXPECT_EQ(footings[1].postures, (std::vector<int>{2, 3, 4, 5}));
  ASSERT_EQ(slips.size(), 1u);
  EXPECT_EQ(slips[0].posture, 2);
  EXPECT_NEAR(slips[0].distance, 3e-3, 1e-15);
}

TEST_F(FootingsTest, ASlipOfTheHeldRootBeginsAnother) {
  Recording recording = robot_.Empty({{.name = "held", .chains = {}}}, 4);
  Shift("WAIST", 2, 3e-3, recording);
  Shift("LFOOT", 1, 0.1, recording);
  std::vector<Slip> slips;
  const std::vector<Footing> footings = FindFootings(robot_.model, recording, 1e-3, &slips);
  ASSERT_EQ(footings.size(), 2u);
  EXPECT_EQ(footings[1].postures, (std::vector<int>{2, 3}));
  ASSERT_EQ(slips.size(), 1u);
  EXPECT_EQ(slips[0].leg, -1);
}

}  // namespace
}  // namespace elastocal
