// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace elastocal::cli {

/// Combines warnings that say the same of several joints, markers or trials into one sentence: the
/// first of them, and the names in the others:
///
///     trial arm_left: LHAND_1 was lost for 12 % of the time (likewise LHAND_2, LHAND_3)
///
/// Two warnings say the same if they differ only in numbers, in words that contain a digit or an
/// underscore, and in the word after "trial", "marker", "cluster", "chain" or "joint". The order of
/// the first ones is kept.
std::vector<std::string> GroupWarnings(const std::vector<std::string>& warnings);

}  // namespace elastocal::cli
