// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/touches_in_the_air.hpp"

#include <gtest/gtest.h>

#include "elastocal/mistakes/observed_conventions.hpp"
#include "elastocal/mistakes/observed_mistakes.hpp"
#include "elastocal/mistakes/two_tables.hpp"
#include "elastocal/pipeline/leave_out_touches.hpp"
#include "tests/touching_biped.hpp"

namespace elastocal {
namespace {

const Eigen::Vector3d kNoiseOfTouches(0.5e-3, 1e-3, 1e-3);  // m, rad

/// Heights over the table of 40 touches. One in `every` is 5 to 40 mm in the air.
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
      // 26 touches of a robot with 50 unknowns predict others to some mm.
      EXPECT_NEAR(one.height, above[static_cast<std::size_t>(one.observation)], 5e-3);
    }
    EXPECT_EQ(of_found, expected);
    EXPECT_EQ(WithoutTouches(seen, found).count(), 40 - static_cast<int>(expected.size()));
  }
}

// A few touches are left out with a warning. Many of one plate are an objection, even if they are
// few among all.
TEST(TouchesInTheAir, AreLeftOutOrObjectedTo) {
  ContactRun few;
  few.model = MakeTouchingBiped();
  Random random(31);
  const ObservedValues truth = RandomTruth(few.model, 1, random);
  std::vector<double> above(20, 0.0);  // the plates alternate
  above[4] = above[9] = 0.02;
  few.observations = SimulateTouches(few.model, truth, 40, 1, kNoiseOfTouches, random, above);
  EXPECT_TRUE(LeaveOutTouchesInTheAir(few));
  EXPECT_EQ(few.wrong_rows, "");
  EXPECT_EQ(few.observations.count(), 38);
  ASSERT_EQ(few.warnings.size(), 1u);
  EXPECT_EQ(few.warnings[0].find("2 of 40 touches seem to be none: "), 0u) << few.warnings[0];
  EXPECT_NE(few.warnings[0].find("synthetic:6, 11"), std::string::npos) << few.warnings[0];

  ContactRun many;
  many.model = few.model;
  for (std::size_t i = 0; i < 14; i += 2) above[i] = 0.02;
  many.observations = SimulateTouches(many.model, truth, 40, 1, kNoiseOfTouches, random, above);
  EXPECT_TRUE(LeaveOutTouchesInTheAir(many));
  EXPECT_EQ(many.wrong_rows.find("8 of 40 touches seem to be none: "), 0u) << many.wrong_rows;
  EXPECT_NE(many.wrong_rows.find("all as high"), std::string::npos) << many.wrong_rows;
}

TEST(ObservedMistakes, APlateUpsideDownIsNamed) {
  const ObservedRobot model = MakeTouchingBiped();
  Random random(5);
  const Observations seen =
      SimulateTouches(model, RandomTruth(model, 1, random), 20, 1, kNoiseOfTouches, random);
  const MeasuredBy left{"flush contact", "left"};
  const ObservedRobot reversed = *WrittenConventions(model, seen, left).front().robot;
  const std::vector<std::string> found = FindObservedMistakes(reversed, seen);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0],
            "the normal of plates points into the table (left alone): out of the table was "
            "expected");
}

// The nominal robot tells two tables of one plate apart if they differ by tens of millimetres.
TEST(ObservedMistakes, TwoTablesOfOnePlateAreNamed) {
  const ObservedRobot model = MakeTouchingBiped();
  Random random(5);
  const ObservedValues truth = RandomTruth(model, 1, random);
  std::vector<double> above(40, 0.0);  // the plates alternate
  for (std::size_t i = 20; i < 40; i += 2) above[i] = 0.15;
  const Observations two = SimulateTouches(model, truth, 40, 1, kNoiseOfTouches, random, above);
  const std::vector<std::string> found = FindObservedMistakes(model, two);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].find("plate 'left' touches two tables in synthetic: 10 touches (lines 22, 24"),
            0u)
      << found[0];
  const Observations one = SimulateTouches(model, truth, 40, 1, kNoiseOfTouches, random);
  EXPECT_TRUE(FindTwoTables(model, one).empty());
}

// Larger noise, or errors of geometry because joints give way, have both signs.
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
