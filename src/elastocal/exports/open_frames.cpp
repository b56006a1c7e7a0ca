// SPDX-License-Identifier: Apache-2.0
#include "elastocal/exports/open_frames.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

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
  std::vector<std::string> sentences;
  std::set<int> told;
  for (const Chain& chain : project.chains) {
    const Link& tip = project.tree.links[Size(chain.tip_link)];
    if (tip.body == 0 || !told.insert(tip.body).second) continue;
    const std::string& joint = project.tree.joints[Size(tip.body - 1)].name;
    const ParameterEstimate* turn = FindUnsupported(estimate, joint + ".theta");
    const ParameterEstimate* along = FindUnsupported(estimate, joint + ".r");
    if (turn == nullptr && along == nullptr) continue;
    const std::string axis = "the axis of " + joint;
    std::string open;
    if (turn != nullptr) {
      open = fmt::format("turned about {} ({:.2f} deg sd)", axis, turn->sd * 180.0 / M_PI);
    }
    if (along != nullptr) {
      open += fmt::format("{}displaced along {} ({:.1f} mm sd)", open.empty() ? "" : " and ",
                          open.empty() ? axis : "it", 1e3 * along->sd);
    }
    sentences.push_back(fmt::format(
        "Link {} may be {}, which nothing has told: measure where three of its markers are on it, "
        "and calibrate with --marker-places",
        tip.name, open));
  }
  return sentences;
}

}  // namespace elastocal
