// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/label_help.hpp"

#include <algorithm>

#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

/// The label of a file that is nearest to the expected one, without regard to capitals and to the
/// subject before a colon; empty where none is near.
std::string NearestLabel(const std::string& expected, const std::vector<std::string>& labels) {
  std::string nearest;
  int best = 1 + static_cast<int>(expected.size()) / 2;
  for (const std::string& label : labels) {
    const std::string plain = label.substr(label.rfind(':') + 1);
    const int distance = std::min(EditDistance(expected, label), EditDistance(expected, plain));
    if (distance >= best) continue;
    best = distance;
    nearest = label;
  }
  return nearest;
}

}  // namespace

std::string FirstOf(const std::vector<std::string>& texts) {
  constexpr std::size_t kNamed = 4;
  std::string list;
  for (std::size_t i = 0; i < std::min(kNamed, texts.size()); ++i) {
    list += (i == 0 ? "" : ", ") + texts[i];
  }
  if (texts.size() > kNamed) list += " and " + std::to_string(texts.size() - kNamed) + " more";
  return list;
}

std::string DescribeLabels(const TrialSummary& summary, const Project& project) {
  if (!summary.markers.empty() || summary.markers_unknown.empty()) return "";
  std::vector<std::string> labels, expected;
  for (const std::string& label : summary.markers_unknown) labels.push_back(Quote(label));
  for (const std::string& marker : summary.markers_missing) {
    const auto given = project.recording.labels.find(marker);
    const std::string& label = given == project.recording.labels.end() ? marker : given->second;
    const std::string nearest = NearestLabel(label, summary.markers_unknown);
    expected.push_back(Quote(label) + (nearest.empty() ? "" : " (is it " + Quote(nearest) + "?)"));
  }
  return ", whose labels are " + FirstOf(labels) + "; expected were " + FirstOf(expected) +
         ". recording.labels of " + project.file.string() +
         " says which label a marker has (docs/formats.md)";
}

}  // namespace elastocal
