// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/validation/error_table.hpp"

namespace elastocal::cli {

/// Table 2 of the paper, mm: a row a group of chains and case (SW sinusoidal motions, RP random
/// postures, RM repeatability motion), RMSE of distances and the largest by model (FCM full, GCM
/// geometric, NCM not calibrated), then the groups as a whole and the mean.
std::string DescribeErrorTable(const ErrorTable& table);

}  // namespace elastocal::cli
