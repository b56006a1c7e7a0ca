// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "elastocal/fleet/task_queue.hpp"

namespace elastocal::cli {

/// The processes that mpirun started. Rank 0 has the queue; each rank does one task at a time.
class MpiRanks {
 public:
  /// Joins the other processes; null where mpirun did not start this process. Throws InputError
  /// where it did, but the module for MPI was not built or cannot be loaded.
  static std::unique_ptr<MpiRanks> Join();

  ~MpiRanks();
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }

  /// For rank 0: a slot for each other rank. The slots must not outlive this object.
  std::vector<std::unique_ptr<TaskSlot>> OtherRanks();
  /// For rank 0: ends the service of the other ranks.
  void Dismiss() const;
  /// For other ranks: does the tasks that rank 0 gives, until it is dismissed.
  void Serve(TaskSlot& slot) const;

 private:
  friend class RankSlot;
  struct Functions {
    void (*start)(int*, int*) = nullptr;
    void (*send)(int, const double*) = nullptr;
    int (*poll)(int, double*) = nullptr;
    void (*finish)() = nullptr;
  };
  explicit MpiRanks(const Functions& functions);

  Functions mpi_;
  int rank_ = 0, size_ = 1;
};

}  // namespace elastocal::cli
