// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace elastocal {

/// Lock on the folder of a batch. While the object lives, no other process holds the lock: two
/// batches in one folder would do tasks twice and overwrite each other's results. The lock ends
/// with the process, however that ends; the file `.batch.lock` stays.
class BatchLock {
 public:
  /// Takes the lock. Throws InputError, with the process's number, where another process holds it.
  /// On a file system without locks, nothing is locked.
  explicit BatchLock(const std::filesystem::path& folder);
  ~BatchLock();
  BatchLock(const BatchLock&) = delete;
  BatchLock& operator=(const BatchLock&) = delete;

 private:
  int descriptor_ = -1;
};

/// Name of the lock file.
inline constexpr const char* kBatchLockName = ".batch.lock";

}  // namespace elastocal
