// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/cause_search.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

constexpr int kPostures = 80, kRows = 36;

/// A study of one unknown and three causes that displace the first row of each posture: the first
/// by x, its twin by nearly x, the third by something else. The residuals are noise plus `size`
/// times x.
LinearStudy MakeStudy(double size) {
  LinearStudy study;
  study.base = 1;
  study.corrections = {0, 1, 2};
  study.scale = {1.0, 1.0, 1.0};
  study.causes = {"cause", "twin", "other"};
  study.of_cause = {{0}, {1}, {2}};
  study.other = Eigen::MatrixXd::Identity(4, 4);
  study.other_gradient.setZero(4);
  study.degrees_of_freedom = kPostures * kRows - 1;
  Random random(3);
  for (int i = 0; i < kPostures; ++i) {
    LinearStudy::Posture posture;
    posture.residual = random.NormalVector(kRows, 1.0);
    posture.jacobian.setZero(kRows, 4);
    posture.jacobian.col(0).setOnes();
    const double x = random.Normal(1.0);
    posture.jacobian(0, 1) = x;
    posture.jacobian(0, 2) = x + random.Normal(0.1);
    posture.jacobian(0, 3) = random.Normal(1.0);
    posture.residual[0] -= size * x;
    posture.to_metres.setOnes(kRows);
    posture.markers = kRows;
    study.postures.push_back(std::move(posture));
  }
  return study;
}

TEST(SearchCauses, TakesOneOfWhichNoiseHidesMostOfTheGain) {
  const CauseSearch search = SearchCauses(MakeStudy(0.9));
  ASSERT_TRUE(search.accepted);
  ASSERT_EQ(search.chosen.size(), 1u);
  const CauseFinding& finding = search.chosen[0];
  // Each posture has 36 rows of noise, and one of them has an additional error of 0.9, which is
  // about a hundredth of the whole error.
  EXPECT_GT(finding.mean_gain, finding.gain_sd);
  EXPECT_LT(finding.mean_gain, 0.02 * search.error);
}

TEST(SearchCauses, NamesWhatExplainsAlmostAsMuch) {
  const CauseSearch search = SearchCauses(MakeStudy(0.9));
  ASSERT_EQ(search.chosen.size(), 1u);
  const bool first = search.chosen[0].cause == "cause";
  const std::vector<std::string> expected = {first ? "twin" : "cause"};
  EXPECT_EQ(search.chosen[0].rivals, expected);
}

// The gain is significant but may be due to chance: it is larger than its standard error, but
// smaller than twice that.
TEST(SearchCauses, TakesNothingOfWhichTheGainIsDoubtful) {
  const CauseSearch search = SearchCauses(MakeStudy(0.45));
  EXPECT_LT(search.findings[0].p_adjusted, 0.05);
  EXPECT_GT(search.findings[0].mean_gain, search.findings[0].gain_sd);
  EXPECT_FALSE(search.accepted);
}

TEST(SearchCauses, TakesNothingFromNoise) {
  EXPECT_TRUE(SearchCauses(MakeStudy(0.0)).chosen.empty());
}

}  // namespace
}  // namespace elastocal
