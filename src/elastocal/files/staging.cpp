// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/staging.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "elastocal/files/output_files.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace fs = std::filesystem;
namespace {

constexpr const char* kOwner = ".owner";  // locked while the run lives

}  // namespace

std::string SystemError() { return errno != 0 ? std::strerror(errno) : "input or output error"; }

void FailToWrite(const fs::path& file, const std::string& reason) {
  throw InputError("cannot write " + file.string() + ": " + reason);
}

void SyncFolder(const fs::path& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

void WriteNew(const fs::path& path, const std::string& contents, const fs::path& given) {
  errno = 0;
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) FailToWrite(given, SystemError());
  std::size_t done = 0;
  bool fine = true;
  while (fine && done < contents.size()) {
    const ssize_t written = write(descriptor, contents.data() + done, contents.size() - done);
    if (written >= 0) done += static_cast<std::size_t>(written);
    fine = written >= 0 || errno == EINTR;
  }
  fine = fine && fsync(descriptor) == 0;
  const std::string reason = SystemError();
  close(descriptor);
  if (!fine) FailToWrite(given, reason);
}

void SyncFile(const fs::path& path, const fs::path& given) {
  errno = 0;
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool fine = descriptor >= 0 && fsync(descriptor) == 0;
  const std::string reason = SystemError();
  if (descriptor >= 0) close(descriptor);
  if (!fine) FailToWrite(given, reason);
}

NewFolders::~NewFolders() {
  std::error_code ignored;
  for (; !created_.empty(); created_.pop_back()) fs::remove(created_.back(), ignored);
}

void NewFolders::Create(const fs::path& folder) {
  std::error_code error;
  if (folder.empty() || fs::is_directory(folder, error)) return;
  Create(folder.parent_path());
  if (fs::create_directory(folder, error)) created_.push_back(folder);
  if (error) {
    throw InputError("cannot create the folder " + folder.string() + ": " + error.message());
  }
}

FolderLock::FolderLock(const fs::path& folder)
    : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ >= 0) flock(descriptor_, LOCK_EX);
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

Staging::Staging(const fs::path& folder, const fs::path& file) {
  const FolderLock lock(folder);
  std::string name = (folder / (std::string(kStagingPrefix) + "XXXXXX")).string();
  errno = 0;
  if (mkdtemp(name.data()) == nullptr) FailToWrite(file, SystemError());
  path_ = name;
  descriptor_ = open((path_ / kOwner).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  owned_ = true;
  if (descriptor_ >= 0) flock(descriptor_, LOCK_EX);
}

Staging::Staging(const fs::path& path) : path_(path) {
  descriptor_ = open((path_ / kOwner).c_str(), O_RDWR | O_CLOEXEC);
  owned_ = descriptor_ < 0 ? errno == ENOENT : flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
}

Staging::~Staging() {
  std::error_code ignored;
  if (owned_ && !fs::exists(path_ / kCommit, ignored)) fs::remove_all(path_, ignored);
  if (descriptor_ >= 0) close(descriptor_);
}

SignalsHeld::SignalsHeld() {
  sigset_t held;
  sigemptyset(&held);
  for (int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&held, signal);
  pthread_sigmask(SIG_BLOCK, &held, &before_);
}

SignalsHeld::~SignalsHeld() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

void ApplyCommit(const Staging& staging) {
  const SignalsHeld held;
  const fs::path folder = staging.path().parent_path();
  const std::string commit = ReadFile(staging.path() / kCommit);
  for (std::size_t at = 0; at < commit.size();) {
    const std::size_t end = commit.find('\0', at);
    if (end == std::string::npos) break;
    const char action = commit[at];
    const std::string name = commit.substr(at + 1, end - at - 1);
    at = end + 1;
    if (name != fs::path(name).filename()) continue;  // not written by this program
    std::error_code error, ignored;
    if (action == '-') {
      fs::remove(folder / name, error);
    } else if (fs::exists(staging.path() / name, ignored)) {
      fs::rename(staging.path() / name, folder / name, error);
    }
    if (error) FailToWrite(folder / name, error.message());
  }
  SyncFolder(folder);
  std::error_code ignored;
  fs::remove(staging.path() / kCommit, ignored);
}

}  // namespace elastocal
