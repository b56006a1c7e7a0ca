// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/execution_report.hpp"

#include <cmath>

#include <fmt/format.h>

#include "elastocal/cli/text_table.hpp"

namespace elastocal::cli {
namespace {

std::string PlaceCell(const PlaceError& error) {
  if (error.samples == 0) return "";
  return fmt::format("{:.2f} ({:.2f})", 1e3 * error.rms_m, 1e3 * error.max_m);
}

std::string LandingCell(const PlaceError& error) {
  if (error.samples == 0) return "";
  return fmt::format("{:.2f} mm {:.2f} deg", 1e3 * error.max_m, error.max_rad * 180.0 / M_PI);
}

std::string ZmpCell(double margin_m) {
  return std::isfinite(margin_m) ? fmt::format("{:.1f}", 1e3 * margin_m) : "no foot down";
}

}  // namespace

std::string DescribeOpenJoints(const std::vector<std::string>& names) {
  if (names.empty()) return "";
  return fmt::format("At rest, since the motion has no column of them: {}\n",
                     fmt::join(names, ", "));
}

std::string DescribeExecutions(const std::vector<Execution>& executions) {
  TextTable table({"controller knows", "stabiliser", "stood", "hands mm", "swinging feet mm",
                   "waist mm", "centre of mass mm", "landing, largest", "shift mm", "zmp mm"});
  for (const Execution& one : executions) {
    const bool played = one.refused.empty();
    table.Add({DeployName(one.as), one.stabilised ? "yes" : "no",
               !played         ? "not played"
               : one.run.stood ? "yes"
                               : fmt::format("fell at {:.0f} s", one.run.time_s),
               PlaceCell(one.hands), PlaceCell(one.swinging_feet), PlaceCell(one.waist),
               PlaceCell(one.centre_of_mass), LandingCell(one.landing),
               played && one.stabilised ? fmt::format("{:.1f}", 1e3 * one.run.largest_shift) : "",
               played ? ZmpCell(one.run.least_zmp_margin) : ""});
  }
  std::string refused;
  for (const Execution& one : executions) {
    if (one.refused.empty()) continue;
    const std::string line =
        fmt::format("{} was not played: {}\n", DeployName(one.as), one.refused);
    // The same with and without a stabiliser.
    if (refused.find(line) == std::string::npos) refused += line;
  }
  return refused + "Distance from the plan, root mean square (and largest)\n" + table.Render() +
         "shift: of the root link by the stabiliser; zmp: least distance of the zero-moment point "
         "to the edge\n";
}

}  // namespace elastocal::cli
