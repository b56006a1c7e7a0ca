// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <string>

#include "elastocal/io/posture_table.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/project/project.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const elastocal::Project project =
      elastocal::ReadProject(std::filesystem::path(ELASTOCAL_FUZZ_DIR) / "table_project.yaml");
  std::istringstream stream(std::string(data, data + size));
  try {
    elastocal::ReadPostureTable(stream, "fuzz.csv", project);
  } catch (const elastocal::InputError&) {
    return 0;
  }
  return 0;
}
