// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/moved_joints_report.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "elastocal/cli/figures.hpp"
#include "elastocal/cli/session.hpp"
#include "elastocal/cli/text_table.hpp"

namespace elastocal::cli {
namespace {

constexpr double kLeastShown = 0.01;  // smallest probability of a joint that is shown
constexpr std::size_t kMostShown = 5;

std::string ChangeText(const ParameterChange& change) {
  Parameter parameter{};
  parameter.unit = change.unit;
  const double factor = InUserUnits(parameter, 1.0);
  const double sd = factor * change.sd;
  return fmt::format("{} by {} +- {} {}", change.name, RoundedTo(factor * change.value, sd),
                     RoundedSd(sd), UserUnit(parameter));
}

/// Text on changes of more than two standard deviations, or else on the largest one.
std::string ChangesText(const JointSuspect& suspect) {
  std::string text;
  const ParameterChange* largest = nullptr;
  double most = -1.0;
  for (const ParameterChange& change : suspect.changes) {
    const double ratio = std::abs(change.value) / change.sd;
    if (ratio > most) {
      most = ratio;
      largest = &change;
    }
    if (ratio > 2.0) text += (text.empty() ? "" : ", ") + ChangeText(change);
  }
  return text.empty() && largest != nullptr ? ChangeText(*largest) : text;
}

}  // namespace

std::string Probability(double p) {
  if (p < 1e-16) return "<1e-16";
  return p < 1e-4 ? fmt::format("{:.0e}", p) : fmt::format("{:.4f}", p);
}

std::string DescribeMarkers(const std::vector<LinkMarkers>& links) {
  if (links.empty()) return "";
  std::vector<std::string> moved;
  for (const LinkMarkers& link : links) {
    if (link.same) continue;
    moved.push_back(link.as_one_piece ? link.link + " (as one piece)"
                                      : fmt::format("{} (p {})", link.link, Probability(link.p)));
  }
  std::string text = fmt::format("Markers: on {} of {} links all are where they were",
                                 links.size() - moved.size(), links.size());
  if (!moved.empty()) text += fmt::format("; elsewhere on {}", fmt::join(moved, ", "));
  return text + "\n";
}

std::string SuspectTable(const JointCheck& check) {
  TextTable table({"joint", "p of all joints", "probability that it is the one", "its change"});
  std::size_t shown = 0;
  for (const JointSuspect& joint : check.joints) {
    if (joint.probability < kLeastShown || ++shown > kMostShown) break;
    table.Add({joint.joint, fmt::format("{:.2g}", joint.p_adjusted),
               fmt::format("{:.2f}", joint.probability), ChangesText(joint)});
  }
  return table.Render();
}

std::string DescribeMoved(const JointCheck& check, const std::vector<std::string>& alternatives,
                          double level) {
  if (!check.changed()) {
    return fmt::format(
        "Unchanged: the calibration explains these postures (chance of a false alarm {:.3g} %).\n",
        100.0 * level);
  }
  std::string text;
  for (const JointSuspect& joint : check.moved) {
    text += fmt::format("Moved: {} ({}; p {:.1g})\n", joint.joint, ChangesText(joint),
                        joint.p_adjusted);
  }
  if (!check.suspects.empty()) {
    text += fmt::format("Changed: one of {}.\n", fmt::join(check.suspects, ", "));
  }
  if (!check.or_markers.empty()) {
    text += fmt::format("Or all markers on {} moved as one piece.\n",
                        fmt::join(check.or_markers, ", or on "));
  }
  if (!alternatives.empty()) {
    text += fmt::format("Or {}: this explains it as well.\n", fmt::join(alternatives, ", or "));
  }
  return text;
}

std::string DescribeWrongRecording(const std::vector<std::string>& alternatives) {
  return fmt::format(
      "The recording seems wrong, not the robot: {}; once that is corrected, the calibration "
      "holds\n",
      fmt::join(alternatives, ", or "));
}

std::string DescribeSensitivity(const JointCheck& check) {
  std::string text;
  for (const bool lengths : {false, true}) {
    std::vector<const JointSuspect*> told;
    for (const JointSuspect& joint : check.joints) {
      if (joint.zero_told && joint.zero_is_length == lengths) told.push_back(&joint);
    }
    if (told.empty()) continue;
    const auto seen = [](const JointSuspect* joint) { return joint->smallest_seen; };
    const auto [least, most] = std::ranges::minmax_element(told, {}, seen);
    const double factor = lengths ? 1e3 : 180.0 / M_PI;
    text += fmt::format(
        "Changes of a zero would be seen from {:.2g} {} on ({}){}\n",
        factor * (*least)->smallest_seen, lengths ? "mm" : "deg", (*least)->joint,
        least == most
            ? ""
            : fmt::format(", {:.2g} at {}", factor * (*most)->smallest_seen, (*most)->joint));
  }
  if (check.not_told.empty()) return text;
  return text + fmt::format(
                    "These postures cannot tell whether the zeros of these joints have moved: {}\n",
                    fmt::join(check.not_told, ", "));
}

}  // namespace elastocal::cli
