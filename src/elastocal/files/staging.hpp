// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

namespace elastocal {

// Parts of OutputSet: files wait in a staging folder until all files of a run are complete, and
// then get their names together.

inline constexpr const char* kStagingPrefix = ".elastocal-";
// In a staging folder, beside the files of the run.
inline constexpr const char* kCommit = ".commit";

/// The system's message about the last failure (errno).
std::string SystemError();

/// Throws InputError "cannot write FILE: REASON".
[[noreturn]] void FailToWrite(const std::filesystem::path& file, const std::string& reason);

/// Waits until the names in a folder are on the disk.
void SyncFolder(const std::filesystem::path& folder);

/// Writes a new file and waits until it is on the disk. Throws InputError naming the file as
/// `given`.
void WriteNew(const std::filesystem::path& path, const std::string& contents,
              const std::filesystem::path& given);

/// Waits until a file that somebody else wrote is on the disk.
void SyncFile(const std::filesystem::path& path, const std::filesystem::path& given);

/// Makes folders for files; on destruction, those that are still empty are removed.
class NewFolders {
 public:
  ~NewFolders();
  void Create(const std::filesystem::path& folder);

 private:
  std::vector<std::filesystem::path> created_;
};

/// Locks a folder: while the object exists, no other process makes or judges staging folders in it.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  int descriptor_;
};

/// A staging folder. Its run holds a lock on the owner file in it. A process that gets this lock
/// knows that the run has ended.
class Staging {
 public:
  /// Makes a new staging folder in `folder`, for `file`.
  Staging(const std::filesystem::path& folder, const std::filesystem::path& file);
  /// Takes an existing staging folder, under the lock of its folder. It is owned if its run has
  /// ended.
  explicit Staging(const std::filesystem::path& path);
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;
  ~Staging();

  const std::filesystem::path& path() const { return path_; }
  bool owned() const { return owned_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  bool owned_ = false;
};

/// Holds back interrupting signals while it exists, so that files get their names together.
class SignalsHeld {
 public:
  SignalsHeld();
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;
  ~SignalsHeld();

 private:
  sigset_t before_{};
};

/// Carries out the commit of a staging folder, as far as it is not done yet: "+NAME" moves a file
/// into the folder around it, "-NAME" removes one there. Each entry ends with a NUL.
void ApplyCommit(const Staging& staging);

}  // namespace elastocal
