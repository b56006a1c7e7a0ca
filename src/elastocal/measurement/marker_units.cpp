// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/marker_units.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr double kWrongDistance = 0.1, kRightDistance = 0.03;  // m
constexpr double kLeftOfWrong = 0.1;
constexpr std::size_t kFewestMates = 2;
constexpr Eigen::Index kMostRows = 500;

struct Mate {
  Eigen::Index column = 0;  ///< of the positions
  double distance = 0.0;    ///< by the project, m
};

/// Median error of the distances to the mates, against the project, with the coordinates in
/// `column` multiplied by a factor, m. NaN if they are never seen together.
double OffMates(const Eigen::MatrixXd& positions, Eigen::Index column,
                const std::vector<Mate>& mates, double factor) {
  const Eigen::Index step = 1 + (positions.rows() - 1) / kMostRows;
  std::vector<double> off;
  for (Eigen::Index row = 0; row < positions.rows(); row += step) {
    for (const Mate& mate : mates) {
      const double distance =
          (factor * positions.block<1, 3>(row, column) - positions.block<1, 3>(row, mate.column))
              .norm();
      if (!std::isnan(distance)) off.push_back(std::abs(distance - mate.distance));
    }
  }
  return Median(off);
}

/// For each name, the robot's marker; nullptr if the robot has none of this name.
std::vector<const Marker*> MarkersOf(const std::vector<std::string>& names,
                                     const std::vector<Marker>& robot) {
  std::vector<const Marker*> known;
  for (const std::string& name : names) {
    const auto marker = std::find_if(robot.begin(), robot.end(),
                                     [&](const Marker& one) { return one.name == name; });
    known.push_back(marker == robot.end() ? nullptr : &*marker);
  }
  return known;
}

/// Measured (median) and nominal distance of two markers of one link, m.
struct PairOfMarkers {
  double measured = 0.0, nominal = 0.0;
};

std::vector<PairOfMarkers> PairsOnLinks(const Eigen::MatrixXd& positions,
                                        const std::vector<const Marker*>& known) {
  constexpr double kShort = 0.03;  // m: errors of nominal positions are as large as this
  const Eigen::Index step = 1 + (positions.rows() - 1) / kMostRows;
  std::vector<PairOfMarkers> pairs;
  for (std::size_t m = 0; m < known.size(); ++m) {
    for (std::size_t k = m + 1; k < known.size(); ++k) {
      if (known[m] == nullptr || known[k] == nullptr || known[k]->link != known[m]->link) continue;
      const double nominal = (known[k]->p_link_marker - known[m]->p_link_marker).norm();
      if (nominal < kShort) continue;
      std::vector<double> measured;
      for (Eigen::Index row = 0; row < positions.rows(); row += step) {
        const double distance = (positions.block<1, 3>(row, static_cast<Eigen::Index>(3 * m)) -
                                 positions.block<1, 3>(row, static_cast<Eigen::Index>(3 * k)))
                                    .norm();
        if (!std::isnan(distance)) measured.push_back(distance);
      }
      if (!measured.empty()) pairs.push_back({Median(measured), nominal});
    }
  }
  return pairs;
}

constexpr double kUnitFactors[] = {1000.0, 1e-3, 100.0, 1e-2, 10.0, 0.1, 25.4, 1.0 / 25.4};

/// A wrong unit of all markers, by the distances between markers of one link.
std::optional<OtherUnit> FindUnitOfAll(const std::vector<PairOfMarkers>& pairs) {
  constexpr std::size_t kFewestPairs = 3;
  constexpr double kAlike = 1.3;      // largest ratio of a distance in the right unit to nominal
  constexpr double kMostShare = 0.8;  // least share of the pairs that one unit explains
  if (pairs.size() < kFewestPairs) return std::nullopt;
  for (const double factor : kUnitFactors) {
    const auto explained = std::count_if(pairs.begin(), pairs.end(), [&](const PairOfMarkers& of) {
      const double ratio = factor * of.measured / of.nominal;
      return ratio > 1.0 / kAlike && ratio < kAlike;
    });
    if (static_cast<double>(explained) < kMostShare * static_cast<double>(pairs.size())) continue;
    return OtherUnit{"", factor, pairs.front().measured, pairs.front().nominal};
  }
  return std::nullopt;
}

}  // namespace

std::optional<OtherUnit> FindOtherUnit(const Eigen::MatrixXd& positions,
                                       const std::vector<std::string>& names,
                                       const std::vector<Marker>& robot) {
  const std::vector<const Marker*> known = MarkersOf(names, robot);
  if (auto all = FindUnitOfAll(PairsOnLinks(positions, known))) return all;
  for (std::size_t m = 0; m < known.size(); ++m) {
    if (known[m] == nullptr) continue;
    std::vector<Mate> mates;
    for (std::size_t k = 0; k < known.size(); ++k) {
      if (k == m || known[k] == nullptr || known[k]->link != known[m]->link) continue;
      mates.push_back({static_cast<Eigen::Index>(3 * k),
                       (known[k]->p_link_marker - known[m]->p_link_marker).norm()});
    }
    if (mates.size() < kFewestMates) continue;
    const auto column = static_cast<Eigen::Index>(3 * m);
    OtherUnit found{known[m]->name, 1.0, OffMates(positions, column, mates, 1.0), kRightDistance};
    if (!(found.before > kWrongDistance)) continue;
    for (const double factor : kUnitFactors) {
      const double off = OffMates(positions, column, mates, factor);
      if (!(off < std::min(found.after, kLeftOfWrong * found.before))) continue;
      found.after = off;
      found.factor = factor;
    }
    if (found.factor != 1.0) return found;
  }
  return std::nullopt;
}

std::string Describe(const OtherUnit& found) {
  const bool small = found.factor > 1.0;
  char text[400];
  if (found.marker.empty()) {
    std::snprintf(
        text, sizeof text,
        "all positions are %.4g times too %s: two markers of one link are %.3g mm apart, where the "
        "project has %.3g mm, and others likewise. Are they in the unit in which they were read?",
        small ? found.factor : 1.0 / found.factor, small ? "small" : "large", 1e3 * found.before,
        1e3 * found.after);
    return text;
  }
  std::snprintf(
      text, sizeof text,
      "marker %s: its coordinates are %g times too %s: its distances to the other markers "
      "of its link are %.3g mm off those of the project, and %.3g mm once that is "
      "corrected; are all columns in one unit?",
      found.marker.c_str(), small ? found.factor : 1.0 / found.factor, small ? "small" : "large",
      1e3 * found.before, 1e3 * found.after);
  return text;
}

}  // namespace elastocal
