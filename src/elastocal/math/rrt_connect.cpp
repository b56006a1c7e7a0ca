// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/rrt_connect.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"

namespace elastocal {

/// A tree of points that are reached from the first one, each by a straight way from its parent.
class PointTree {
 public:
  explicit PointTree(Eigen::VectorXd root) : nodes_{std::move(root)}, parents_{-1} {}

  std::size_t size() const { return nodes_.size(); }
  const Eigen::VectorXd& operator[](int node) const { return nodes_[Size(node)]; }

  /// Grows from the nearest node straight towards a point, as far as the way is free. Returns the
  /// last node that was added; nothing if none was.
  std::optional<int> Grow(const FreeSpace& space, const Eigen::VectorXd& towards) {
    constexpr double kStride = 8.0;  // steps from node to node
    int last = Nearest(towards);
    std::optional<int> added;
    for (bool there = false; !there;) {
      const Eigen::VectorXd at = nodes_[Size(last)];
      const double distance = (towards - at).norm();
      const double stride = kStride * space.step;
      there = distance <= stride;
      const Eigen::VectorXd next = there ? towards : at + stride / distance * (towards - at);
      if (!space.free(next) || !StraightWayIsFree(space, at, next)) break;
      nodes_.push_back(next);
      parents_.push_back(last);
      last = static_cast<int>(nodes_.size()) - 1;
      added = last;
    }
    return added;
  }

  int Nearest(const Eigen::VectorXd& x) const {
    const auto nearer = [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
      return (a - x).squaredNorm() < (b - x).squaredNorm();
    };
    return static_cast<int>(std::min_element(nodes_.begin(), nodes_.end(), nearer) -
                            nodes_.begin());
  }

  /// The points from a node to the root.
  std::vector<Eigen::VectorXd> WayToRoot(int node) const {
    std::vector<Eigen::VectorXd> way;
    for (; node >= 0; node = parents_[Size(node)]) way.push_back(nodes_[Size(node)]);
    return way;
  }

 private:
  std::vector<Eigen::VectorXd> nodes_;
  std::vector<int> parents_;
};

namespace {

Eigen::VectorXd Draw(const FreeSpace& space, Random& random) {
  Eigen::VectorXd drawn(space.lower.size());
  for (Eigen::Index i = 0; i < drawn.size(); ++i) {
    drawn[i] = random.Uniform(space.lower[i], space.upper[i]);
  }
  return drawn;
}

/// Removes corners that a free straight way can skip.
void Shorten(const FreeSpace& space, std::vector<Eigen::VectorXd>& way) {
  for (std::size_t begin = 0; begin + 2 < way.size(); ++begin) {
    std::size_t end = way.size() - 1;
    while (end > begin + 1 && !StraightWayIsFree(space, way[begin], way[end])) --end;
    const auto first = way.begin() + static_cast<std::ptrdiff_t>(begin) + 1;
    way.erase(first, way.begin() + static_cast<std::ptrdiff_t>(end));
  }
}

Eigen::MatrixXd Polygon(const FreeSpace& space, std::vector<Eigen::VectorXd> way,
                        const std::vector<Eigen::VectorXd>& rest) {
  std::reverse(way.begin(), way.end());
  way.insert(way.end(), rest.begin() + 1, rest.end());  // they meet in one point
  Shorten(space, way);
  Eigen::MatrixXd corners(static_cast<Eigen::Index>(way.size()), way.front().size());
  for (Eigen::Index i = 0; i < corners.rows(); ++i) corners.row(i) = way[Size(i)].transpose();
  return corners;
}

}  // namespace

bool StraightWayIsFree(const FreeSpace& space, const Eigen::VectorXd& from,
                       const Eigen::VectorXd& to) {
  const auto steps = std::lround(std::ceil((to - from).norm() / space.step));
  for (long i = 1; i < steps; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(steps);
    if (!space.free(from + share * (to - from))) return false;
  }
  return true;
}

std::optional<Eigen::MatrixXd> ConnectByTrees(const FreeSpace& space, const Eigen::VectorXd& from,
                                              const Eigen::VectorXd& to) {
  Random random(1);
  PointTree begin(from), end(to);
  bool from_begin = true;
  for (int draws = 0; draws < space.most_nodes; ++draws, from_begin = !from_begin) {
    if (static_cast<int>(begin.size() + end.size()) > space.most_nodes) break;
    PointTree& grown = from_begin ? begin : end;
    PointTree& answering = from_begin ? end : begin;
    const auto node = grown.Grow(space, Draw(space, random));
    if (!node) continue;
    const auto answer = answering.Grow(space, grown[*node]);
    if (!answer || answering[*answer] != grown[*node]) continue;
    return Polygon(space, begin.WayToRoot(from_begin ? *node : *answer),
                   end.WayToRoot(from_begin ? *answer : *node));
  }
  return std::nullopt;
}

ReachableSpace::ReachableSpace(FreeSpace space, const Eigen::VectorXd& root)
    : space_(std::move(space)), tree_(std::make_unique<PointTree>(root)) {
  Random random(1);
  for (int draws = 0; draws < space_.most_nodes; ++draws) {
    if (static_cast<int>(tree_->size()) >= space_.most_nodes) break;
    tree_->Grow(space_, Draw(space_, random));
  }
}

ReachableSpace::ReachableSpace(ReachableSpace&&) noexcept = default;
ReachableSpace::~ReachableSpace() = default;

bool ReachableSpace::Reaches(const Eigen::VectorXd& x) const {
  constexpr int kMostDraws = 100;
  if (StraightWayIsFree(space_, (*tree_)[0], x)) return true;
  const auto joins = [&](const Eigen::VectorXd& node) {
    return StraightWayIsFree(space_, (*tree_)[tree_->Nearest(node)], node);
  };
  if (joins(x)) return true;
  Random random(1);
  PointTree from(x);
  for (int draws = 0; draws < kMostDraws; ++draws) {
    const auto node = from.Grow(space_, Draw(space_, random));
    if (node && joins(from[*node])) return true;
  }
  return false;
}

Eigen::MatrixXd AlongPolygon(const Eigen::MatrixXd& corners, int count) {
  const Eigen::Index sides = corners.rows() - 1;
  const Eigen::VectorXd lengths =
      (corners.bottomRows(sides) - corners.topRows(sides)).rowwise().norm();
  Eigen::MatrixXd points(count, corners.cols());
  for (int i = 0; i < count; ++i) {
    double left = lengths.sum() * (i + 1) / (count + 1);
    Eigen::Index side = 0;
    while (side + 1 < sides && left > lengths[side]) left -= lengths[side++];
    const double share = lengths[side] > 0.0 ? std::min(1.0, left / lengths[side]) : 0.0;
    points.row(i) = corners.row(side) + share * (corners.row(side + 1) - corners.row(side));
  }
  return points;
}

}  // namespace elastocal
