// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/log_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/measurement/recorded_joints.hpp"
#include "elastocal/robot/linkage.hpp"
#include "elastocal/robot/move_motors.hpp"
#include "elastocal/screening/positions_by_markers.hpp"

namespace elastocal {
namespace {

constexpr double kLeastRange = 0.1;         // rad: least range of a joint whose sign can be judged
constexpr double kLeastSlideRange = 0.03;   // m
constexpr double kLeastDiscrepancy = 0.06;  // rad: beyond errors of a robot
constexpr double kLeastSlideDiscrepancy = 0.015;  // m
constexpr double kFarBetter = 0.5;                // largest share of the discrepancy that is left
constexpr double kStill = 2e-5;                   // rad or m: encoders count in steps
constexpr double kAsLogged = 1e-6;                // rad or m
constexpr int kLeastFrozen = 2;                   // postures
constexpr int kLeastJudged = 4;                   // of a trial

/// Median of the absolute values, since single postures may be wrong.
double Typical(const Eigen::VectorXd& values) {
  return values.size() == 0 ? 0.0 : Median(values.cwiseAbs());
}

double Range(const Eigen::VectorXd& values) { return values.maxCoeff() - values.minCoeff(); }

/// Compares logged positions with those that the markers show, for all trials. Entries are those of
/// q, then the motors of the linkages: where rods move joints, the motors are logged.
class SuspicionSearch {
 public:
  SuspicionSearch(const ErrorModel& model, const Recording& recording)
      : tree_(model.tree),
        recording_(recording),
        logged_(recording.q),
        shown_(PositionsByMarkers(model, recording)) {
    for (const int joint : model.active_joints) {
      const int coordinate = tree_.joints[Size(joint)].coordinate;
      const bool known = std::count(entries_.begin(), entries_.end(), coordinate) > 0;
      if (!known && !IsMovedByRods(tree_, joint)) entries_.push_back(coordinate);
    }
    for (int c = 0; c < tree_.coordinate_count(); ++c) {
      const bool seen = std::count(entries_.begin(), entries_.end(), c) > 0;
      if (!seen && !IsMovedByRods(tree_, tree_.coordinate_joint[Size(c)])) unseen_.push_back(c);
    }
    for (std::size_t k = 0; k < tree_.linkages.size(); ++k) AddMotors(static_cast<int>(k));
  }

  std::vector<LogSuspicion> Run() {
    for (int trial = 0; trial < static_cast<int>(recording_.trials.size()); ++trial) {
      std::vector<int> postures;
      for (int i = 0; i < recording_.posture_count(); ++i) {
        if (recording_.trial[i] == trial) postures.push_back(i);
      }
      if (static_cast<int>(postures.size()) < kLeastJudged) continue;
      for (int a : entries_) {
        if (Range(Logged(a, postures)) >= LeastRange(a)) TrySign(a, postures);
        TryFrozen(a, postures);
        for (int b : entries_) {
          if (a < b) TryExchange(a, b, postures);
        }
        for (int b : unseen_) TryExchange(std::min(a, b), std::max(a, b), postures);
      }
    }
    FollowSigns();
    std::vector<LogSuspicion> found;
    for (auto& [key, suspicion] : found_) {
      const auto count = static_cast<double>(suspicion.postures.size());
      suspicion.before = std::sqrt(suspicion.before / count);
      suspicion.after = std::sqrt(suspicion.after / count);
      found.push_back(std::move(suspicion));
    }
    std::stable_sort(found.begin(), found.end(), [](const LogSuspicion& a, const LogSuspicion& b) {
      return Explains(a) > Explains(b);
    });
    return found;
  }

 private:
  static double Explains(const LogSuspicion& suspicion) {
    return static_cast<double>(suspicion.postures.size()) *
           (suspicion.before * suspicion.before - suspicion.after * suspicion.after);
  }

