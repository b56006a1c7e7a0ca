// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace elastocal {

/// While it lives, no other process holds a lock on this folder: two batches in one folder would do
/// tasks twice, and each write over what the other does. The lock ends with the process, however it
/// ends; the file `.batch.lock` stays.
class BatchLock {
 public:
  /// Throws InputError where another process holds it, with its number. Where the file system has
  /// no locks, nothing is held.
  explicit BatchLock(const std::filesystem::path& folder);
  ~BatchLock();
  BatchLock(const BatchLock&) = delete;
  BatchLock& operator=(const BatchLock&) = delete;

 private:
  int descriptor_ = -1;
};

/// The name of its file.
inline constexpr const char* kBatchLockName = ".batch.lock";

}  // namespace elastocal
