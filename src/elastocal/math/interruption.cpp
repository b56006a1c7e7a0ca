// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/interruption.hpp"

#include <atomic>
#include <chrono>
#include <thread>
#include <utility>

namespace elastocal {

using Clock = std::chrono::steady_clock;

struct Interruptible::State {
  std::function<void()> look;
  std::thread::id owner = std::this_thread::get_id();
  Clock::time_point next_look = Clock::now();  ///< used by the owner only
  std::exception_ptr reason;                   ///< what ended the work; used by the owner only
  std::atomic<bool> ended = false;
};

namespace {

thread_local std::shared_ptr<Interruptible::State> state_of_thread;

}  // namespace

void InterruptionPoint() {
  Interruptible::State* state = state_of_thread.get();
  if (state == nullptr) return;
  if (std::this_thread::get_id() != state->owner) {
    if (state->ended) throw Interrupted();
    return;
  }
  if (state->reason) std::rethrow_exception(state->reason);
  const Clock::time_point now = Clock::now();
  if (now < state->next_look) return;
  state->next_look = now + kBetweenLooks;
  try {
    state->look();
  } catch (...) {
    state->reason = std::current_exception();
    state->ended = true;
    throw;
  }
}

Interruptible::Interruptible(std::function<void()> look)
    : before_(std::exchange(state_of_thread, std::make_shared<State>())) {
  state_of_thread->look = std::move(look);
}

Interruptible::Interruptible(std::shared_ptr<State> shared)
    : before_(std::exchange(state_of_thread, std::move(shared))) {}

Interruptible::~Interruptible() { state_of_thread = before_; }

InterruptionOfCaller::InterruptionOfCaller() : state_(state_of_thread) {}

}  // namespace elastocal
