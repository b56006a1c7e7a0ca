#include "elastocal/io/output_files.hpp"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <deque>
#include <fstream>
#include <iostream>
#include <system_error>

#include <unistd.h>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestFile = 256u << 20;

std::string Reason() { return errno != 0 ? std::strerror(errno) : "input or output error"; }

[[noreturn]] void FailToWrite(const fs::path& file, const std::string& reason) {
  throw InputError("cannot write " + file.string() + ": " + reason);
}

/// Folders made for files; those that are empty are removed again unless they are kept.
class NewFolders {
 public:
  NewFolders() = default;
  NewFolders(const NewFolders&) = delete;
  NewFolders& operator=(const NewFolders&) = delete;
  ~NewFolders() {
    std::error_code ignored;
    for (auto folder = created_.rbegin(); folder != created_.rend(); ++folder) {
      fs::remove(*folder, ignored);
    }
  }

  void Create(const fs::path& folder) {
    std::error_code error;
    if (folder.empty() || fs::is_directory(folder, error)) return;
    Create(folder.parent_path());
    if (fs::create_directory(folder, error)) created_.push_back(folder);
    if (error) {
      throw InputError("cannot create the folder " + folder.string() + ": " + error.message());
    }
  }

  void Keep() { created_.clear(); }

 private:
  std::vector<fs::path> created_;
};

/// Where the symbolic links that `file` may be lead, also when nothing is there yet.
fs::path FollowLinks(const fs::path& file) {
  constexpr int kMostLinks = 40;
  fs::path target = file;
  for (int i = 0; i < kMostLinks; ++i) {
    std::error_code error;
    if (!fs::is_symlink(fs::symlink_status(target, error))) return target;
    target = target.parent_path() / fs::read_symlink(target, error);
    if (error) FailToWrite(file, error.message());
  }
  FailToWrite(file, "too many symbolic links");
}

/// A file on its way: checked and, where it can be renamed, written under a temporary name. What
/// was not published is removed.
class PendingFile {
 public:
  PendingFile(const fs::path& file, const std::string& contents, NewFolders& folders)
      : file_(file), contents_(contents) {
    standard_output_ = file == "-" || file == "/dev/stdout";
    if (standard_output_) return;
    if (file.filename().empty()) FailToWrite(file, "the name of a file was expected");
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (fs::is_directory(status)) FailToWrite(file, "is a folder");
    if (fs::exists(status) && !fs::is_regular_file(status)) return;
    target_ = FollowLinks(file);
    folders.Create(target_.parent_path());
    static std::atomic<int> count = 0;
    temporary_ = target_.parent_path() /
                 (".elastocal." + std::to_string(getpid()) + "." + std::to_string(++count));
  }
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  ~PendingFile() {
    std::error_code ignored;
    if (!temporary_.empty()) fs::remove(temporary_, ignored);
  }

  void WriteTemporary() const {
    if (!temporary_.empty()) WriteTo(temporary_);
  }

  /// What is no regular file cannot be written beforehand.
  void WriteStream() const {
    if (standard_output_) {
      errno = 0;
      std::cout.write(contents_.data(), static_cast<std::streamsize>(contents_.size())).flush();
      if (!std::cout) throw InputError("cannot write to standard output: " + Reason());
    } else if (temporary_.empty()) {
      WriteTo(file_);
    }
  }

  void Publish() const {
    if (temporary_.empty()) return;
    std::error_code error;
    fs::rename(temporary_, target_, error);
    if (error) FailToWrite(file_, error.message());
  }

 private:
  void WriteTo(const fs::path& path) const {
    errno = 0;
    std::ofstream stream(path, std::ios::binary | std::ios::trunc);
    stream.write(contents_.data(), static_cast<std::streamsize>(contents_.size()));
    stream.close();
    if (!stream) FailToWrite(file_, Reason());
  }

  const fs::path& file_;
  const std::string& contents_;
  bool standard_output_ = false;
  fs::path target_, temporary_;  ///< empty for what is no regular file
};

}  // namespace

std::string ReadFile(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::none) {
    throw InputError(file.string() + ": cannot be read: " + error.message());
  }
  if (!fs::exists(status)) throw InputError(file.string() + ": there is no such file");
  if (fs::is_directory(status)) throw InputError(file.string() + ": is a folder");
  if (!fs::is_regular_file(status)) throw InputError(file.string() + ": is not a regular file");
  const std::uintmax_t size = fs::file_size(file, error);
  if (!error && size > kLargestFile) {
    throw InputError(file.string() + ": has " + std::to_string(size >> 20) +
                     " MiB; at most 256 MiB are read");
  }
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string contents(error ? 0 : size, '\0');
  stream.read(contents.data(), static_cast<std::streamsize>(contents.size()));
  if (error || !stream) throw InputError(file.string() + ": cannot be read: " + Reason());
  return contents;
}

void WriteFile(const fs::path& file, const std::string& contents) {
  WriteFiles({{file, contents}});
}

void WriteFiles(const std::vector<std::pair<fs::path, std::string>>& files) {
  NewFolders folders;
  std::deque<PendingFile> pending;
  for (const auto& [file, contents] : files) pending.emplace_back(file, contents, folders);
  for (const PendingFile& file : pending) file.WriteTemporary();
  for (const PendingFile& file : pending) file.WriteStream();
  for (const PendingFile& file : pending) file.Publish();
  folders.Keep();
}

bool SameFile(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) && !error;
}

}  // namespace elastocal
