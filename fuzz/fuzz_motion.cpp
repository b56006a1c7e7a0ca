// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "elastocal/io/motion_file.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/table_reader.hpp"

// A motion, and the same text as a list of postures.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const elastocal::Project project =
      elastocal::ReadProject(std::filesystem::path(ELASTOCAL_FUZZ_DIR) / "table_project.yaml");
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const bool timed : {true, false}) {
    try {
      elastocal::TextStream stream(text);
      const elastocal::JointMotion motion =
          timed ? elastocal::ReadMotion(stream, "fuzz.csv", project)
                : elastocal::ReadPostureList(stream, "fuzz.csv", project);
      if (motion.q.rows() != motion.sample_count()) std::abort();
      for (Eigen::Index i = 1; timed && i < motion.time_s.size(); ++i) {
        if (!(motion.time_s[i] > motion.time_s[i - 1])) std::abort();
      }
    } catch (const elastocal::InputError&) {
      continue;
    }
  }
  return 0;
}
