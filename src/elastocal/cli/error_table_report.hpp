// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/validation/error_table.hpp"

namespace elastocal::cli {

/// Table 2 of the paper, mm. A row for each group of chains and case (SW sinusoidal motions, RP
/// random postures, RM repeatability motion) has the RMSE and the largest of the distances by model
/// (FCM full, GCM geometric, NCM not calibrated). Then follow the groups as a whole and the mean.
std::string DescribeErrorTable(const ErrorTable& table);

}  // namespace elastocal::cli
