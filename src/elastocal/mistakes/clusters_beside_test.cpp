// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/clusters_beside.hpp"

#include <gtest/gtest.h>

#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

std::vector<std::string> Beside(const std::vector<int>& coordinates,
                                const std::vector<LabelCluster>& clusters) {
  std::vector<std::string> names;
  for (const auto& one : ClustersBeside(coordinates, clusters, TalosLegModel())) {
    names.push_back(one.name);
  }
  return names;
}

using Names = std::vector<std::string>;

// Joints 3, 4 and 6 carry thigh, shank and foot.
const LabelCluster kThigh{"THIGH", {0, 1, 2}}, kShank{"SHANK", {3, 4, 5}}, kFoot{"FOOT", {6, 7, 8}};

TEST(ClustersBeside, AreOnEitherSide) {
  const std::vector<LabelCluster> all{kThigh, kShank, kFoot};
  EXPECT_EQ(Beside({5}, all), (Names{"SHANK", "FOOT"}));
  EXPECT_EQ(Beside({4}, all), (Names{"SHANK", "FOOT"}));
  EXPECT_EQ(Beside({3}, all), (Names{"THIGH", "SHANK"}));
  EXPECT_EQ(Beside({0}, all), (Names{"THIGH"}));
  EXPECT_EQ(Beside({0, 5}, all), (Names{"THIGH", "SHANK", "FOOT"}));
  EXPECT_TRUE(Beside({}, all).empty());
}

// A cluster that was not seen separates no others.
TEST(ClustersBeside, OfThoseThatWereSeen) {
  EXPECT_EQ(Beside({5}, {kThigh, kFoot}), (Names{"THIGH", "FOOT"}));
}

}  // namespace
}  // namespace elastocal
