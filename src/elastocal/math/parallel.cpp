// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "elastocal/math/interruption.hpp"

namespace elastocal {
namespace {

/// Work that several threads share.
class SharedWork {
 public:
  SharedWork(std::size_t count, const std::function<void(std::size_t)>& work,
             const Progress& progress)
      : count_(count), work_(work), progress_(progress) {
    if (progress_) progress_(0, static_cast<int>(count_));
  }

  /// Does work on one of the threads until nothing is left to be begun.
  void Do() {
    try {
      for (std::size_t i = next_++; i < count_; i = next_++) {
        work_(i);
        const std::lock_guard lock(guard_);
        if (progress_) progress_(++done_, static_cast<int>(count_));
      }
    } catch (const Interrupted&) {
      End(interruption_);
    } catch (...) {
      End(failure_);
    }
  }

  void DoOnOtherThread(const InterruptionOfCaller& interruption) {
    {
      const Interruptible interruptible = interruption.Share();
      Do();
    }
    const std::lock_guard lock(guard_);
    ++finished_;
    is_finished_.notify_one();
  }

  /// Waits until `others` other threads have finished. The caller can be interrupted meanwhile.
  void WaitFor(int others) {
    std::unique_lock lock(guard_);
    while (!is_finished_.wait_for(lock, kBetweenLooks, [&] { return finished_ == others; })) {
      lock.unlock();
      try {
        InterruptionPoint();
      } catch (...) {
        End(failure_);
      }
      lock.lock();
    }
  }

  /// Throws the exception that ended the work early; a failure takes precedence over Interrupted.
  void Rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
    if (interruption_) std::rethrow_exception(interruption_);
  }

 private:
  /// Keeps the exception of the handler that calls it, and stops further work.
  void End(std::exception_ptr& reason) {
    const std::lock_guard lock(guard_);
    reason = std::current_exception();
    next_ = count_;
  }

  const std::size_t count_;
  const std::function<void(std::size_t)>& work_;
  const Progress& progress_;
  std::atomic<std::size_t> next_ = 0;
  std::mutex guard_;
  std::condition_variable is_finished_;
  int done_ = 0, finished_ = 0;
  std::exception_ptr failure_, interruption_;
};

}  // namespace

void ForAll(std::size_t count, int threads, const std::function<void(std::size_t)>& work,
            const Progress& progress) {
  if (count == 0) return;
  SharedWork shared(count, work, progress);
  const int others =
      static_cast<int>(std::min(count, static_cast<std::size_t>(std::max(threads, 1)))) - 1;
  const InterruptionOfCaller interruption;
  std::vector<std::thread> running;
  for (int i = 0; i < others; ++i) {
    running.emplace_back([&] { shared.DoOnOtherThread(interruption); });
  }
  shared.Do();
  shared.WaitFor(others);
  for (std::thread& thread : running) thread.join();
  shared.Rethrow();
}

}  // namespace elastocal
