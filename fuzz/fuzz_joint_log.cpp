// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>

#include "elastocal/io/joint_log.hpp"
#include "elastocal/math/input_error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const elastocal::Project project =
      elastocal::ReadProject(std::filesystem::path(ELASTOCAL_FUZZ_DIR) / "table_project.yaml");
  std::istringstream stream(std::string(data, data + size));
  try {
    const elastocal::JointLog log = elastocal::ReadJointLog(stream, "fuzz.csv", project);
    for (Eigen::Index i = 1; i < log.time_s.size(); ++i) {
      if (!(log.time_s[i] > log.time_s[i - 1])) std::abort();
    }
    if (!log.positions.allFinite() || log.torques.array().isInf().any()) std::abort();
  } catch (const elastocal::InputError&) {
    return 0;
  }
  return 0;
}
