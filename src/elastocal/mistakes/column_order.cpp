// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/column_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "elastocal/calibration/positions_by_markers.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/math/transform.hpp"
#include "elastocal/measurement/moments.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/robot/linkage.hpp"

namespace elastocal {
namespace {

constexpr double kFarFromNominal = 0.05;  // m: markers, beyond what errors of a robot do
constexpr double kFarShare = 0.025;       // of the size of a small robot
constexpr double kOffItsColumn = 0.06;    // rad: a joint from its column, beyond errors of a robot
constexpr double kLeftInOrder = 0.5;      // of what joints are off by
constexpr double kMovesOtherwise = 0.1;   // rad: range of a joint that moves
constexpr int kMostRounds = 4;            // of positions by markers and columns by positions
constexpr int kFewestInOrder = 4;         // postures of a trial
constexpr std::size_t kOfExchange = 2;
constexpr std::size_t kFewestToPlace = 4;  // markers

/// Median of the sizes.
double UsualSize(const Eigen::VectorXd& values) { return Median(values.cwiseAbs()); }

/// Of the marker that is furthest from the nominal robot, placed in each posture where it fits
/// best: the median distance, m.
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

/// One trial, in which columns may be in another order.
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

  /// By coordinate: the column that holds its positions; empty where they are in order.
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

  /// Coordinates whose column is a copy of another one's, with the other.
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
      if (!copies.empty() && copies.back().first == copy) continue;  // of one original
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

  /// A constant is an error of the robot.
  double VaryingOff(int c) const {
    const Eigen::VectorXd off = shown_.col(c) - given_.col(c);
    return UsualSize(off.array() - Median(off));
  }

  /// Root of the sum of squares, of what the markers show: their positions are not as logged.
  double Off(const Eigen::MatrixXd& q) const {
    double squares = 0.0;
    for (const int c : coordinates_) squares += std::pow(UsualSize(shown_.col(c) - q.col(c)), 2);
    return std::sqrt(squares);
  }

  bool IsShown(int c) const {
    return (shown_.col(c) - trial_.q.col(c)).cwiseAbs().maxCoeff() > 1e-6;
  }

  /// Joints that are where their columns have them keep these; of the others, the nearest first.
  std::vector<int> Assigned() const {
    std::vector<int> assigned(order_.size(), -1);
    std::vector<char> taken(order_.size(), 0);
    std::vector<int> open, hidden;
    for (std::size_t c = 0; c < order_.size(); ++c) {
      const auto at = static_cast<int>(c);
      const bool turns =
          std::find(coordinates_.begin(), coordinates_.end(), at) != coordinates_.end();
      const int column = order_[c];
      const bool kept =
          turns && IsShown(at) && UsualSize(shown_.col(at) - given_.col(column)) < kOffItsColumn;
      if (!turns || kept) {
        assigned[c] = column;
        taken[Size(column)] = 1;
      } else {
        (IsShown(at) ? open : hidden).push_back(at);
      }
    }
    while (!open.empty()) {
      double least = std::numeric_limits<double>::infinity();
      int joint = -1, column = -1;
      for (const int c : open) {
        for (const int k : coordinates_) {
          if (taken[Size(k)] != 0) continue;
          const double off = UsualSize(shown_.col(c) - given_.col(k));
          if (off < least) {
            least = off;
            joint = c;
            column = k;
          }
        }
      }
      if (joint < 0) return order_;
      assigned[Size(joint)] = column;
      taken[Size(column)] = 1;
      std::erase(open, joint);
    }
    // What no marker shows keeps its column or, if another joint has taken it, gets that one's.
    for (const int c : hidden) {
      if (taken[Size(c)] != 0) continue;
      assigned[Size(c)] = c;
      taken[Size(c)] = 1;
    }
    for (const int c : hidden) {
      if (assigned[Size(c)] >= 0) continue;
      int column = c;
      while (taken[Size(column)] != 0) {
        const auto by = std::find(assigned.begin(), assigned.end(), column);
        if (by == assigned.end()) return order_;
        column = static_cast<int>(by - assigned.begin());
      }
      assigned[Size(c)] = column;
      taken[Size(column)] = 1;
    }
    return assigned;
  }

  const ErrorModel& model_;
  Recording trial_;
  Eigen::MatrixXd given_;
  std::vector<int> coordinates_;  ///< of joints that turn, each with a column of its own
  std::vector<int> order_;
  Eigen::MatrixXd shown_;
};

std::string DescribeOrder(const std::vector<int>& order, const RobotTree& tree,
                          const std::string& trials) {
  const auto name = [&](int c) { return tree.joints[Size(tree.coordinate_joint[Size(c)])].name; };
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
  std::map<std::vector<int>, std::vector<int>> trials_of;  // by order
  std::vector<TriedCorrection> found;
  const auto name_of = [&](int c) {
    return tree.joints[Size(tree.coordinate_joint[Size(c)])].name;
  };
  struct Copied {
    Recording told;  ///< the copy where the markers show it
    std::string trials;
  };
  std::map<std::pair<int, int>, Copied> copied;  // by copy and original
  for (int trial = 0; trial < static_cast<int>(recording.trials.size()); ++trial) {
    const std::vector<int> postures = PosturesOfTrial(recording, trial);
    if (static_cast<int>(postures.size()) < kFewestInOrder) continue;
    OrderSearch search(nominal, SelectPostures(recording, postures));
    for (const auto& pair : search.Copies()) {
      Copied& one = copied.try_emplace(pair, Copied{recording, ""}).first->second;
      one.told.q(postures, pair.first) = search.shown().col(pair.first);
      one.trials += (one.trials.empty() ? "" : ", ") + recording.trials[Size(trial)].name;
    }
    if (FurthestMarker(model, geometry, recording, postures) < far) continue;
    const std::vector<int> order = search.Run();
    if (!order.empty()) trials_of[order].push_back(trial);
  }
  for (auto& [pair, one] : copied) {
    found.push_back({"",
                     fmt::format("{}: its column is a copy of that of {}, number for number, in "
                                 "trial {}, and the markers show it to move otherwise",
                                 name_of(pair.first), name_of(pair.second), one.trials),
                     std::move(one.told)});
  }
  for (const auto& [order, trials] : trials_of) {
    Recording ordered = recording;
    std::string names;
    for (const int trial : trials) {
      names += (names.empty() ? "" : ", ") + recording.trials[Size(trial)].name;
      for (const int i : PosturesOfTrial(recording, trial)) {
        for (std::size_t c = 0; c < order.size(); ++c) {
          ordered.q(i, static_cast<Eigen::Index>(c)) = recording.q(i, order[c]);
        }
      }
    }
    found.push_back({"", DescribeOrder(order, tree, names), std::move(ordered)});
  }
  return found;
}

}  // namespace elastocal
