// SPDX-License-Identifier: Apache-2.0
#include "elastocal/fleet/batch_lock.hpp"

#include <array>
#include <cerrno>
#include <string>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

/// The number of the process in the lock file, as text; empty where there is none.
std::string HolderOf(int descriptor) {
  std::array<char, 32> text{};
  const ssize_t count = pread(descriptor, text.data(), text.size() - 1, 0);
  const std::string number(text.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
  const std::size_t end = number.find_first_not_of("0123456789");
  return end == 0 || number.empty() ? "" : " (process " + number.substr(0, end) + ")";
}

}  // namespace

BatchLock::BatchLock(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kBatchLockName;
  descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) return;  // writing results to the folder reports the reason
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return;
    const std::string holder = HolderOf(descriptor_);
    close(descriptor_);
    throw InputError(folder.string() + ": another batch" + holder +
                     " is at work in this folder; wait until it has ended, or give another folder");
  }
  const std::string number = std::to_string(getpid()) + "\n";
  if (ftruncate(descriptor_, 0) != 0) return;
  [[maybe_unused]] const ssize_t written = pwrite(descriptor_, number.data(), number.size(), 0);
}

BatchLock::~BatchLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace elastocal
