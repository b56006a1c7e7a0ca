// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "elastocal/fleet/manifest.hpp"
#include "elastocal/fleet/task_queue.hpp"

namespace elastocal {

/// A slot of this machine: each command of a task is a process of its own, so that a task has the
/// bits of the same commands given by hand, and a crash loses one task. What they print goes to
/// OUTPUT/TASK.log.
class TaskProcess : public TaskSlot {
 public:
  /// `program`: the file of elastocal. Keeps a reference to the tasks.
  TaskProcess(std::filesystem::path program, std::filesystem::path output,
              const std::vector<FleetTask>& tasks);
  ~TaskProcess() override;
  TaskProcess(const TaskProcess&) = delete;
  TaskProcess& operator=(const TaskProcess&) = delete;

  void Start(int task) override;
  std::optional<TaskEnd> Poll() override;

 private:
  void StartCommand();
  TaskEnd Finish(int exit_code);

  std::filesystem::path program_, output_;
  const std::vector<FleetTask>& tasks_;
  int task_ = -1;
  std::size_t command_ = 0;
  int process_ = -1;
  double begin_ = 0.0;
};

/// Where a task says how it ended; written last.
std::filesystem::path MarkOf(const FleetTask& task, const std::filesystem::path& output);

/// How a task ended in an earlier run, if it is to be taken as done: by the same commands, with a
/// result (exit code 0 or 4), and none of its project and recordings is newer.
std::optional<TaskEnd> EndedBefore(const FleetTask& task, const std::filesystem::path& output);

}  // namespace elastocal
