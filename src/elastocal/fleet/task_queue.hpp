// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace elastocal {

/// End of a task: the program's exit code, or 128 plus the signal's number if it was killed.
struct TaskEnd {
  int exit_code = 0;
  double seconds = 0.0;
};

/// A place that does one task at a time: a process on this machine, or another rank.
class TaskSlot {
 public:
  virtual ~TaskSlot() = default;
  virtual void Start(int task) = 0;
  /// The end of the started task; nothing while it runs.
  virtual std::optional<TaskEnd> Poll() = 0;
};

/// Callbacks of RunTasks.
struct QueueOptions {
  /// Called when a task has ended, in the order of the ends.
  std::function<void(int task, const TaskEnd& end)> ended = {};
  /// Called between two polls of the slots; true: start no further task.
  std::function<bool()> stop = {};
};

/// Does all tasks in their order, each on the next free slot. Returns when all started tasks have
/// ended.
void RunTasks(const std::vector<int>& tasks, const std::vector<std::unique_ptr<TaskSlot>>& slots,
              const QueueOptions& options);

}  // namespace elastocal
