// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/touches_in_the_air.hpp"

#include <gtest/gtest.h>

#include "tests/touching_biped.hpp"

namespace elastocal {
namespace {

const Eigen::Vector3d kNoiseOfTouches(0.5e-3, 1e-3, 1e-3);  // m, rad

/// Heights over the table of 40 touches of which one in `every` is in the air, 5 to 40 mm.
std::vector<double> OneInAir(int every, Random& random) {
  std::vector<double> above(40, 0.0);
  for (std::size_t i = 0; i < above.size(); i += static_cast<std::size_t>(every)) {
    above[i] = random.Uniform(5e-3, 40e-3);
  }
  return above;
}

TEST(TouchesInTheAir, AreFoundEach) {
  const ObservedRobot model = MakeTouchingBiped();
  for (const int every : {7, 3}) {
    SCOPED_TRACE(every);
    Random random(31);
    const ObservedValues truth = RandomTruth(model, 1, random);
    const std::vector<double> above = OneInAir(every, random);
    const Observations seen = SimulateTouches(model, truth, 40, 1, kNoiseOfTouches, random, above);
    const std::vector<TouchInTheAir> found = FindTouchesInTheAir(model, seen);
    std::vector<int> expected, of_found;
    for (int i = 0; i < 40; ++i) {
      if (above[static_cast<std::size_t>(i)] > 0.0) expected.push_back(i);
    }
    for (const TouchInTheAir& one : found) {
      of_found.push_back(one.observation);
      // Some mm: what 26 touches of a robot with 50 unknowns predict of others.
      EXPECT_NEAR(one.height, above[static_cast<std::size_t>(one.observation)], 5e-3);
    }
    EXPECT_EQ(of_found, expected);
    EXPECT_EQ(WithoutTouches(seen, found).count(), 40 - static_cast<int>(expected.size()));
  }
}

// Noise that is larger, or that the geometry leaves because joints give way, lies on both sides.
TEST(TouchesInTheAir, AreNoneWhereAllAreOnTheTable) {
  const ObservedRobot model = MakeTouchingBiped();
  for (const double height : {3e-3, 10e-3}) {
    Random random(1);
    const ObservedValues truth = RandomTruth(model, 1, random);
    const Observations seen = SimulateTouches(model, truth, 40, 1, {height, 1e-3, 1e-3}, random);
    EXPECT_TRUE(FindTouchesInTheAir(model, seen).empty()) << height << " m";
  }
}

}  // namespace
}  // namespace elastocal
