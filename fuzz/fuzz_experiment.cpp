// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "elastocal/io/experiment.hpp"
#include "elastocal/math/input_error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path folder(ELASTOCAL_FUZZ_DIR);
  static const elastocal::Project project = elastocal::ReadProject(folder / "table_project.yaml");
  try {
    // The seeds name files of the corpus.
    const elastocal::Experiment experiment =
        elastocal::ParseExperiment(std::string(data, data + size), folder / "corpus", project);
    for (const elastocal::TrialFiles& trial : experiment.trials) {
      if (trial.chains.empty()) std::abort();
    }
  } catch (const elastocal::InputError&) {
    return 0;
  }
  return 0;
}
