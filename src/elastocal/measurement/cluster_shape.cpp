// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/cluster_shape.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr Eigen::Index kMostFrames = 4000;  // give a median to 2 % of the noise
constexpr int kAllPermutationsUpTo = 5;     // 120 of them
constexpr double kLeastUsual = 0.05;        // least share of the frames with a usual distance

std::vector<Permutation> ListPermutations(int size) {
  Permutation order(static_cast<std::size_t>(size));
  std::iota(order.begin(), order.end(), 0);
  std::vector<Permutation> list{order};
  if (size <= kAllPermutationsUpTo) {
    while (std::next_permutation(order.begin(), order.end())) list.push_back(order);
    return list;
  }
  for (int i = 0; i < size; ++i) {
    for (int j = i + 1; j < size; ++j) {
      list.push_back(list[0]);
      std::swap(list.back()[i], list.back()[j]);
    }
  }
  return list;
}

// Minimum, over all orders except the identity, of the largest change of a distance, in tolerances.
double Separation(const ClusterShape& shape) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t p = 1; p < shape.permutations.size(); ++p) {
    const Permutation& order = shape.permutations[p];
    double largest = 0.0;
    for (int i = 0; i < shape.size; ++i) {
      for (int j = i + 1; j < shape.size; ++j) {
        const int pair = PairColumn(i, j, shape.size);
        const int other = PairColumn(order[i], order[j], shape.size);
        const double change = std::abs(shape.distances[pair] - shape.distances[other]);
        const double tolerance = std::max(shape.tolerances[pair], shape.tolerances[other]);
        if (change > largest * tolerance) largest = change / tolerance;  // false for NaN
      }
    }
    least = std::min(least, largest);
  }
  return least;
}

bool Agree(double distance, double usual, double tolerance) {
  return !(std::abs(distance - usual) > tolerance);  // true also if one of them is unknown (NaN)
}

// Whether the distances under an order of the labels are the usual ones.
bool HasUsual(const ClusterShape& shape, const Permutation& order, const Eigen::VectorXd& usual) {
  for (int i = 0; i < shape.size; ++i) {
    for (int j = i + 1; j < shape.size; ++j) {
      const int pair = PairColumn(i, j, shape.size);
      const int other = PairColumn(order[i], order[j], shape.size);
      if (!Agree(shape.distances[other], usual[pair], shape.tolerances[other])) return false;
    }
  }
  return true;
}

// The values near the usual one if they are at least `kLeastUsual` of all; else nothing.
std::vector<double> NearUsual(const std::vector<double>& values, double usual, double tolerance) {
  std::vector<double> near;
  std::copy_if(values.begin(), values.end(), std::back_inserter(near),
               [&](double value) { return std::abs(value - usual) <= tolerance; });
  if (kLeastUsual * static_cast<double>(values.size()) > static_cast<double>(near.size())) {
    near.clear();
  }
  return near;
}

}  // namespace

double DensestMedian(std::vector<double> values, double width) {
  std::sort(values.begin(), values.end());
  std::size_t best_begin = 0;
  std::size_t best_end = 0;
  for (std::size_t begin = 0, end = 0; begin < values.size(); ++begin) {
    while (end < values.size() && values[end] <= values[begin] + width) ++end;
    if (end - begin > best_end - best_begin) {
      best_begin = begin;
      best_end = end;
    }
  }
  return Median(std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(best_begin),
                                    values.begin() + static_cast<std::ptrdiff_t>(best_end)));
}

int PairColumn(int i, int j, int size) {
  const int low = std::min(i, j);
  const int high = std::max(i, j);
  return low * (2 * size - low - 1) / 2 + high - low - 1;
}

DistanceTable MeasureDistances(const MarkerTrajectories& trajectories,
                               const std::vector<int>& markers) {
  const int size = static_cast<int>(markers.size());
  DistanceTable table(trajectories.frame_count(), size * (size - 1) / 2);
  for (int i = 0; i < size; ++i) {
    for (int j = i + 1; j < size; ++j) {
      const auto a = trajectories.positions.middleCols<3>(3 * markers[i]);
      const auto b = trajectories.positions.middleCols<3>(3 * markers[j]);
      table.col(PairColumn(i, j, size)) =
          ((a.col(0) - b.col(0)).array().square() + (a.col(1) - b.col(1)).array().square() +
           (a.col(2) - b.col(2)).array().square())
              .sqrt();
    }
  }
  return table;
}

bool ClusterShape::Fits(const Eigen::Ref<const Eigen::RowVectorXd>& frame,
                        const Permutation& permutation, int without) const {
  for (int i = 0, pair = 0; i < size; ++i) {
    for (int j = i + 1; j < size; ++j, ++pair) {
      const int a = permutation[i];
      const int b = permutation[j];
      if (a == without || b == without) continue;
      const double distance = frame[PairColumn(a, b, size)];
      if (std::abs(distance - distances[pair]) > tolerances[pair]) return false;  // not for NaN
    }
  }
  return true;
}

ClusterShape MeasureShape(const DistanceTable& table, int size, double tolerance_sd,
                          double least_tolerance_m, const Eigen::VectorXd& usual) {
  ClusterShape shape;
  shape.size = size;
  shape.permutations = ListPermutations(size);
  shape.distances.resize(table.cols());
  shape.tolerances.resize(table.cols());
  const Eigen::Index stride = std::max<Eigen::Index>(1, table.rows() / kMostFrames);
  for (Eigen::Index pair = 0; pair < table.cols(); ++pair) {
    std::vector<double> values;
    std::vector<double> steps;
    for (Eigen::Index frame = 0; frame < table.rows(); frame += stride) {
      InterruptionPoint();
      const double value = table(frame, pair);
      if (std::isnan(value)) continue;
      values.push_back(value);
      if (frame + 1 == table.rows()) continue;
      const double step = std::abs(table(frame + 1, pair) - value);
      if (!std::isnan(step)) steps.push_back(step);
    }
    const double sd = steps.empty() ? 0.0 : kNormalMad * Median(steps) / std::sqrt(2.0);
    shape.tolerances[pair] = std::max(least_tolerance_m, tolerance_sd * sd);
    if (usual.size() > 0) {
      const std::vector<double> near = NearUsual(values, usual[pair], shape.tolerances[pair]);
      if (!near.empty()) values = near;
    }
    shape.distances[pair] = DensestMedian(std::move(values), 2.0 * shape.tolerances[pair]);
  }
  if (usual.size() > 0 && !HasUsual(shape, shape.permutations.front(), usual)) {
    const bool exchanged =
        std::any_of(shape.permutations.begin() + 1, shape.permutations.end(),
                    [&](const Permutation& order) { return HasUsual(shape, order, usual); });
    // What is not known of the usual shape stays unknown: labels there cannot be told.
    if (exchanged) shape.distances = usual;
  }
  shape.separation = Separation(shape);
  return shape;
}

}  // namespace elastocal
