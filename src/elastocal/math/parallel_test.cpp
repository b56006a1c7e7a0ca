// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/parallel.hpp"

#include <atomic>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

TEST(ForAll, DoesEverythingOnceAndCountsIt) {
  for (const int threads : {1, 3, 200}) {
    std::vector<std::atomic<int>> done(100);
    std::vector<int> reported;
    ForAll(
        done.size(), threads, [&](std::size_t i) { ++done[i]; },
        [&](int count, int total) {
          EXPECT_EQ(total, 100);
          reported.push_back(count);
        });
    for (const auto& count : done) EXPECT_EQ(count, 1);
    ASSERT_EQ(reported.size(), 101u);
    for (int i = 0; i <= 100; ++i) EXPECT_EQ(reported[static_cast<std::size_t>(i)], i);
  }
  ForAll(0, 2, [](std::size_t) { FAIL(); });
}

TEST(ForAll, HandsAnExceptionOnAndBeginsNothingMore) {
  std::atomic<int> begun = 0;
  const auto work = [&](std::size_t i) {
    ++begun;
    if (i == 3) throw std::runtime_error("three");
  };
  EXPECT_THROW(ForAll(1000, 1, work), std::runtime_error);
  EXPECT_EQ(begun, 4);
  EXPECT_THROW(ForAll(1000, 4, work), std::runtime_error);
}

}  // namespace
}  // namespace elastocal
