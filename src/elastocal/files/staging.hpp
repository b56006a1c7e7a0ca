// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

namespace elastocal {

// What OutputSet is made of: files that wait in a staging folder until all of a run are whole, and
// then get their names together.

inline constexpr const char* kStagingPrefix = ".elastocal-";
// In a staging folder, beside the files of the run.
inline constexpr const char* kCommit = ".commit";

/// What the system says about the last failure.
std::string SystemError();

/// Throws InputError "cannot write FILE: REASON".
[[noreturn]] void FailToWrite(const std::filesystem::path& file, const std::string& reason);

/// Waits until the names in a folder are on the disk.
void SyncFolder(const std::filesystem::path& folder);

/// Writes a new file and waits until it is on the disk. Throws in the name of `given`.
void WriteNew(const std::filesystem::path& path, const std::string& contents,
              const std::filesystem::path& given);

/// Waits until a file that somebody else wrote is on the disk.
void SyncFile(const std::filesystem::path& path, const std::filesystem::path& given);

/// Folders made for files; those that are empty in the end are removed again.
class NewFolders {
 public:
  ~NewFolders();
  void Create(const std::filesystem::path& folder);

 private:
  std::vector<std::filesystem::path> created_;
};

/// Keeps others from making or judging staging folders in a folder meanwhile.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  int descriptor_;
};

/// A staging folder. Its run holds the lock of the owner's file in it: whoever gets that lock knows
/// that the run is gone.
class Staging {
 public:
  /// A new one in `folder`, for `file`.
  Staging(const std::filesystem::path& folder, const std::filesystem::path& file);
  /// One that is there already, under the lock of its folder; it is owned if its run is gone.
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

/// Interrupts wait while files get their names.
class SignalsHeld {
 public:
  SignalsHeld();
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;
  ~SignalsHeld();

 private:
  sigset_t before_{};
};

/// Does what the commit of a staging folder says, as far as it is not done yet: "+NAME" moves a
/// file into the folder around it, "-NAME" removes one there; each entry ends with a NUL.
void ApplyCommit(const Staging& staging);

}  // namespace elastocal
