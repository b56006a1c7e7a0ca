// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/planning/design_postures.hpp"

namespace elastocal::cli {

/// Table with one row for each chain.
std::string DesignTable(const PostureDesign& result);

}  // namespace elastocal::cli
