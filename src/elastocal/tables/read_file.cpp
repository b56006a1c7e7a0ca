// SPDX-License-Identifier: Apache-2.0
#include "elastocal/tables/read_file.hpp"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kLargestFile = 256u << 20;

[[noreturn]] void FailToRead(const std::filesystem::path& file, int reason) {
  if (file.empty()) throw InputError("the name of a file is empty");
  if (reason == ENOENT || reason == ENOTDIR) {
    throw InputError(file.string() + ": there is no such file");
  }
  if (reason == EISDIR) throw InputError(file.string() + ": is a folder; a file was expected");
  throw InputError(file.string() + ": cannot be read: " + std::generic_category().message(reason));
}

/// A file that is open for reading.
class OpenFile {
 public:
  /// Opens the file, without waiting for somebody at the other end of a pipe.
  explicit OpenFile(const std::filesystem::path& file)
      : file_(file), descriptor_(open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
    if (descriptor_ < 0) FailToRead(file, errno);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { close(descriptor_); }

  /// Its size. Throws InputError for what is no regular file.
  std::size_t Size() const {
    struct stat status {};
    if (fstat(descriptor_, &status) != 0) FailToRead(file_, errno);
    if (S_ISDIR(status.st_mode)) FailToRead(file_, EISDIR);
    if (!S_ISREG(status.st_mode)) {
      throw InputError(file_.string() + ": is not a regular file (a device or a pipe)");
    }
    return static_cast<std::size_t>(status.st_size);
  }

  std::size_t Read(char* to, std::size_t most) const {
    for (;;) {
      const ssize_t count = read(descriptor_, to, most);
      if (count >= 0) return static_cast<std::size_t>(count);
      if (errno != EINTR) FailToRead(file_, errno);
    }
  }

 private:
  const std::filesystem::path& file_;
  int descriptor_;
};

}  // namespace

std::filesystem::file_type FileTypeOf(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::none) FailToRead(path, error.value());
  return status.type();
}

std::string ReadFile(const std::filesystem::path& file) {
  const OpenFile open_file(file);
  const std::size_t size = open_file.Size();
  const auto refuse_size = [&](std::size_t found) {
    throw InputError(file.string() + ": has " + std::to_string(found >> 20) +
                     " MiB; at most 256 MiB are read");
  };
  if (size > kLargestFile) refuse_size(size);
  // One byte more than the size of the file shows whether it grows meanwhile.
  std::string contents(size + 1, '\0');
  std::size_t held = 0;
  while (const std::size_t count = open_file.Read(&contents[held], contents.size() - held)) {
    held += count;
    if (held > kLargestFile) refuse_size(held);
    if (held == contents.size()) contents.resize(2 * held);
  }
  contents.resize(held);
  return contents;
}

}  // namespace elastocal
