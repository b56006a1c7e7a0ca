// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/session_shapes.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

/// A trial in which the three markers of a wrist have these distances, m.
TrialSummary Wrist(double ab, double ac, double bc) {
  TrialSummary trial;
  trial.markers = {"a", "b", "c"};
  ClusterLabels labels;
  labels.name = "wrist";
  labels.markers = {0, 1, 2};
  labels.distances = Eigen::Vector3d(ab, ac, bc);
  labels.tolerances = Eigen::Vector3d::Constant(0.0015);
  trial.labels = {labels};
  return trial;
}

TEST(UsualDistances, MostTrialsTellThem) {
  const TrialSummary knocked = Wrist(0.068, 0.085, 0.0712);
  const PairDistances usual =
      UsualDistances({knocked, Wrist(0.0601, 0.085, 0.071), Wrist(0.0599, 0.0851, 0.071)}, {});
  EXPECT_NEAR(usual.at({"a", "b"}), 0.06, 2e-4);
  EXPECT_NEAR(usual.at({"b", "c"}), 0.071, 2e-4);
  EXPECT_TRUE(DiffersFromUsual(knocked, usual));
  EXPECT_FALSE(DiffersFromUsual(Wrist(0.0609, 0.085, 0.071), usual));
  EXPECT_FALSE(DiffersFromUsual(Wrist(kNaN, 0.085, 0.071), usual));
}

TEST(UsualDistances, FewTrialsOrNoMajorityTellNothing) {
  EXPECT_TRUE(UsualDistances({Wrist(0.06, 0.085, 0.071), Wrist(0.06, 0.085, 0.071)}, {}).empty());
  const PairDistances usual = UsualDistances({Wrist(0.06, 0.085, 0.071), Wrist(0.06, 0.085, 0.08),
                                              Wrist(0.066, 0.085, 0.09), Wrist(0.066, 0.085, 0.1)},
                                             {});
  EXPECT_FALSE(usual.contains({"a", "b"}));
  EXPECT_FALSE(usual.contains({"b", "c"}));
  EXPECT_TRUE(usual.contains({"a", "c"}));
}

TEST(UsualDistances, WhereTrialsDoNotAgreeTheProjectDecidesIfItIsClear) {
  const std::vector<TrialSummary> trials = {Wrist(0.06, 0.085, 0.071), Wrist(0.06, 0.071, 0.085)};
  const PairDistances rough = {{{"a", "c"}, 0.088}, {{"b", "c"}, 0.068}, {{"a", "b"}, 0.065}};
  const PairDistances usual = UsualDistances(trials, rough);
  EXPECT_DOUBLE_EQ(usual.at({"a", "b"}), 0.06);
  EXPECT_DOUBLE_EQ(usual.at({"a", "c"}), 0.085);
  EXPECT_DOUBLE_EQ(usual.at({"b", "c"}), 0.071);
  EXPECT_FALSE(DiffersFromUsual(trials[0], usual));
  EXPECT_TRUE(DiffersFromUsual(trials[1], usual));
  EXPECT_FALSE(UsualDistances(trials, {{{"a", "c"}, 0.08}}).contains({"a", "c"}));
}

}  // namespace
}  // namespace elastocal
