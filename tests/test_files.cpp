// SPDX-License-Identifier: Apache-2.0
#include "tests/test_files.hpp"

#include <cstdlib>

namespace elastocal {

std::filesystem::path SourceFile(const std::string& path) {
  return std::filesystem::path(ELASTOCAL_SOURCE_DIR) / path;
}

std::filesystem::path SharedFile(const std::string& path) {
  const char* data = std::getenv("ELASTOCAL_SHARED_DATA");
  const std::filesystem::path shared =
      data ? std::filesystem::path(data) / ".." : SourceFile("../shared");
  return (shared / path).lexically_normal();
}

}  // namespace elastocal
