// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/planning/design_follow_up.hpp"
#include "elastocal/planning/next_postures.hpp"

namespace elastocal::cli {

/// Which postures to record next; empty where nothing is open. `file`: where they were written to;
/// empty: nowhere.
std::string DescribeNext(const Project& project, const NextPostures& next, const std::string& file);

/// The smallest change of a joint's zero that check sees nine times in ten, in units of people.
std::string SmallestChange(const ZeroSensitivity& zero);

}  // namespace elastocal::cli
