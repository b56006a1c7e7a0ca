// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/math/random.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// A table of `rows` different postures of all joints except those that are left out.
inline std::string TableText(const Project& project, int rows, const std::string& without = "",
                             const std::string& extra = "") {
  std::string text;
  for (const Joint& joint : project.tree.joints) {
    if (!joint.mimic && joint.name != without) text += joint.name + ",";
  }
  text += (extra.empty() ? "note" : extra) + "\n";
  Random random(1);
  for (int i = 0; i < rows; ++i) {
    for (const Joint& joint : project.tree.joints) {
      if (!joint.mimic && joint.name != without) {
        text += std::to_string(random.Uniform(-0.1, 0.1)) + ",";
      }
    }
    text += "a\n";
  }
  return text;
}

}  // namespace elastocal
