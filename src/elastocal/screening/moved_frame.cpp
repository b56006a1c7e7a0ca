// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/moved_frame.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/math/transform.hpp"

namespace elastocal {
namespace {

constexpr int kFewestOnRoot = 3;
constexpr int kFewestAside = 4;        // postures before and after
constexpr double kCertain = 10.0;      // standard deviations of the sum of squares
constexpr double kLeastMove = 1.5e-3;  // m
constexpr double kMostUnequal = 9.0;   // ratio of squares between the two sides
constexpr double kNotRigid = 0.3;      // share of the displacement that a rigid one leaves

/// Measured positions of the markers on the root link, by posture.
struct RootSightings {
  std::vector<int> markers, postures;
  Eigen::MatrixXd positions;  ///< postures x 3 markers, m
};

RootSightings SightingsOfRoot(const ErrorModel& model, const Recording& recording) {
  RootSightings root;
  for (int m = 0; m < recording.marker_count(); ++m) {
    if (model.tree.links[Size(model.markers[Size(m)].link)].body == 0) root.markers.push_back(m);
  }
  for (int i = 0; i < recording.posture_count(); ++i) {
    bool all = true;
    for (const int m : root.markers) all = all && Seen(recording, i, m);
    if (all) root.postures.push_back(i);
  }
  root.positions.resize(static_cast<Eigen::Index>(root.postures.size()),
                        3 * static_cast<Eigen::Index>(root.markers.size()));
  for (std::size_t row = 0; row < root.postures.size(); ++row) {
    for (std::size_t k = 0; k < root.markers.size(); ++k) {
      root.positions.block<1, 3>(static_cast<Eigen::Index>(row), 3 * static_cast<Eigen::Index>(k)) =
          MarkerPosition(recording, root.postures[row], root.markers[k]).transpose();
    }
  }
  return root;
}

Eigen::Matrix3Xd AsColumns(const Eigen::RowVectorXd& positions) {
  return positions.reshaped(3, positions.size() / 3);
}

/// The row from which on the positions differ by at least `kCertain`; 0: none.
Eigen::Index RowOfChange(const Eigen::MatrixXd& positions) {
  const Eigen::Index count = positions.rows(), size = positions.cols();
  const auto expected = static_cast<double>(size);
  double most = expected + kCertain * std::sqrt(2.0 * expected);
  Eigen::Index found = 0;
  for (Eigen::Index row = kFewestAside; row <= count - kFewestAside; ++row) {
    const Eigen::RowVectorXd before = positions.topRows(row).colwise().mean();
    const Eigen::RowVectorXd after = positions.bottomRows(count - row).colwise().mean();
    const double within = (positions.topRows(row).rowwise() - before).squaredNorm() +
                          (positions.bottomRows(count - row).rowwise() - after).squaredNorm();
    const double variance = within / static_cast<double>((count - 2) * size);
    const double of_means = 1.0 / static_cast<double>(row) + 1.0 / static_cast<double>(count - row);
    const double squares = (after - before).squaredNorm() / (variance * of_means);
    if (squares <= most) continue;
    most = squares;
    found = row;
  }
  return found;
}

/// Squared distances of rows from their median row, m^2: their median, and the mean without the
/// furthest tenth, which may be mistakes of the cameras.
struct RowScatter {
  double median = 0.0, mean = 0.0;
};

RowScatter ScatterOfRows(const Eigen::MatrixXd& rows) {
  Eigen::RowVectorXd middle(rows.cols());
  for (Eigen::Index c = 0; c < rows.cols(); ++c) middle[c] = Median(Eigen::VectorXd(rows.col(c)));
  Eigen::VectorXd squares = (rows.rowwise() - middle).rowwise().squaredNorm();
  std::sort(squares.begin(), squares.end());
  const Eigen::Index most = std::max<Eigen::Index>(1, squares.size() - squares.size() / 10);
  return {Median(squares), squares.head(most).mean()};
}

/// Whether the root link stands still on both sides of a row, equally well; otherwise it moves for
/// a while.
bool StaysOnBothSides(const Eigen::MatrixXd& positions, Eigen::Index row) {
  const RowScatter before = ScatterOfRows(positions.topRows(row));
  const RowScatter after = ScatterOfRows(positions.bottomRows(positions.rows() - row));
  const double least = std::min(before.median, after.median);
  return std::max({before.mean, after.mean, before.median, after.median}) < kMostUnequal * least;
}

/// Root mean square displacement, by a motion of the frame, of the markers that are not on the root
/// link, m.
double DisplacedBy(const Transform& move, const ErrorModel& model, const Recording& recording) {
  double squares = 0.0;
  int count = 0;
  for (int m = 0; m < recording.marker_count(); ++m) {
    if (model.tree.links[Size(model.markers[Size(m)].link)].body == 0) continue;
    for (int i = 0; i < recording.posture_count(); ++i) {
      if (!Seen(recording, i, m)) continue;
      const Eigen::Vector3d position = MarkerPosition(recording, i, m);
      squares += (move * position - position).squaredNorm();
      ++count;
    }
  }
  return count == 0 ? 0.0 : std::sqrt(squares / count);
}

}  // namespace

std::optional<MovedFrame> FindMovedFrame(const ErrorModel& model, const Recording& recording) {
  if (HasPoseByPosture(recording)) return std::nullopt;
  const RootSightings root = SightingsOfRoot(model, recording);
  if (root.markers.size() < kFewestOnRoot) return std::nullopt;
  const Eigen::Index row = RowOfChange(root.positions);
  if (row == 0 || !StaysOnBothSides(root.positions, row)) return std::nullopt;
  const Eigen::Index after_count = root.positions.rows() - row;
  const Eigen::Matrix3Xd before = AsColumns(root.positions.topRows(row).colwise().mean());
  const Eigen::Matrix3Xd after = AsColumns(root.positions.bottomRows(after_count).colwise().mean());
  const Transform move = FitRigid(before, after);
  if ((move * before - after).norm() > kNotRigid * (after - before).norm()) return std::nullopt;
  MovedFrame moved{.posture = root.postures[Size(row)],
                   .markers = {},
                   .shift = (after - before).rowwise().mean().norm(),
                   .angle = Eigen::AngleAxisd(move.linear()).angle(),
                   .displaced = DisplacedBy(move, model, recording)};
  if (moved.displaced < kLeastMove) return std::nullopt;
  for (const int m : root.markers) moved.markers.push_back(recording.marker_names[Size(m)]);
  return moved;
}

}  // namespace elastocal
