// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/runtime/compensator.hpp"

namespace elastocal {

struct CHeaderOptions {
  std::string prefix;   ///< of all names: letters, digits and '_', no digit first
  std::string heading;  ///< a comment at the top, one or more lines
  /// Lines of comment for joints and legs, by name: which errors they have, with unit and sd.
  std::map<std::string, std::vector<std::string>> comments = {};
  CompensatorOptions limits = {};  ///< written into the header
};

/// Whether C takes the text for a name.
bool IsCName(const std::string& name);

/// One self-contained C99 header (that is C++ as well) for this robot and this calibration: the
/// functions of Compensator, their constants, and indices of joints, links and feet by name. It
/// needs nothing but math.h, and allocates nothing. The functions are the library's own, so that
/// the same compiler gives the same bits.
///
/// Throws std::invalid_argument for a prefix that is no C name, and what Compensator throws.
std::string MakeCHeader(RuntimeModel model, const CHeaderOptions& options);

/// The text of core_poses.h and the other core_*.h, up to core_correction.h, one after the
/// other, without their includes of each other.
extern const char* const kRuntimeCore;

}  // namespace elastocal
