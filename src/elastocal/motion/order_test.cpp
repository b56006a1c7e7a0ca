// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/order.hpp"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"

namespace elastocal {
namespace {

std::vector<Eigen::VectorXd> RandomPostures(int count, Random& random) {
  std::vector<Eigen::VectorXd> postures;
  for (int i = 0; i < count; ++i) postures.push_back(random.NormalVector(6, 0.5));
  return postures;
}

/// Length of the shortest tour, by dynamic programming over the subsets visited (Held and Karp).
double ShortestTour(const Eigen::VectorXd& start, const std::vector<Eigen::VectorXd>& postures) {
  const std::size_t count = postures.size(), subsets = std::size_t{1} << count;
  std::vector<std::vector<double>> cost(
      subsets, std::vector<double>(count, std::numeric_limits<double>::infinity()));
  for (std::size_t i = 0; i < count; ++i) {
    cost[std::size_t{1} << i][i] = (postures[i] - start).norm();
  }
  for (std::size_t set = 1; set < subsets; ++set) {
    for (std::size_t last = 0; last < count; ++last) {
      for (std::size_t next = 0; next < count; ++next) {
        if ((set >> next) & 1u) continue;
        double& reached = cost[set | (std::size_t{1} << next)][next];
        reached = std::min(reached, cost[set][last] + (postures[next] - postures[last]).norm());
      }
    }
  }
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t last = 0; last < count; ++last) {
    shortest = std::min(shortest, cost[subsets - 1][last] + (postures[last] - start).norm());
  }
  return shortest;
}

TEST(OrderPostures, WalksALineInOrder) {
  std::vector<Eigen::VectorXd> postures;
  for (const double x : {3.0, 1.0, 4.0, 2.0})
    postures.emplace_back(Eigen::VectorXd::Constant(1, x));
  const auto order = OrderPostures(Eigen::VectorXd::Zero(1), postures);
  EXPECT_NEAR(TourLength(Eigen::VectorXd::Zero(1), postures, order), 8.0, 1e-14);  // out and back
}

TEST(OrderPostures, VisitsEachOnce) {
  Random random(1);
  for (const int count : {0, 1, 2, 40}) {
    const auto postures = RandomPostures(count, random);
    std::vector<int> order = OrderPostures(Eigen::VectorXd::Zero(6), postures);
    std::sort(order.begin(), order.end());
    ASSERT_EQ(static_cast<int>(order.size()), count);
    for (int i = 0; i < count; ++i) EXPECT_EQ(order[static_cast<std::size_t>(i)], i);
  }
}

TEST(OrderPostures, IsNearTheShortestTour) {
  // Local search need not find the optimum; it mostly does, and is never far from it.
  Random random(2);
  int optimal = 0;
  for (int i = 0; i < 20; ++i) {
    const auto postures = RandomPostures(11, random);
    const Eigen::VectorXd start = random.NormalVector(6, 0.5);
    const double shortest = ShortestTour(start, postures);
    const double found = TourLength(start, postures, OrderPostures(start, postures));
    EXPECT_GE(found, shortest - 1e-12);
    EXPECT_LE(found, 1.02 * shortest);
    optimal += found < shortest + 1e-9 ? 1 : 0;
  }
  EXPECT_GE(optimal, 15);
}

}  // namespace
}  // namespace elastocal