  /// Where markers do not show a linkage's joints, these and the motors are taken as logged.
  void AddMotors(int k) {
    const Linkage& linkage = tree_.linkages[Size(k)];
    const std::vector<int> joints = CoordinatesOf(tree_, linkage);
    const auto count = static_cast<Eigen::Index>(linkage.rods.size());
    const Eigen::Index first = logged_.cols();
    for (Eigen::MatrixXd* positions : {&logged_, &shown_}) {
      positions->conservativeResize(Eigen::NoChange, first + count);
    }
    for (Eigen::Index i = 0; i < logged_.rows(); ++i) {
      const auto logged = MotorPositions(tree_, linkage, logged_(i, joints).transpose());
      const auto shown = MotorPositions(tree_, linkage, shown_(i, joints).transpose());
      // Where the rods do not close, the motors are not judged.
      const Eigen::VectorXd unknown = logged.value_or(Eigen::VectorXd::Zero(count));
      logged_.row(i).tail(count) = unknown.transpose();
      shown_.row(i).tail(count) = (logged && shown ? *shown : unknown).transpose();
    }
    for (int rod = 0; rod < count; ++rod) {
      motors_.emplace_back(k, rod);
      entries_.push_back(static_cast<int>(first) + rod);
    }
  }

  bool IsMotor(int entry) const { return entry >= tree_.coordinate_count(); }
  std::pair<int, int> MotorOf(int entry) const {
    return motors_[Size(entry - tree_.coordinate_count())];
  }
  bool EntrySlides(int entry) const {
    if (!IsMotor(entry)) return JointOfCoordinate(tree_, entry).type == JointType::kPrismatic;
    const auto [linkage, rod] = MotorOf(entry);
    return LoggedPositionOf(tree_, linkage, rod).slides;
  }
  double LeastRange(int c) const { return EntrySlides(c) ? kLeastSlideRange : kLeastRange; }
  double LeastDiscrepancy(int c) const {
    return EntrySlides(c) ? kLeastSlideDiscrepancy : kLeastDiscrepancy;
  }
  Eigen::VectorXd Logged(int c, const std::vector<int>& postures) const {
    return logged_(postures, c);
  }
  Eigen::VectorXd Shown(int c, const std::vector<int>& postures) const {
    return shown_(postures, c);
  }

  /// Adds a mistake; the same mistake in several trials becomes one.
  void Add(LogContradiction kind, int a, int b, const std::vector<int>& postures, double before,
           double after) {
    LogSuspicion& suspicion = found_[{static_cast<int>(kind), a, b}];
    suspicion.kind = kind;
    suspicion.coordinate = IsMotor(a) ? MotorOf(a).second : a;
    suspicion.other = b >= 0 && IsMotor(b) ? MotorOf(b).second : b;
    suspicion.linkage = IsMotor(a) ? MotorOf(a).first : -1;
    suspicion.postures.insert(suspicion.postures.end(), postures.begin(), postures.end());
    const auto count = static_cast<double>(postures.size());
    suspicion.before += count * before * before;
    suspicion.after += count * after * after;
  }

  /// Judges the sign by the motion of the joint: its offset and wrong marker positions only add a
  /// constant to the shown positions.
  void TrySign(int c, const std::vector<int>& postures) {
    const auto varying = [](const Eigen::VectorXd& values) -> Eigen::VectorXd {
      return values.array() - Median(values);
    };
    const Eigen::VectorXd left = Shown(c, postures) - Logged(c, postures);
    const Eigen::VectorXd undone = Shown(c, postures) + Logged(c, postures);
    if (!AddSign(c, postures, Typical(left), Typical(undone))) {
      AddSign(c, postures, Typical(varying(left)), Typical(varying(undone)));
    }
  }

  bool AddSign(int c, const std::vector<int>& postures, double before, double after) {
    if (before < LeastDiscrepancy(c) || after > kFarBetter * before) return false;
    Add(LogContradiction::kSign, c, -1, postures, before, after);
    return true;
  }

  /// Adds trials to a reversed sign where the joint rests but is shown beyond zero.
  void FollowSigns() {
    std::vector<int> reversed;
    for (const auto& [key, suspicion] : found_) {
      if (suspicion.kind == LogContradiction::kSign) reversed.push_back(key[1]);
    }
    for (int trial = 0; trial < static_cast<int>(recording_.trials.size()); ++trial) {
      std::vector<int> postures;
      for (int i = 0; i < recording_.posture_count(); ++i) {
        if (recording_.trial[i] == trial) postures.push_back(i);
      }
      for (int c : reversed) {
        if (postures.empty() || Range(Logged(c, postures)) >= LeastRange(c)) continue;
        TrySign(c, postures);
      }
    }
    for (auto& [key, suspicion] : found_) {
      std::sort(suspicion.postures.begin(), suspicion.postures.end());
    }
  }

