// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/column_order.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/measurement/moments.hpp"
#include "elastocal/measurement/trial_names.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/robot/linkage.hpp"
#include "elastocal/screening/positions_by_markers.hpp"

namespace elastocal {
namespace {

constexpr double kFarFromNominal = 0.05;  // m: distance of markers beyond the errors of a robot
constexpr double kFarShare = 0.025;       // share of the size of a small robot
// rad: deviation of a joint from its column beyond the errors of a robot
constexpr double kOffItsColumn = 0.06;
constexpr double kLeftInOrder = 0.5;     // share of the joints' deviation
constexpr double kMovesOtherwise = 0.1;  // rad: range of a joint that moves
constexpr int kMostRounds = 4;           // rounds of positions by markers and columns by positions
constexpr int kFewestInOrder = 4;        // postures of a trial
constexpr std::size_t kOfExchange = 2;
constexpr std::size_t kFewestToPlace = 4;  // markers

/// Median of the absolute values.
double UsualSize(const Eigen::VectorXd& values) { return Median(values.cwiseAbs()); }

/// Median distance, m, of the marker that is furthest from the nominal robot, which is placed best
/// in each posture.
double FurthestMarker(const ErrorModel& model, const Geometry& geometry, const Recording& recording,
                      const std::vector<int>& postures) {
  std::vector<std::vector<double>> distances(Size(model.marker_count()));
  for (const int i : postures) {
    const Eigen::Matrix3Xd nominal =
        MarkerPositions(model, geometry, recording.q.row(i).transpose());
    std::vector<int> seen;
    for (int m = 0; m < model.marker_count(); ++m) {
      if (Seen(recording, i, m)) seen.push_back(m);
    }
    if (seen.size() < kFewestToPlace) continue;
    const Eigen::Matrix3Xd from = nominal(Eigen::all, seen);
    Eigen::Matrix3Xd to(3, from.cols());
    for (std::size_t k = 0; k < seen.size(); ++k) {
      to.col(static_cast<Eigen::Index>(k)) = MarkerPosition(recording, i, seen[k]);
    }
    const Eigen::VectorXd left = (FitRigid(from, to) * from - to).colwise().norm();
    for (std::size_t k = 0; k < seen.size(); ++k) {
      distances[Size(seen[k])].push_back(left[static_cast<Eigen::Index>(k)]);
    }
  }
  double furthest = 0.0;
  for (const std::vector<double>& of_marker : distances) {
    if (!of_marker.empty()) furthest = std::max(furthest, Median(of_marker));
  }
  return furthest;
}

/// Search in one trial for columns in another order.
class OrderSearch {
 public:
  OrderSearch(const ErrorModel& model, Recording trial)
      : model_(model), trial_(std::move(trial)), given_(trial_.q) {
    const RobotTree& tree = model.tree;
    for (int c = 0; c < tree.coordinate_count(); ++c) {
      const int joint = tree.coordinate_joint[Size(c)];
      const bool turns = tree.joints[Size(joint)].type == JointType::kRevolute;
      if (turns && !IsMovedByRods(tree, joint)) coordinates_.push_back(c);
    }
  }

  /// For each coordinate: the column with its positions; empty where the columns are in order.
  std::vector<int> Run() {
    order_.resize(Size(given_.cols()));
    std::iota(order_.begin(), order_.end(), 0);
    shown_ = PositionsByMarkers(model_, trial_);
    const double before = Off(given_);
    for (int round = 0; round < kMostRounds; ++round) {
      const std::vector<int> next = Assigned();
      if (next == order_) break;
      order_ = next;
      for (Eigen::Index c = 0; c < given_.cols(); ++c) {
        trial_.q.col(c) = given_.col(order_[Size(c)]);
      }
      shown_ = PositionsByMarkers(model_, trial_);
    }
    std::size_t moved = 0;
    for (std::size_t c = 0; c < order_.size(); ++c) moved += order_[c] != static_cast<int>(c);
    if (moved <= kOfExchange || !(Off(trial_.q) < kLeftInOrder * before)) return {};
    return order_;
  }

