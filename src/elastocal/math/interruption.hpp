// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <memory>

namespace elastocal {

/// Least time between two checks of a thread whether its work is to end early.
inline constexpr std::chrono::milliseconds kBetweenLooks(50);

/// A place where long work may be ended early. The inner loops of all long work call it several
/// times a second. It does nothing unless an Interruptible exists on the thread; then it takes some
/// 30 ns.
void InterruptionPoint();

/// Exception that ends the work on the other threads when a thread is interrupted.
struct Interrupted : std::exception {
  const char* what() const noexcept override { return "interrupted"; }
};

/// Makes the work of this thread interruptible (for instance by Ctrl-C) while the object exists.
/// InterruptionPoint calls `look` on this thread every kBetweenLooks. An exception that `look`
/// throws ends the work; if somebody swallows it, the next InterruptionPoint throws it again. The
/// work of ForAll on further threads ends as well.
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

  /// The other thread keeps the returned object while it works. InterruptionPoint there throws
  /// Interrupted.
  Interruptible Share() const { return Interruptible(state_); }

 private:
  std::shared_ptr<Interruptible::State> state_;
};

}  // namespace elastocal
