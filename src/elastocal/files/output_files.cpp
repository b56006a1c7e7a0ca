// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/output_files.hpp"

#include <system_error>

#include "elastocal/files/output_set.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace fs = std::filesystem;

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
