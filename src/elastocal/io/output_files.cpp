#include "elastocal/io/output_files.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "elastocal/io/output_set.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestFile = 256u << 20;

std::string Reason() { return errno != 0 ? std::strerror(errno) : "input or output error"; }

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
  OutputSet outputs;
  for (const auto& [file, contents] : files) {
    if (file.empty()) throw InputError("cannot write: the name of a file was expected");
    outputs.Declare(file);
  }
  outputs.Prepare();
  for (const auto& [file, contents] : files) outputs.Set(file, contents);
  outputs.Publish();
}

bool SameFile(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) && !error;
}

}  // namespace elastocal
