// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/fleet/fleet_report.hpp"

namespace elastocal {

/// The report of a fleet as one self-contained HTML file (docs/formats.md): robots with verdict and
/// figures, and what they have in common. `fleet_json` holds the contents of fleet.json. Empty
/// where the program was built without the page.
std::string MakeFleetPage(const FleetReport& report, const std::string& fleet_json);

}  // namespace elastocal
