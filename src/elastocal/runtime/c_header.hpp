// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/runtime/compensator.hpp"

namespace elastocal {

/// Settings of MakeCHeader.
struct CHeaderOptions {
  std::string prefix;  ///< prefix of all names: letters, digits and '_', not beginning with a digit
  std::string heading;  ///< comment at the top, one or more lines
  /// Comment lines for joints and legs, by name: their errors with unit and sd.
  std::map<std::string, std::vector<std::string>> comments = {};
  CompensatorOptions limits = {};  ///< limits that are written into the header
};

/// Whether a text is a valid name in C.
bool IsCName(const std::string& name);

/// One self-contained C99 header (also valid C++) for this robot and this calibration. It contains
/// the functions of Compensator, their constants, and indices of joints, links and feet by name. It
/// needs only math.h, stdint.h and string.h, and allocates nothing. The functions are those of the
/// library, so that the same compiler gives the same bits.
///
/// Throws std::invalid_argument for a prefix that is no C name, and as Compensator.
std::string MakeCHeader(RuntimeModel model, const CHeaderOptions& options);

/// The texts of core_poses.h to core_correction.h, one after the other, without their includes of
/// each other.
extern const char* const kRuntimeCore;

}  // namespace elastocal
