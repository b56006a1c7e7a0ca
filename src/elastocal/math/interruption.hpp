// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <memory>

namespace elastocal {

/// How often a thread looks whether its work is to end early.
inline constexpr std::chrono::milliseconds kBetweenLooks(50);

/// Called in the inner loops of all long work, several times a second: a place where the work may
/// be ended early. Nothing happens unless an Interruptible lives; then it takes some 30 ns.
void InterruptionPoint();

/// What leaves the work on other threads than the one that was interrupted.
struct Interrupted : std::exception {
  const char* what() const noexcept override { return "interrupted"; }
};

/// While it lives, the work of this thread can be ended early, as by Ctrl-C: InterruptionPoint
/// calls `look` on this thread, every kBetweenLooks, and an exception that `look` throws leaves the
/// work like any other; where somebody swallows it, the next point throws it again. What ForAll
/// does on further threads for this work ends with it.
///
///   const Interruptible interruptible([] { if (stop) throw Stop(); });
///   DesignPostures(project, {});
class Interruptible {
 public:
  explicit Interruptible(std::function<void()> look);
  ~Interruptible();
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

  struct State;

 private:
  friend class InterruptionOfCaller;
  explicit Interruptible(std::shared_ptr<State> shared);

  std::shared_ptr<State> before_;
};

/// Makes work on another thread end together with that of the thread that made this object.
class InterruptionOfCaller {
 public:
  InterruptionOfCaller();

  /// To be kept on the other thread while it works. Points there throw Interrupted.
  Interruptible Share() const { return Interruptible(state_); }

 private:
  std::shared_ptr<Interruptible::State> state_;
};

}  // namespace elastocal