  /// Coordinates whose column is a copy of another one's, with that other one.
  std::vector<std::pair<int, int>> Copies() {
    std::vector<std::pair<int, int>> equal, copies;
    for (const int a : coordinates_) {
      if (RangeOf(given_.col(a)) < kMovesOtherwise) continue;
      for (const int b : coordinates_) {
        if (a != b && given_.col(a) == given_.col(b)) equal.emplace_back(b, a);
      }
    }
    if (equal.empty()) return copies;
    shown_ = PositionsByMarkers(model_, trial_);
    std::sort(equal.begin(), equal.end());
    for (const auto& [copy, original] : equal) {
      if (!copies.empty() && copies.back().first == copy) continue;  // copies of the same original
      const double off = VaryingOff(copy);
      if (off > kOffItsColumn && VaryingOff(original) < kLeftInOrder * off) {
        copies.emplace_back(copy, original);
      }
    }
    return copies;
  }

  const Eigen::MatrixXd& shown() const { return shown_; }

 private:
  static double RangeOf(const Eigen::VectorXd& values) {
    return values.maxCoeff() - values.minCoeff();
  }

  /// Deviation without its constant part, which is an error of the robot.
  double VaryingOff(int c) const {
    const Eigen::VectorXd off = shown_.col(c) - given_.col(c);
    return UsualSize(off.array() - Median(off));
  }

  /// Root of the sum of squared deviations of the positions by the markers from the log.
  double Off(const Eigen::MatrixXd& q) const {
    double squares = 0.0;
    for (const int c : coordinates_) squares += std::pow(UsualSize(shown_.col(c) - q.col(c)), 2);
    return std::sqrt(squares);
  }

  bool IsShown(int c) const {
    return (shown_.col(c) - trial_.q.col(c)).cwiseAbs().maxCoeff() > 1e-6;
  }

  double OffColumn(int joint, int column) const {
    return UsualSize(shown_.col(joint) - given_.col(column));
  }

  /// Column of each coordinate; -1: none yet.
  struct Columns {
    std::vector<int> of;
    std::vector<char> taken;

    void Give(int joint, int column) {
      of[Size(joint)] = column;
      taken[Size(column)] = 1;
    }
  };

  /// Assigns columns: joints that agree with their columns keep them; the others get the nearest
  /// first.
  std::vector<int> Assigned() const {
    Columns columns{std::vector<int>(order_.size(), -1), std::vector<char>(order_.size(), 0)};
    std::vector<int> open, hidden;
    for (int c = 0; c < static_cast<int>(order_.size()); ++c) {
      const bool turns =
          std::find(coordinates_.begin(), coordinates_.end(), c) != coordinates_.end();
      const int column = order_[Size(c)];
      if (!turns || (IsShown(c) && OffColumn(c, column) < kOffItsColumn)) {
        columns.Give(c, column);
      } else {
        (IsShown(c) ? open : hidden).push_back(c);
      }
    }
    return GiveNearest(open, columns) && GiveLeft(hidden, columns) ? columns.of : order_;
  }

  /// Whether each of these joints, which markers show, finds a column.
  bool GiveNearest(std::vector<int> joints, Columns& columns) const {
    struct Distance {
      double off;
      int joint, column;
    };
    std::vector<Distance> distances;
    for (const int joint : joints) {
      for (const int column : coordinates_) {
        if (columns.taken[Size(column)] != 0) continue;
        distances.push_back({OffColumn(joint, column), joint, column});
      }
    }
    std::stable_sort(distances.begin(), distances.end(),
                     [](const Distance& a, const Distance& b) { return a.off < b.off; });
    for (const Distance& nearest : distances) {
      if (columns.taken[Size(nearest.column)] != 0 || columns.of[Size(nearest.joint)] >= 0)
        continue;
      columns.Give(nearest.joint, nearest.column);
      std::erase(joints, nearest.joint);
    }
    return joints.empty();
  }

