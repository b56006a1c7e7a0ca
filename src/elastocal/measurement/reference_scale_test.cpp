// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/reference_scale.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

/// Frames of bars that lie along x, one behind the other. All lengths are multiplied by `scale`.
MarkerTrajectories SeenBars(const std::vector<ReferenceLength>& references, double scale,
                            double noise_sd, int frames, std::uint64_t seed) {
  MarkerTrajectories seen;
  seen.rate_hz = 100.0;
  Random random(seed);
  seen.positions.resize(frames, 6 * static_cast<Eigen::Index>(references.size()));
  for (std::size_t k = 0; k < references.size(); ++k) {
    for (std::size_t end = 0; end < 2; ++end) {
      seen.names.push_back("wand:" + references[k].markers[end]);
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double at = axis == 0 ? scale * static_cast<double>(end) * references[k].length
                                    : static_cast<double>(k);
        seen.positions.col(6 * static_cast<Eigen::Index>(k) + 3 * static_cast<Eigen::Index>(end) +
                           axis) = random.NormalVector(frames, noise_sd).array() + at;
      }
    }
  }
  return seen;
}

const std::vector<ReferenceLength> kBar = {{{"A", "B"}, 0.5, 2e-5}};

TEST(ReferenceScale, OfABarWithoutNoiseIsItsRatio) {
  const auto scale = MeasureScale(kBar, SeenBars(kBar, 1.004, 0.0, 50, 1));
  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->size, 0.004, 1e-12);
  EXPECT_NEAR(scale->sd, 2e-5 / 0.5, 1e-12);
  EXPECT_TRUE(IsWrong(*scale));
}

TEST(ReferenceScale, GoodCamerasAreNotAccusedAndThoseOffByATenthOfAPercentAre) {
  int missed = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    // A bar of 500 mm with a length error of one standard deviation, seen with noise of 0.2 mm.
    const double good = 1.0 + Random(seed).Normal(2e-5) / 0.5;
    EXPECT_FALSE(IsWrong(*MeasureScale(kBar, SeenBars(kBar, good, 2e-4, 600, seed))));
    missed += IsWrong(*MeasureScale(kBar, SeenBars(kBar, 1.001 * good, 2e-4, 600, seed))) ? 0 : 1;
  }
  EXPECT_EQ(missed, 0);
}

TEST(ReferenceScale, FramesWithoutAMarkerDoNotCountAndNeitherDoOutliers) {
  MarkerTrajectories seen = SeenBars(kBar, 1.002, 1e-4, 300, 3);
  seen.positions.block(0, 3, 100, 3).setConstant(std::numeric_limits<double>::quiet_NaN());
  seen.positions.block(100, 3, 40, 1).array() += 0.1;  // a wrong label for 0.4 s
  const auto scale = MeasureScale(kBar, seen);
  ASSERT_TRUE(scale);
  EXPECT_NEAR(scale->size, 0.002, 5.0 * scale->sd);
  EXPECT_LT(scale->sd, 3e-4);
  seen.positions.block(0, 3, 295, 3).setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(MeasureScale(kBar, seen)) << "fewer than ten frames";
  EXPECT_FALSE(MeasureScale({{{"A", "C"}, 0.5, 1e-5}}, seen)) << "no such marker";
}

TEST(ReferenceScale, LengthsThatContradictEachOtherAreLessCertain) {
  const std::vector<ReferenceLength> two = {{{"A", "B"}, 0.5, 2e-5}, {{"C", "D"}, 0.5, 2e-5}};
  MarkerTrajectories seen = SeenBars(two, 1.0, 0.0, 50, 1);
  const double agreed = MeasureScale(two, seen)->sd;
  EXPECT_NEAR(agreed, 2e-5 / 0.5 / std::sqrt(2.0), 1e-12);
  seen.positions.col(9).array() += 1e-3;  // moves D by 1 mm, which is 50 standard deviations
  const auto scale = MeasureScale(two, seen);
  EXPECT_NEAR(scale->size, 1e-3, 1e-9);
  EXPECT_GT(scale->sd, 20.0 * agreed);
  EXPECT_FALSE(IsWrong(*scale));
}

}  // namespace
}  // namespace elastocal
