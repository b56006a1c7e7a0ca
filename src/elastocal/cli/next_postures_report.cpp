// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/next_postures_report.hpp"

#include <cmath>

#include <fmt/format.h>

namespace elastocal::cli {
namespace {

/// A posture in degrees and mm, without the joints that are at rest in it.
std::string PostureText(const Project& project, const Eigen::VectorXd& q) {
  constexpr double kShown = 1e-3;  // rad or m
  std::string text;
  for (int i = 0; i < project.tree.coordinate_count(); ++i) {
    if (std::abs(q[i] - project.motion.rest[i]) < kShown) continue;
    const Joint& joint = project.tree.joints[project.tree.coordinate_joint[i]];
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", joint.name,
                        joint.type == JointType::kPrismatic
                            ? fmt::format("{:.0f} mm", 1e3 * q[i])
                            : fmt::format("{:.1f}", 180.0 / M_PI * q[i]));
  }
  return text;
}

}  // namespace

std::string DescribeNext(const Project& project, const NextPostures& next,
                         const std::string& file) {
  if (!next.why_none.empty()) {
    return "\nNo postures that tell which: " + next.why_none + "\n";
  }
  if (next.postures.empty()) return "";
  std::string text = "\nPostures that tell which (degrees; the other joints at rest)\n";
  for (const ChainPostures& chain : next.postures) {
    for (const Eigen::VectorXd& q : chain.q) {
      text += fmt::format("  {}: {}\n", chain.chain, PostureText(project, q));
    }
  }
  return text + (file.empty() ? "-o FILE writes them as a posture file, for plan\n"
                              : fmt::format("Wrote {}\n", file));
}

std::string SmallestChange(const ZeroSensitivity& zero) {
  if (!std::isfinite(zero.smallest_seen)) return "not told";
  return zero.prismatic ? fmt::format("{:.2f} mm", 1e3 * zero.smallest_seen)
                        : fmt::format("{:.2f} deg", 180.0 / M_PI * zero.smallest_seen);
}

}  // namespace elastocal::cli
