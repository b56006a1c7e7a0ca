// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/collect_alike.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

/// Elements of several kinds. One explanation fits all elements of one kind and no others.
struct Kinds {
  std::vector<int> of;
  int fits = 0;

  std::optional<std::vector<AlikeSet>> Collect(int most_fits) {
    const auto error = [&](const std::vector<std::size_t>& together) {
      ++fits;
      const int first = of[together.front()];
      return std::ranges::all_of(together, [&](std::size_t k) { return of[k] == first; }) ? 0.5 : 2;
    };
    return CollectAlike(std::vector<double>(of.size(), 0.1), 1.0, most_fits, error);
  }
};

TEST(CollectAlike, LargestSetFirst) {
  const auto sets = Kinds{{3, 1, 1, 3, 1, 2}}.Collect(100);
  ASSERT_TRUE(sets);
  ASSERT_EQ(sets->size(), 3u);
  EXPECT_EQ((*sets)[0].elements, (std::vector<std::size_t>{1, 2, 4}));
  EXPECT_EQ((*sets)[0].error, 0.5);
  EXPECT_EQ((*sets)[1].elements, (std::vector<std::size_t>{0, 3}));
  EXPECT_EQ((*sets)[2].elements, (std::vector<std::size_t>{5}));
  EXPECT_EQ((*sets)[2].error, 0.1);  // this element alone
}

TEST(CollectAlike, OneForeignElementAmongFiftyTakesFewFits) {
  Kinds kinds{std::vector<int>(50, 1)};
  kinds.of[33] = 2;
  EXPECT_TRUE(kinds.Collect(200));
  EXPECT_LE(kinds.fits, 13);
}

TEST(CollectAlike, ThreeKindsInTurnsAreCollected) {
  Kinds kinds;
  for (int k = 0; k < 50; ++k) kinds.of.push_back(k % 3);
  const auto sets = kinds.Collect(200);
  ASSERT_TRUE(sets);
  EXPECT_EQ(sets->size(), 3u);
}

// Without the limit there would be 2401 fits.
TEST(CollectAlike, WhereAllDifferTheFitsAreLimited) {
  Kinds kinds;
  for (int k = 0; k < 50; ++k) kinds.of.push_back(k);
  EXPECT_FALSE(kinds.Collect(200));
  EXPECT_EQ(kinds.fits, 200);
}

}  // namespace
}  // namespace elastocal
