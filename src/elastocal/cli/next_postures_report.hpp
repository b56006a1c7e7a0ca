// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/planning/design_follow_up.hpp"
#include "elastocal/planning/next_postures.hpp"

namespace elastocal::cli {

/// Text that says which postures to record next; empty where nothing is open. `file` is the file to
/// which they were written; empty: none.
std::string DescribeNext(const Project& project, const NextPostures& next, const std::string& file);

/// The smallest change of a joint's zero that check finds nine times in ten, in units for people.
std::string SmallestChange(const ZeroSensitivity& zero);

}  // namespace elastocal::cli
