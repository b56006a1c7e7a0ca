// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/validation/common_parameters.hpp"

// A calibration.yaml becomes an estimate that can be compared with itself.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const elastocal::CalibrationEstimate estimate =
        elastocal::ParseEstimate(std::string(data, data + size), "fuzz.yaml");
    for (const elastocal::ParameterEstimate& parameter : estimate.parameters) {
      if (parameter.name.empty() || parameter.unit.empty()) std::abort();
    }
    elastocal::FindCommonParameters(estimate, estimate);
  } catch (const elastocal::InputError&) {
    return 0;
  }
  return 0;
}
