// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/reference_scale.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace elastocal {
namespace {

bool IsLabelOf(const std::string& label, const std::string& marker) {
  return label == marker || label.ends_with(":" + marker);
}

double MedianOf(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::optional<MeasuredScale> ScaleBy(const ReferenceLength& reference,
                                     const MarkerTrajectories& trajectories) {
  constexpr std::size_t kFewestFrames = 10;
  constexpr double kSdOfMedian = 1.4826 * 1.2533;  // normal distribution: median, by the MAD
  constexpr double kShared = 10.0;                 // frames that count as one independent frame
  std::array<Eigen::Index, 2> column{};
  for (std::size_t end = 0; end < 2; ++end) {
    const auto found = std::find_if(
        trajectories.names.begin(), trajectories.names.end(),
        [&](const std::string& name) { return IsLabelOf(name, reference.markers[end]); });
    if (found == trajectories.names.end()) return std::nullopt;
    column[end] = 3 * (found - trajectories.names.begin());
  }
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < trajectories.positions.rows(); ++i) {
    const double distance = (trajectories.positions.row(i).segment<3>(column[0]) -
                             trajectories.positions.row(i).segment<3>(column[1]))
                                .norm();
    if (std::isfinite(distance)) distances.push_back(distance);
  }
  if (distances.size() < kFewestFrames) return std::nullopt;
  const double median = MedianOf(distances);
  const double count = std::max(1.0, static_cast<double>(distances.size()) / kShared);
  for (double& distance : distances) distance = std::abs(distance - median);
  const double sd = kSdOfMedian * MedianOf(distances) / std::sqrt(count);
  return MeasuredScale{median / reference.length - 1.0,
                       std::hypot(sd, reference.sd) / reference.length};
}

}  // namespace

std::optional<MeasuredScale> MeasureScale(const std::vector<ReferenceLength>& references,
                                          const MarkerTrajectories& trajectories) {
  std::vector<MeasuredScale> scales;
  for (const ReferenceLength& reference : references) {
    if (const auto scale = ScaleBy(reference, trajectories)) scales.push_back(*scale);
  }
  if (scales.empty()) return std::nullopt;
  double weights = 0.0, sum = 0.0, squares = 0.0;
  for (const MeasuredScale& scale : scales) {
    weights += 1.0 / (scale.sd * scale.sd);
    sum += scale.size / (scale.sd * scale.sd);
  }
  MeasuredScale mean{sum / weights, 1.0 / std::sqrt(weights)};
  for (const MeasuredScale& scale : scales) {
    squares += std::pow((scale.size - mean.size) / scale.sd, 2);
  }
  if (scales.size() > 1) {
    mean.sd *= std::max(1.0, std::sqrt(squares / static_cast<double>(scales.size() - 1)));
  }
  return mean;
}

bool IsReferenceMarker(const std::vector<ReferenceLength>& references, const std::string& label) {
  return std::any_of(references.begin(), references.end(), [&](const ReferenceLength& reference) {
    return IsLabelOf(label, reference.markers[0]) || IsLabelOf(label, reference.markers[1]);
  });
}

bool IsWrong(const MeasuredScale& scale) {
  constexpr double kLeast = 5e-4, kCertain = 4.5;
  return std::abs(scale.size) > kLeast && std::abs(scale.size) > kCertain * scale.sd;
}

std::string Describe(const MeasuredScale& scale) {
  char text[60];
  std::snprintf(text, sizeof text, "%.5f +- %.5f", 1.0 + scale.size, scale.sd);
  return text;
}

}  // namespace elastocal
