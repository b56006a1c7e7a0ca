#include "elastocal/io/output_files.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include <unistd.h>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestFile = 256u << 20;

std::string Reason() { return errno != 0 ? std::strerror(errno) : "input or output error"; }

/// Gives the file its name at the end, or removes what was written of it.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& file)
      : file_(file), temporary_(file.string() + "." + std::to_string(getpid()) + ".tmp") {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(temporary_, ignored);
  }

  void Write(const std::string& contents) const {
    errno = 0;
    std::ofstream stream(temporary_, std::ios::binary | std::ios::trunc);
    stream.write(contents.data(), static_cast<std::streamsize>(contents.size()));
    stream.close();
    if (!stream) throw InputError("cannot write " + temporary_.string() + ": " + Reason());
  }

  void Publish() const {
    std::error_code error;
    fs::rename(temporary_, file_, error);
    if (error) throw InputError("cannot write " + file_.string() + ": " + error.message());
  }

 private:
  fs::path file_, temporary_;
};

}  // namespace

std::string ReadFile(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) throw InputError(file.string() + ": there is no such file");
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
  std::error_code error;
  if (file.has_parent_path()) {
    fs::create_directories(file.parent_path(), error);
    if (error) {
      throw InputError("cannot create the folder " + file.parent_path().string() + ": " +
                       error.message());
    }
  }
  const TemporaryFile temporary(file);
  temporary.Write(contents);
  temporary.Publish();
}

}  // namespace elastocal
