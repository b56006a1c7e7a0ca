// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/io/posture_file.hpp"
#include "elastocal/math/input_error.hpp"

// Postures that are read are written so that as many are read again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const elastocal::Project project =
      elastocal::ReadProject(std::filesystem::path(ELASTOCAL_FUZZ_DIR) / "table_project.yaml");
  std::vector<elastocal::ChainPostures> chains;
  try {
    chains = elastocal::ParsePostureFile(std::string(data, data + size), "fuzz.yaml", project);
  } catch (const elastocal::InputError&) {
    return 0;
  }
  const std::string text = elastocal::FormatPostureFile(project.tree, chains);
  const auto again = elastocal::ParsePostureFile(text, "again.yaml", project);
  if (elastocal::ListPostures(chains, "a").q.rows() !=
      elastocal::ListPostures(again, "b").q.rows()) {
    std::abort();
  }
  return 0;
}
