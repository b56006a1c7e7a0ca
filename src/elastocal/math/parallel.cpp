// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace elastocal {

void ForAll(std::size_t count, int threads, const std::function<void(std::size_t)>& work,
            const Progress& progress) {
  if (count == 0) return;
  std::atomic<std::size_t> next = 0;
  std::exception_ptr failure;
  std::mutex guard;
  int done = 0;
  if (progress) progress(done, static_cast<int>(count));
  const auto worker = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) {
        work(i);
        const std::lock_guard lock(guard);
        if (progress) progress(++done, static_cast<int>(count));
      }
    } catch (...) {
      const std::lock_guard lock(guard);
      failure = std::current_exception();
      next = count;
    }
  };
  std::vector<std::thread> others;
  const int workers =
      static_cast<int>(std::min(count, static_cast<std::size_t>(std::max(threads, 1))));
  for (int i = 1; i < workers; ++i) others.emplace_back(worker);
  worker();
  for (std::thread& thread : others) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace elastocal
