// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/interruption.hpp"

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

#include "elastocal/math/parallel.hpp"

namespace elastocal {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

struct Stop : std::runtime_error {
  Stop() : std::runtime_error("stop") {}
};

/// Works until it is interrupted, or for ten seconds.
void WorkForLong() {
  const auto latest = steady_clock::now() + std::chrono::seconds(10);
  while (steady_clock::now() < latest) InterruptionPoint();
}

TEST(Interruption, LooksNowAndThenAndNotAfterItsLife) {
  int looks = 0;
  {
    const Interruptible interruptible([&] { ++looks; });
    const auto end = steady_clock::now() + 5 * kBetweenLooks;
    while (steady_clock::now() < end) InterruptionPoint();
  }
  EXPECT_GE(looks, 1);
  EXPECT_LE(looks, 6);
  const int before = looks;
  std::this_thread::sleep_for(2 * kBetweenLooks);
  InterruptionPoint();
  EXPECT_EQ(looks, before);
}

TEST(Interruption, EndsTheWorkOfItsThread) {
  const auto begin = steady_clock::now();
  const Interruptible interruptible([] { throw Stop(); });
  EXPECT_THROW(WorkForLong(), Stop);
  EXPECT_LT(steady_clock::now() - begin, std::chrono::seconds(5));
}

TEST(Interruption, IsNotForgottenWhereSomebodySwallowsIt) {
  int thrown = 0;
  const Interruptible interruptible([&] {
    ++thrown;
    throw Stop();
  });
  EXPECT_THROW(WorkForLong(), Stop);
  EXPECT_THROW(InterruptionPoint(), Stop);
  EXPECT_EQ(thrown, 1);
}

TEST(Interruption, EndsTheWorkOfAllThreadsOfForAll) {
  // One task ends at once. So the calling thread may be the one that has nothing left to do.
  for (const std::size_t quick : {0u, 1u}) {
    std::atomic<int> begun = 0;
    const auto begin = steady_clock::now();
    const Interruptible interruptible([&] {
      if (steady_clock::now() - begin > milliseconds(200)) throw Stop();
    });
    const auto work = [&](std::size_t i) {
      ++begun;
      if (i != quick) WorkForLong();
    };
    EXPECT_THROW(ForAll(3, 3, work), Stop);
    EXPECT_LE(begun, 3);
    EXPECT_LT(steady_clock::now() - begin, std::chrono::seconds(5));
  }
}

TEST(Interruption, EndsWorkWithinWorkOnOtherThreads) {
  const auto begin = steady_clock::now();
  const Interruptible interruptible([&] {
    if (steady_clock::now() - begin > milliseconds(200)) throw Stop();
  });
  const auto inner = [](std::size_t) { WorkForLong(); };
  EXPECT_THROW(ForAll(2, 2, [&](std::size_t) { ForAll(2, 2, inner); }), Stop);
  EXPECT_LT(steady_clock::now() - begin, std::chrono::seconds(5));
}

TEST(Interruption, LeavesWorkOfOthersAlone) {
  const Interruptible interruptible([] { throw Stop(); });
  std::thread other([] {
    std::this_thread::sleep_for(2 * kBetweenLooks);
    EXPECT_NO_THROW(InterruptionPoint());
  });
  other.join();
}

}  // namespace
}  // namespace elastocal
