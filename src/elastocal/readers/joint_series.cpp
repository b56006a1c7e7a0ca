// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/joint_series.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr std::int64_t kNanoseconds = 1000000000;
constexpr double kLongestHole = 0.1;  // s: positions are not interpolated over more

/// Value of a column of `series` at a time, linear between messages; NaN in holes and outside.
double ValueAt(const JointSeries& series, const Eigen::MatrixXd& values, Eigen::Index column,
               std::int64_t time) {
  const auto& stamps = series.stamps_ns;
  const auto after = std::lower_bound(stamps.begin(), stamps.end(), time);
  if (after == stamps.end()) return kNaN;
  const auto i = after - stamps.begin();
  if (*after == time) return values(i, column);
  if (i == 0) return kNaN;
  const auto step = static_cast<double>(*after - after[-1]);
  if (step > kLongestHole * kNanoseconds) return kNaN;
  const double share = static_cast<double>(time - after[-1]) / step;
  return (1.0 - share) * values(i - 1, column) + share * values(i, column);
}

}  // namespace

JointSeries SortSeries(const std::string& place, std::vector<std::string> names,
                       const std::vector<std::int64_t>& stamps,
                       const std::vector<double>& positions, const std::vector<double>& efforts) {
  const std::size_t width = names.size();
  std::vector<std::size_t> order(stamps.size()), kept;
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return stamps[a] < stamps[b]; });
  const auto at = [&](std::size_t i) {
    return positions.begin() + static_cast<std::ptrdiff_t>(i * width);
  };
  for (const std::size_t i : order) {
    if (kept.empty() || stamps[kept.back()] != stamps[i]) {
      kept.push_back(i);
    } else if (!std::equal(at(i), at(i) + static_cast<std::ptrdiff_t>(width), at(kept.back()))) {
      throw InputError(place + "two messages of the time " +
                       FormatNumber(static_cast<double>(stamps[i]) / kNanoseconds) +
                       " s have different positions");
    }
  }
  JointSeries series;
  series.names = std::move(names);
  const auto rows = static_cast<Eigen::Index>(kept.size());
  series.positions.resize(rows, static_cast<Eigen::Index>(width));
  series.efforts.resizeLike(series.positions);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const std::size_t i = kept[static_cast<std::size_t>(row)];
    series.stamps_ns.push_back(stamps[i]);
    for (std::size_t k = 0; k < width; ++k) {
      series.positions(row, static_cast<Eigen::Index>(k)) = positions[i * width + k];
      series.efforts(row, static_cast<Eigen::Index>(k)) = efforts[i * width + k];
    }
  }
  return series;
}

JointLog MergeSeries(const std::string& source, const std::vector<JointSeries>& all,
                     std::vector<std::string>& notes) {
  const auto first = std::max_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return a.names.size() * a.stamps_ns.size() < b.names.size() * b.stamps_ns.size();
  });
  JointLog log;
  log.source = source;
  std::vector<std::pair<const JointSeries*, Eigen::Index>> columns;
  std::set<std::string> taken;
  const auto add = [&](const JointSeries& series) {
    for (std::size_t k = 0; k < series.names.size(); ++k) {
      if (!taken.insert(series.names[k]).second) continue;
      log.names.push_back(series.names[k]);
      columns.emplace_back(&series, static_cast<Eigen::Index>(k));
    }
  };
  add(*first);
  for (const JointSeries& series : all) add(series);
  const auto width = static_cast<Eigen::Index>(columns.size());
  const auto samples = static_cast<Eigen::Index>(first->stamps_ns.size());
  log.time_s.resize(samples);
  log.positions.resize(samples, width);
  log.torques.resize(samples, width);
  Eigen::Index row = 0;
  for (const std::int64_t stamp : first->stamps_ns) {
    log.time_s[row] = static_cast<double>(stamp) / kNanoseconds;
    for (Eigen::Index k = 0; k < width; ++k) {
      const auto& [series, column] = columns[static_cast<std::size_t>(k)];
      log.positions(row, k) = ValueAt(*series, series->positions, column, stamp);
      log.torques(row, k) = ValueAt(*series, series->efforts, column, stamp);
    }
    if (!log.positions.row(row).array().isNaN().any()) ++row;
  }
  log.time_s.conservativeResize(row);
  log.positions.conservativeResize(row, width);
  log.torques.conservativeResize(row, width);
  if (all.size() > 1) {
    notes.push_back("messages have different joints (" + std::to_string(all.size()) +
                    " sets of them); they are brought to the times of one set, and " +
                    std::to_string(samples - row) + " of " + std::to_string(samples) +
                    " samples are left out where others are not known");
  }
  return log;
}

}  // namespace elastocal
