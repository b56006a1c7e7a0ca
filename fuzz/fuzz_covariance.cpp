// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "elastocal/io/covariance_file.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/table_reader.hpp"

// A covariance that is read is square, finite and as symmetric as the reader says.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  elastocal::CalibrationEstimate estimate;
  estimate.parameters = {
      {.name = "a.theta", .unit = "rad", .sd = 2.0},
      {.name = "b, \"left\".d", .unit = "m", .sd = 3.0},
      {.name = "M.x", .unit = "m", .status = elastocal::ParameterStatus::kUnsupported, .sd = 1.0}};
  try {
    elastocal::TextStream stream({reinterpret_cast<const char*>(data), size});
    elastocal::ReadCovariance(stream, "fuzz.csv", estimate);
    const Eigen::MatrixXd& covariance = estimate.covariance;
    const auto names = static_cast<Eigen::Index>(estimate.covariance_names.size());
    if (covariance.rows() != names || covariance.cols() != names) std::abort();
    if (!covariance.allFinite() || names < 2) std::abort();
  } catch (const elastocal::InputError&) {
    return 0;
  }
  return 0;
}
