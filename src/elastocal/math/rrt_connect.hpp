// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include <Eigen/Core>

namespace elastocal {

/// A box of points, and a rule that says which of them are free.
struct FreeSpace {
  Eigen::VectorXd lower, upper;
  std::function<bool(const Eigen::VectorXd& x)> free;  ///< whether a point is free
  double step = 0.05;     ///< distance between the points that are checked on a straight way
  int most_nodes = 2000;  ///< largest number of nodes, of both trees together
};

/// Whether the straight way between two points is free, as far as it is checked. The ends are taken
/// to be free.
bool StraightWayIsFree(const FreeSpace& space, const Eigen::VectorXd& from,
                       const Eigen::VectorXd& to);

/// A polygon of free ways between two points: corners x dimensions, the ends `from` and `to`
/// included, which are taken to be free. Two trees of random points grow towards each other
/// (RRT-Connect, Kuffner & LaValle 2000), and unnecessary corners are cut off. The same input gives
/// the same polygon. Returns nothing if none was found; there may be one all the same.
std::optional<Eigen::MatrixXd> ConnectByTrees(const FreeSpace& space, const Eigen::VectorXd& from,
                                              const Eigen::VectorXd& to);

class PointTree;

/// The points that can be reached from one point on free ways, by a tree of random points that
/// grows from it once.
class ReachableSpace {
 public:
  ReachableSpace(FreeSpace space, const Eigen::VectorXd& root);
  ReachableSpace(ReachableSpace&&) noexcept;
  ~ReachableSpace();

  /// Whether a way was found from the root to a free point. The same point gives the same answer.
  bool Reaches(const Eigen::VectorXd& x) const;

 private:
  FreeSpace space_;
  std::unique_ptr<PointTree> tree_;
};

/// `count` points at equal distances along a polygon, without its ends, points x dimensions.
Eigen::MatrixXd AlongPolygon(const Eigen::MatrixXd& corners, int count);

}  // namespace elastocal
