// SPDX-License-Identifier: Apache-2.0
#include "elastocal/fleet/task_queue.hpp"

#include <chrono>
#include <thread>

namespace elastocal {

void RunTasks(const std::vector<int>& tasks, const std::vector<std::unique_ptr<TaskSlot>>& slots,
              const QueueOptions& options) {
  constexpr std::chrono::milliseconds kLook{2};
  std::vector<int> running(slots.size(), -1);
  std::size_t next = 0;
  for (;;) {
    bool busy = false;
    for (std::size_t s = 0; s < slots.size(); ++s) {
      if (running[s] >= 0) {
        if (const std::optional<TaskEnd> end = slots[s]->Poll()) {
          if (options.ended) options.ended(running[s], *end);
          running[s] = -1;
        }
      }
      const bool stopped = options.stop && options.stop();
      if (running[s] < 0 && next < tasks.size() && !stopped) {
        running[s] = tasks[next++];
        slots[s]->Start(running[s]);
      }
      busy = busy || running[s] >= 0;
    }
    if (!busy) return;
    std::this_thread::sleep_for(kLook);
  }
}

}  // namespace elastocal
