// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace elastocal {

/// How a task ended: the program's exit code, or 128 and the signal's number where it was killed.
struct TaskEnd {
  int exit_code = 0;
  double seconds = 0.0;
};

/// A place that does one task at a time: a process of this machine, or another rank.
class TaskSlot {
 public:
  virtual ~TaskSlot() = default;
  virtual void Start(int task) = 0;
  /// How the task that was started has ended; nothing while it goes on.
  virtual std::optional<TaskEnd> Poll() = 0;
};

struct QueueOptions {
  /// Called when a task has ended, in the order in which they end.
  std::function<void(int task, const TaskEnd& end)> ended = {};
  /// Asked between two looks at the slots: whether to start nothing more.
  std::function<bool()> stop = {};
};

/// Does all tasks, each on whatever slot is free next, in their order. Ends when all that was
/// started has ended.
void RunTasks(const std::vector<int>& tasks, const std::vector<std::unique_ptr<TaskSlot>>& slots,
              const QueueOptions& options);

}  // namespace elastocal
