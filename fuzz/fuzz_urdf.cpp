// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/description/urdf_writer.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/robot/robot_tree.hpp"

namespace {

void ReadAndEdit(const std::string& text) {
  const elastocal::RobotTree tree = elastocal::ParseUrdf(text, "fuzz.urdf");
  // What has been read must be usable, and origins must be found again where they were read.
  elastocal::LinkTransforms(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  auto origins = elastocal::ReadOrigins(text, "fuzz.urdf");
  if (elastocal::ReplaceOrigins(text, "fuzz.urdf", origins) != text) std::abort();
  for (auto& [joint, origin] : origins) {
    origin.xyz.setConstant(0.125);
    origin.rpy.setConstant(-0.5);
  }
  const std::string edited = elastocal::ReplaceOrigins(text, "fuzz.urdf", origins);
  for (const auto& [joint, origin] : elastocal::ReadOrigins(edited, "fuzz.urdf")) {
    if (origin.xyz != origins.at(joint).xyz || origin.rpy != origins.at(joint).rpy) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    ReadAndEdit(std::string(data, data + size));
  } catch (const elastocal::InputError&) {
    return 0;
  }
  return 0;
}