  /// Whether no marker shows the motion in the log, which may have been that of another joint.
  bool HidesMotion(int c, const std::vector<int>& postures) const {
    return (Shown(c, postures) - Logged(c, postures)).cwiseAbs().maxCoeff() < kAsLogged &&
           Range(Logged(c, postures)) >= LeastRange(c);
  }

  void TryExchange(int a, int b, const std::vector<int>& postures) {
    const auto has_column = [&](int c) { return IsMotor(c) || IsRecorded(recording_, tree_, c); };
    if (!has_column(a) || !has_column(b)) return;
    if (EntrySlides(a) != EntrySlides(b) || IsMotor(a) != IsMotor(b)) return;
    if (IsMotor(a) && MotorOf(a).first != MotorOf(b).first) return;
    const auto off = [&](int c, int by) {
      return HidesMotion(c, postures) ? 0.0 : Typical(Shown(c, postures) - Logged(by, postures));
    };
    const auto both = [&](int of_a, int of_b) { return std::hypot(off(a, of_a), off(b, of_b)); };
    const double before = both(a, b);
    const double after = both(b, a);
    if (before < LeastDiscrepancy(a) || after > kFarBetter * before) return;
    Add(LogContradiction::kExchange, a, b, postures, before, after);
  }

  void TryFrozen(int c, const std::vector<int>& postures) {
    if (Range(Logged(c, postures)) < kStill) return TryDead(c, postures);
    if (Range(Logged(c, postures)) < LeastRange(c)) return;  // it was not meant to move
    std::vector<int> longest;
    std::vector<int> run;
    for (int i : postures) {
      if (!run.empty() && std::abs(logged_(i, c) - logged_(run.front(), c)) > kStill) {
        run.clear();
      }
      run.push_back(i);
      if (run.size() > longest.size()) longest = run;
    }
    if (static_cast<int>(longest.size()) < kLeastFrozen) return;
    TakeHalfFrozen(c, postures, longest);
    std::vector<int> others;
    std::set_difference(postures.begin(), postures.end(), longest.begin(), longest.end(),
                        std::back_inserter(others));
    // A joint that rests while others move is also logged at one position, and the markers show it
    // at one. The first posture may have been reached before the joint froze.
    const Eigen::VectorXd shown = Shown(c, longest);
    if (Typical(shown.array() - Median(shown)) < 0.5 * LeastDiscrepancy(c)) return;
    const double before = Typical(shown - Logged(c, longest));
    const double after = Typical(Shown(c, others) - Logged(c, others));
    if (before < LeastDiscrepancy(c) || after > kFarBetter * before) return;
    Add(LogContradiction::kFrozen, c, -1, longest, before, after);
  }

  /// Adds a posture in which the joint froze or came back: its mean position is wrong.
  void TakeHalfFrozen(int c, const std::vector<int>& postures, std::vector<int>& frozen) const {
    const auto wrong = [&](int i) {
      return std::abs(shown_(i, c) - logged_(i, c)) >= LeastDiscrepancy(c);
    };
    const auto first = std::find(postures.begin(), postures.end(), frozen.front());
    const auto last = std::find(postures.begin(), postures.end(), frozen.back());
    if (last + 1 != postures.end() && wrong(last[1])) frozen.push_back(last[1]);
    if (first != postures.begin() && wrong(first[-1])) frozen.insert(frozen.begin(), first[-1]);
  }

  /// Finds a joint with one logged position in a trial, while the markers show it moving.
  void TryDead(int c, const std::vector<int>& postures) {
    const Eigen::VectorXd shown = Shown(c, postures);
    const double moved = Typical(shown.array() - Median(shown));
    if (moved >= LeastDiscrepancy(c)) Add(LogContradiction::kFrozen, c, -1, postures, moved, 0.0);
  }

