// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/two_tables.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/observation/observation_fit.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kFewestOfATable = 4;
constexpr double kFurtherApart = 2.0;

using Height = std::pair<double, int>;  // height, m, and line of the file

/// The number of touches on the lower table; 0: there is one table.
std::size_t CountLower(const std::vector<Height>& sorted) {
  std::size_t below = 0;
  double widest = 0.0;
  for (std::size_t i = kFewestOfATable; i + kFewestOfATable <= sorted.size(); ++i) {
    const double gap = sorted[i].first - sorted[i - 1].first;
    if (gap <= widest) continue;
    widest = gap;
    below = i;
  }
  if (below == 0) return 0;
  const double lower = sorted[below - 1].first - sorted.front().first;
  const double upper = sorted.back().first - sorted[below].first;
  return widest > kFurtherApart * std::max(lower, upper) ? below : 0;
}

double MeanOf(std::vector<Height>::const_iterator begin, std::vector<Height>::const_iterator end) {
  double sum = 0.0;
  for (auto at = begin; at != end; ++at) sum += at->first;
  return sum / static_cast<double>(end - begin);
}

}  // namespace

std::vector<std::string> FindTwoTables(const ObservedRobot& model,
                                       const Observations& observations) {
  const std::vector<Eigen::VectorXd> left =
      LeftOf(model, observations, StartFit(model, observations).values);
  std::vector<std::string> found;
  for (int plate = 0; plate < static_cast<int>(model.setup.plates.size()); ++plate) {
    for (int file = 0; file < static_cast<int>(observations.files.size()); ++file) {
      std::vector<Height> heights;
      for (std::size_t i = 0; i < left.size(); ++i) {
        const Observation& of = observations.all[i];
        const PosturePlace& place = observations.postures[Size(of.posture)];
        if (of.instrument != plate || place.file != file) continue;
        heights.emplace_back(left[i][0], place.line);
      }
      std::sort(heights.begin(), heights.end());
      const std::size_t lower = CountLower(heights);
      if (lower == 0) continue;
      const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(lower);
      const double apart = MeanOf(middle, heights.end()) - MeanOf(heights.begin(), middle);
      std::vector<int> lines;
      for (auto at = middle; at != heights.end(); ++at) lines.push_back(at->second);
      std::sort(lines.begin(), lines.end());
      found.push_back(fmt::format(
          "plate '{}' touches two tables in {}: {} touches (lines {}) lie some {:.3g} mm above the "
          "other {}; a file for each table was expected",
          model.instrument(plate).name, observations.files[Size(file)], lines.size(),
          fmt::join(lines, ", "), 1e3 * apart, lower));
    }
  }
  return found;
}

}  // namespace elastocal