  /// Joints that no marker shows keep their columns; if another joint has taken it, they get that
  /// joint's. Returns whether each finds one.
  bool GiveLeft(const std::vector<int>& joints, Columns& columns) const {
    for (const int c : joints) {
      if (columns.taken[Size(c)] == 0) columns.Give(c, c);
    }
    for (const int c : joints) {
      if (columns.of[Size(c)] >= 0) continue;
      int column = c;
      while (columns.taken[Size(column)] != 0) {
        const auto by = std::find(columns.of.begin(), columns.of.end(), column);
        if (by == columns.of.end()) return false;
        column = static_cast<int>(by - columns.of.begin());
      }
      columns.Give(c, column);
    }
    return true;
  }

  const ErrorModel& model_;
  Recording trial_;
  Eigen::MatrixXd given_;
  std::vector<int> coordinates_;  ///< coordinates of revolute joints with their own columns
  std::vector<int> order_;
  Eigen::MatrixXd shown_;
};

std::string DescribeOrder(const std::vector<int>& order, const RobotTree& tree,
                          const std::string& trials) {
  const auto name = [&](int c) { return JointOfCoordinate(tree, c).name; };
  std::string text;
  for (std::size_t c = 0; c < order.size(); ++c) {
    const auto at = static_cast<int>(c);
    if (order[c] == at) continue;
    const bool pair = order[Size(order[c])] == at;
    if (pair && order[c] < at) continue;
    text += (text.empty() ? "" : ", ") +
            (pair ? name(at) + " and " + name(order[c]) + " have each other's"
                  : name(at) + " has the one of " + name(order[c]));
  }
  return "the columns of the joint log are in another order than its header says in trial " +
         trials + ": " + text;
}

}  // namespace

std::vector<TriedCorrection> FindColumnOrders(const ErrorModel& nominal,
                                              const Recording& recording) {
  const RobotTree& tree = nominal.tree;
  ErrorModel model = nominal;
  Geometry geometry = ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
  PlaceWaist(Transform::Identity(), Vector6d::Zero(), geometry);
  const double far = std::min(kFarFromNominal, kFarShare * RobotSize(tree));
  std::map<std::vector<int>, std::vector<int>> trials_of;  // trials by order
  std::vector<TriedCorrection> found;
  const auto name_of = [&](int c) { return JointOfCoordinate(tree, c).name; };
  struct Copied {
    Recording told;  ///< the recording with the copy as the markers show it
    std::vector<int> trials;
  };
  std::map<std::pair<int, int>, Copied> copied;  // by copy and original
  for (int trial = 0; trial < static_cast<int>(recording.trials.size()); ++trial) {
    const std::vector<int> postures = PosturesOfTrial(recording, trial);
    if (static_cast<int>(postures.size()) < kFewestInOrder) continue;
    OrderSearch search(nominal, SelectPostures(recording, postures));
    for (const auto& pair : search.Copies()) {
      Copied& one = copied.try_emplace(pair, Copied{recording, {}}).first->second;
      one.told.q(postures, pair.first) = search.shown().col(pair.first);
      one.trials.push_back(trial);
    }
    if (FurthestMarker(model, geometry, recording, postures) < far) continue;
    const std::vector<int> order = search.Run();
    if (!order.empty()) trials_of[order].push_back(trial);
  }
  for (auto& [pair, one] : copied) {
    found.push_back(
        {"",
         fmt::format("{}: its column is a copy of that of {}, number for number, in "
                     "trial {}, and the markers show it to move otherwise",
                     name_of(pair.first), name_of(pair.second), TrialNames(recording, one.trials)),
         std::move(one.told)});
  }
  for (const auto& [order, trials] : trials_of) {
    Recording ordered = recording;
    for (const int trial : trials) {
      for (const int i : PosturesOfTrial(recording, trial)) {
        for (std::size_t c = 0; c < order.size(); ++c) {
          ordered.q(i, static_cast<Eigen::Index>(c)) = recording.q(i, order[c]);
        }
      }
    }
    found.push_back(
        {"", DescribeOrder(order, tree, TrialNames(recording, trials)), std::move(ordered)});
  }
  return found;
}

}  // namespace elastocal