  const RobotTree& tree_;
  const Recording& recording_;
  Eigen::MatrixXd logged_, shown_;           ///< postures x entries
  std::vector<int> entries_;                 ///< entries that move a marker
  std::vector<int> unseen_;                  ///< coordinates that move no marker
  std::vector<std::pair<int, int>> motors_;  ///< linkage and rod, of the entries beyond q
  std::map<std::array<int, 3>, LogSuspicion> found_;
};

std::string NameOfEntry(const LogSuspicion& suspicion, int entry, const RobotTree& tree) {
  return LoggedPositionOf(tree, suspicion.linkage, entry).name;
}

}  // namespace

std::vector<LogSuspicion> FindLogSuspicions(const ErrorModel& model, const Recording& recording) {
  if (recording.trials.empty()) return {};
  return SuspicionSearch(model, recording).Run();
}

std::vector<LogSuspicion> PossibleLogMistakes(const Recording& recording, const RobotTree& tree) {
  std::vector<LogSuspicion> signs, exchanges;
  if (!recording.trials.empty() || recording.posture_count() == 0) return signs;
  LogSuspicion sign, exchange{.kind = LogContradiction::kExchange};
  for (int i = 0; i < recording.posture_count(); ++i) sign.postures.push_back(i);
  exchange.postures = sign.postures;
  const auto add = [&](int linkage, const std::vector<int>& entries, const auto& slides) {
    sign.linkage = exchange.linkage = linkage;
    for (std::size_t a = 0; a < entries.size(); ++a) {
      sign.coordinate = exchange.coordinate = entries[a];
      signs.push_back(sign);
      for (std::size_t b = a + 1; b < entries.size(); ++b) {
        if (slides(entries[a]) != slides(entries[b])) continue;
        exchange.other = entries[b];
        exchanges.push_back(exchange);
      }
    }
  };
  for (std::size_t k = 0; k < tree.linkages.size(); ++k) {
    const std::vector<Rod>& rods = tree.linkages[k].rods;
    std::vector<int> motors(rods.size());
    std::iota(motors.begin(), motors.end(), 0);
    add(static_cast<int>(k), motors, [&](int motor) { return rods[Size(motor)].actuator; });
  }
  std::vector<int> moving;
  for (int c = 0; c < tree.coordinate_count(); ++c) {
    // Else its motors are logged.
    const bool logged = !IsMovedByRods(tree, tree.coordinate_joint[Size(c)]);
    if (logged && Range(recording.q.col(c)) > 0.0) moving.push_back(c);
  }
  add(-1, moving, [&](int c) { return JointOfCoordinate(tree, c).type == JointType::kPrismatic; });
  signs.insert(signs.end(), exchanges.begin(), exchanges.end());
  return signs;
}

std::string NameOf(const LogSuspicion& suspicion, const RobotTree& tree) {
  const std::string name = NameOfEntry(suspicion, suspicion.coordinate, tree);
  if (suspicion.kind == LogContradiction::kSign) return "sign:" + name;
  if (suspicion.kind == LogContradiction::kFrozen) return "frozen:" + name;
  const std::string other = NameOfEntry(suspicion, suspicion.other, tree);
  return "exchange:" + std::min(name, other) + "," + std::max(name, other);
}

std::string DescribeSuspicion(const LogSuspicion& suspicion, const RobotTree& tree,
                              const Recording& recording) {
  std::string text = NameOfEntry(suspicion, suspicion.coordinate, tree);
  switch (suspicion.kind) {
    case LogContradiction::kSign:
      text += ": the sign of its positions is reversed";
      break;
    case LogContradiction::kExchange:
      text += " and " + NameOfEntry(suspicion, suspicion.other, tree) +
              ": their positions are exchanged";
      break;
    case LogContradiction::kFrozen:
      text += suspicion.linkage >= 0 || IsRecorded(recording, tree, suspicion.coordinate)
                  ? ": its positions are frozen, while it moved, in "
                  : " is not recorded, and the project says that it stood still: it moved in ";
      text += std::to_string(suspicion.postures.size()) + " postures";
      break;
  }
  if (recording.trials.empty()) return text;
  std::vector<int> trials;
  for (int i : suspicion.postures) {
    if (trials.empty() || trials.back() != recording.trial[i]) trials.push_back(recording.trial[i]);
  }
  for (std::size_t k = 0; k < trials.size(); ++k) {
    text += (k == 0 ? " in trial " : ", ") + recording.trials[trials[k]].name;
  }
  return text;
}

}  // namespace elastocal
