// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "elastocal/math/input_error.hpp"
#include "elastocal/readers/qtm_tsv.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const elastocal::MarkerTrajectories read =
        elastocal::ParseQtmTsv(std::string(data, data + size), "fuzz.tsv");
    // A marker was seen or it was not; and the rate can be divided by.
    for (Eigen::Index i = 0; i < read.positions.size(); i += 3) {
      const Eigen::Index frame = i / read.positions.cols(), column = i % read.positions.cols();
      const Eigen::Index gaps = read.positions.block(frame, column, 1, 3).array().isNaN().count();
      if (gaps == 1 || gaps == 2) std::abort();
    }
    if (!(read.rate_hz > 0.0) || !std::isfinite(read.rate_hz)) std::abort();
  } catch (const elastocal::InputError&) {
    return 0;
  }
  return 0;
}
