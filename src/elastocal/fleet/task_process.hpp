// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "elastocal/fleet/manifest.hpp"
#include "elastocal/fleet/task_queue.hpp"

namespace elastocal {

/// A slot on this machine. Each command of a task is a process of its own, so that results are
/// bit-identical to those of the same commands given by hand, and a crash loses only one task.
/// Output goes to OUTPUT/TASK.log.
class TaskProcess : public TaskSlot {
 public:
  /// `program` is the path of elastocal. Keeps a reference to the tasks.
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

/// The file that records how a task ended; it is written last.
std::filesystem::path MarkOf(const FleetTask& task, const std::filesystem::path& output);

/// The end of a task in an earlier run, if it counts as done: the commands were the same, there is
/// a result (exit code 0 or 4), and none of its project and recordings is newer.
std::optional<TaskEnd> EndedBefore(const FleetTask& task, const std::filesystem::path& output);

}  // namespace elastocal
