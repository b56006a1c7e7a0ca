// SPDX-License-Identifier: Apache-2.0
#include "elastocal/motion/order.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "elastocal/math/interruption.hpp"

namespace elastocal {
namespace {

/// The stops of a closed tour, in order; the first one stays first. Stop 0 is the start, stop i + 1
/// is posture i.
using Tour = std::vector<int>;

double Length(const Eigen::MatrixXd& distance, const Tour& tour) {
  double length = 0.0;
  for (std::size_t i = 0; i < tour.size(); ++i) {
    length += distance(tour[i], tour[(i + 1) % tour.size()]);
  }
  return length;
}

/// The tour from `first` to the nearest stop not yet visited, and so on; then rotated to begin at
/// stop 0.
Tour NearestNeighbours(const Eigen::MatrixXd& distance, int first) {
  Tour tour(static_cast<std::size_t>(distance.rows()));
  std::iota(tour.begin(), tour.end(), 0);
  std::swap(tour[0], tour[static_cast<std::size_t>(first)]);
  for (std::size_t i = 1; i + 1 < tour.size(); ++i) {
    const auto from = tour.begin() + static_cast<std::ptrdiff_t>(i);
    std::iter_swap(from, std::min_element(from, tour.end(), [&](int a, int b) {
                     return distance(tour[i - 1], a) < distance(tour[i - 1], b);
                   }));
  }
  std::rotate(tour.begin(), std::find(tour.begin(), tour.end(), 0), tour.end());
  return tour;
}

/// A change of a tour: its stretch [first, last] is reversed, or moved behind the stop `behind`.
struct Change {
  double gain = 0.0;
  std::ptrdiff_t first = 0, last = 0, behind = -1;  // behind: -1: reversed where it is
  bool turned = true;
};

class LocalSearch {
 public:
  LocalSearch(const Eigen::MatrixXd& distance, Tour tour)
      : distance_(distance), tour_(std::move(tour)) {}

  Tour Run() {
    constexpr double kLeastGain = 1e-12;
    for (Change change = Best(); change.gain > kLeastGain; change = Best()) Apply(change);
    return tour_;
  }

 private:
  std::ptrdiff_t count() const { return static_cast<std::ptrdiff_t>(tour_.size()); }
  double Between(std::ptrdiff_t i, std::ptrdiff_t j) const {
    return distance_(tour_[static_cast<std::size_t>(i)],
                     tour_[static_cast<std::size_t>(j % count())]);
  }

  Change Best() const {
    constexpr std::ptrdiff_t kLongestMoved = 3;
    Change best;
    for (std::ptrdiff_t i = 1; i < count(); ++i) {
      InterruptionPoint();
      for (std::ptrdiff_t j = i + 1; j < count(); ++j) {
        const double gain =
            Between(i - 1, i) + Between(j, j + 1) - Between(i - 1, j) - Between(i, j + 1);
        if (gain > best.gain) best = {gain, i, j, -1, true};
      }
      for (std::ptrdiff_t j = i; j < std::min(i + kLongestMoved, count()); ++j) {
        Move(i, j, best);
      }
    }
    return best;
  }

  /// Tries every place for the stretch [i, j].
  void Move(std::ptrdiff_t i, std::ptrdiff_t j, Change& best) const {
    const double left = Between(i - 1, i) + Between(j, j + 1) - Between(i - 1, j + 1);
    for (std::ptrdiff_t k = 0; k < count(); ++k) {
      if (k >= i - 1 && k <= j) continue;
      const double opened = left + Between(k, k + 1);
      const double straight = opened - Between(k, i) - Between(j, k + 1);
      const double turned = opened - Between(k, j) - Between(i, k + 1);
      if (straight > best.gain) best = {straight, i, j, k, false};
      if (turned > best.gain) best = {turned, i, j, k, true};
    }
  }

  void Apply(const Change& change) {
    const auto first = tour_.begin() + change.first, end = tour_.begin() + change.last + 1;
    if (change.turned) std::reverse(first, end);
    if (change.behind < 0) return;
    if (change.behind > change.last) {
      std::rotate(first, end, tour_.begin() + change.behind + 1);
    } else {
      std::rotate(tour_.begin() + change.behind + 1, first, end);
    }
  }

  const Eigen::MatrixXd& distance_;
  Tour tour_;
};

}  // namespace

std::vector<int> OrderPostures(const Eigen::VectorXd& start,
                               const std::vector<Eigen::VectorXd>& postures) {
  const auto count = static_cast<Eigen::Index>(postures.size()) + 1;
  const auto stop = [&](Eigen::Index i) -> const Eigen::VectorXd& {
    return i == 0 ? start : postures[static_cast<std::size_t>(i - 1)];
  };
  Eigen::MatrixXd distance(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j) distance(i, j) = (stop(i) - stop(j)).norm();
  }
  Tour best;
  double shortest = std::numeric_limits<double>::infinity();
  for (int first = 0; first < count; ++first) {
    const Tour tour = LocalSearch(distance, NearestNeighbours(distance, first)).Run();
    if (Length(distance, tour) < shortest) {
      shortest = Length(distance, tour);
      best = tour;
    }
  }
  std::vector<int> order;
  for (std::size_t i = 1; i < best.size(); ++i) order.push_back(best[i] - 1);
  return order;
}

double TourLength(const Eigen::VectorXd& start, const std::vector<Eigen::VectorXd>& postures,
                  const std::vector<int>& order) {
  double length = 0.0;
  const Eigen::VectorXd* here = &start;
  for (const int i : order) {
    length += (postures[static_cast<std::size_t>(i)] - *here).norm();
    here = &postures[static_cast<std::size_t>(i)];
  }
  return length + (start - *here).norm();
}

}  // namespace elastocal
