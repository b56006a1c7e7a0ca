// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/design_report.hpp"

#include <fmt/format.h>

#include "elastocal/cli/text_table.hpp"

namespace elastocal::cli {

std::string DesignTable(const PostureDesign& result) {
  TextTable table(
      {"chain", "parameters", "postures", "ended by", "O", "efficiency %", "yield %", "time s"});
  for (const auto& [design, seconds] : result.chains) {
    table.Add(
        {design.setup.name, std::to_string(design.parameter_count),
         std::to_string(design.postures.size()),
         design.mirrored_from.empty() ? StatusText(design.status)
                                      : "mirror of " + design.mirrored_from,
         fmt::format("{:.4f}", design.index),
         design.certificate.bound > 0.0 ? fmt::format("{:.1f}", 100.0 * design.Efficiency()) : "",
         design.sampling.tries > 0 ? fmt::format("{:.0f}", 100.0 * design.sampling.Yield()) : "",
         fmt::format("{:.2f}", seconds)});
  }
  return table.Render();
}

}  // namespace elastocal::cli
