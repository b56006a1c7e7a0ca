// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "elastocal/math/input_error.hpp"
#include "elastocal/project/project.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Beside robot.urdf, which the seeds name.
  const std::filesystem::path file = std::filesystem::path(ELASTOCAL_FUZZ_DIR) / "project.yaml";
  try {
    const elastocal::Project project =
        elastocal::ParseProject(std::string(data, data + size), file);
    for (const elastocal::Chain& chain : project.chains) elastocal::ChainMarkers(project, chain);
  } catch (const elastocal::InputError&) {
    return 0;
  }
  return 0;
}
