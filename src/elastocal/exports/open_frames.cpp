// SPDX-License-Identifier: Apache-2.0
#include "elastocal/exports/open_frames.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr const char* kHeading =
    "Frames that the recording could not tell, with standard deviations; places of three markers "
    "on each would (calibrate --marker-places):";

const ParameterEstimate* FindUnsupported(const CalibrationEstimate& estimate,
                                         const std::string& name) {
  const auto found = std::ranges::find(estimate.parameters, name, &ParameterEstimate::name);
  const bool open =
      found != estimate.parameters.end() && found->status == ParameterStatus::kUnsupported;
  return open ? &*found : nullptr;
}

}  // namespace

std::vector<std::string> DescribeOpenFrames(const Project& project,
                                            const CalibrationEstimate& estimate) {
  std::vector<std::string> lines;
  std::set<int> told;
  for (const Chain& chain : project.chains) {
    const Link& tip = project.tree.links[Size(chain.tip_link)];
    if (tip.body == 0 || !told.insert(tip.body).second) continue;
    const std::string& joint = project.tree.joints[Size(tip.body - 1)].name;
    const ParameterEstimate* turn = FindUnsupported(estimate, joint + ".theta");
    const ParameterEstimate* along = FindUnsupported(estimate, joint + ".r");
    if (turn == nullptr && along == nullptr) continue;
    std::string open;
    if (turn != nullptr) open = fmt::format("{:.2f} deg about", turn->sd * 180.0 / M_PI);
    if (along != nullptr) {
      open += fmt::format("{}{:.1f} mm along", open.empty() ? "" : ", ", 1e3 * along->sd);
    }
    lines.push_back(fmt::format("  {}: {} the axis of {}", tip.name, open, joint));
  }
  if (!lines.empty()) lines.insert(lines.begin(), kHeading);
  return lines;
}

}  // namespace elastocal
