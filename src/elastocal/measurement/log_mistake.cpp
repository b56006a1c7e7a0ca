// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/log_mistake.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "elastocal/measurement/clock_by_positions.hpp"

namespace elastocal {
namespace {

constexpr double kLeastMotion = 0.05;  // rad or m: range of a joint that can be wrong
constexpr double kLeastPeak = 0.9;     // least correlation of a log that is right
constexpr double kFitsAsItIs = 0.999;  // above this correlation, only noise is left
constexpr double kFarBetter = 0.25;    // largest share that is left of 1 - correlation
constexpr int kFewestMoved = 3;        // columns: two that are shifted are exchanged
constexpr double kLeastFrozen_s = 2.0;
constexpr double kJumpSpreads_s = 1.2;       // the filter spreads the jump at either end
constexpr double kPartFits = 0.9;            // correlation in a part of the log that is not wrong
constexpr double kAboutAsLikely = 0.9;       // share of the best peak: both lags are possible
constexpr double kNearer = 0.9;              // largest ratio of residuals of positions
constexpr std::size_t kMostByPositions = 6;  // mistakes whose positions are compared

/// For each coordinate, whether its joint is between the root link and a marker.
std::vector<char> OnTheWay(const MarkedRobot& robot, const std::vector<int>& markers) {
  std::vector<char> on_way(robot.tree.coordinate_count(), 0);
  for (int m : markers) {
    for (int joint : JointsToBody(robot.tree, robot.tree.links[robot.markers[m].link].body)) {
      on_way[robot.tree.joints[joint].coordinate] = 1;
    }
  }
  return on_way;
}

bool Moves(const SmoothedLog& log, int column) {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (const LogPiece& piece : log.pieces) {
    lowest = std::min(lowest, piece.values.col(column).minCoeff());
    highest = std::max(highest, piece.values.col(column).maxCoeff());
  }
  return highest - lowest > kLeastMotion;
}

/// Columns of joints that move and are between the root link and a marker.
std::vector<int> MovingColumns(const MarkedRobot& robot, const std::vector<int>& markers,
                               const SmoothedLog& log, const std::vector<int>& coordinates) {
  const std::vector<char> on_way = OnTheWay(robot, markers);
  std::vector<int> moving;
  for (int c = 0; c < log.joints; ++c) {
    if (on_way[coordinates[c]] != 0 && Moves(log, c)) moving.push_back(c);
  }
  return moving;
}

/// All runs of neighbouring columns whose joints follow each other in a limb, each shifted by one
/// in both directions.
std::vector<LogMistake> MovedBlocks(const MarkedRobot& robot, const std::vector<int>& markers,
                                    const std::vector<int>& coordinates, int count) {
  const RobotTree& tree = robot.tree;
  const std::vector<char> on_way = OnTheWay(robot, markers);
  const auto joint_of = [&](int c) -> const Joint& {
    return tree.joints[tree.coordinate_joint[coordinates[c]]];
  };
  const auto carries = [&](int c) {  // whether the joint of column c carries that of the next one
    return on_way[coordinates[c + 1]] != 0 &&
           joint_of(c + 1).parent_body == tree.links[joint_of(c).child_link].body;
  };
  std::vector<LogMistake> blocks;
  for (int begin = 0; begin < count; ++begin) {
    if (on_way[coordinates[begin]] == 0) continue;
    for (int end = begin; end + 1 < count && carries(end); ++end) {
      if (end + 1 - begin < kFewestMoved - 1) continue;
      for (const int by : {1, -1}) {
        blocks.push_back({.column = begin, .exchanged = end + 1, .moved = by});
      }
    }
  }
  return blocks;
}

/// Begin and end, in robot time, of the longest part of the log in which a joint stays in one place
/// while the others move by `kOthersMoved` in all; equal if there is none.
std::pair<double, double> LongestStill(const SmoothedLog& log, const std::vector<int>& columns,
                                       int column) {
  constexpr double kStill = 2e-5;       // rad or m
  constexpr double kOthersMoved = 0.5;  // rad or m, the sum over others of their ways
  std::pair<double, double> longest{0.0, 0.0};
  for (const LogPiece& piece : log.pieces) {
    Eigen::Index begin = 0;
    double way = 0.0;
    for (Eigen::Index i = 1; i < piece.values.rows(); ++i) {
      if (std::abs(piece.values(i, column) - piece.values(begin, column)) > kStill) {
        begin = i;
        way = 0.0;
        continue;
      }
      for (const int other : columns) {
        way += std::abs(piece.values(i, other) - piece.values(i - 1, other));
      }
      const double length = static_cast<double>(i - begin) / piece.rate_hz;
      if (way < kOthersMoved || length <= longest.second - longest.first) continue;
      const double from = piece.start_s + static_cast<double>(begin) / piece.rate_hz;
      longest = {from, from + length};
    }
  }
  return longest;
}

/// The log without the part from `begin_s` to `end_s`, robot time.
SmoothedLog WithoutSpan(const SmoothedLog& log, double begin_s, double end_s) {
  SmoothedLog left = log;
  left.pieces.clear();
  const auto add = [&](const LogPiece& piece, Eigen::Index first, Eigen::Index count) {
    if (static_cast<double>(count) < 4.0 * log.margin_s * piece.rate_hz + 4.0) return;
    left.pieces.push_back({piece.start_s + static_cast<double>(first) / piece.rate_hz,
                           piece.rate_hz, piece.values.middleRows(first, count)});
  };
  for (const LogPiece& piece : log.pieces) {
    const Eigen::Index rows = piece.values.rows();
    const auto row = [&](double time_s) {
      const double at = (time_s - piece.start_s) * piece.rate_hz;
      return static_cast<Eigen::Index>(std::clamp(at, 0.0, static_cast<double>(rows)));
    };
    const Eigen::Index first = row(begin_s), last = row(end_s);
    add(piece, 0, first);
    add(piece, last, rows - last);
  }
  return left;
}

/// Correlation of measured and logged speeds from `begin_s` to `end_s` of the robot's time. At each
/// moment, both speeds are means over the markers that are seen then.
double CorrelationOfPart(const LoggedSpeeds& logged, const Eigen::MatrixXd& measured,
                         double rate_hz, const ClockFit& clock, double begin_s, double end_s) {
  std::vector<double> by_log, by_cameras;
  for (Eigen::Index i = 0; i < logged.time_s.size(); ++i) {
    if (logged.time_s[i] < begin_s || logged.time_s[i] > end_s) continue;
    const Eigen::Index frame = std::llround(clock.CameraTime(logged.time_s[i]) * rate_hz);
    if (frame < 0 || frame >= measured.rows()) continue;
    const Eigen::ArrayXd seen = measured.row(frame).transpose();
    const auto count = static_cast<double>(seen.size() - seen.isNaN().count());
    if (count == 0.0) continue;
    by_cameras.push_back(seen.isNaN().select(0.0, seen).sum() / count);
    by_log.push_back(seen.isNaN().select(0.0, logged.speeds.row(i).transpose().array()).sum() /
                     count);
  }
  if (by_log.empty()) return 0.0;
  const auto size = static_cast<Eigen::Index>(by_log.size());
  Eigen::ArrayXd a = Eigen::ArrayXd::Map(by_log.data(), size);
  Eigen::ArrayXd b = Eigen::ArrayXd::Map(by_cameras.data(), size);
  a -= a.mean();
  b -= b.mean();
  return (a * b).sum() / std::sqrt(a.square().sum() * b.square().sum());
}

/// A mistake, and the clock by the log without it.
struct Candidate {
  LogMistake mistake;
  ClockFit fit;
};

/// Of the candidates with the best correlations (at most `kMostByPositions`), the one with the
/// smallest residuals of positions (`left_by`).
template <typename LeftBy>
std::optional<Candidate> BestByPositions(std::vector<Candidate> candidates, const LeftBy& left_by) {
  if (candidates.empty()) return std::nullopt;
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return a.mistake.peak > b.mistake.peak; });
  if (candidates.size() > kMostByPositions) candidates.resize(kMostByPositions);
  const Candidate* best = &candidates.front();
  if (candidates.size() == 1) return *best;
  double least = left_by(*best);
  for (const Candidate& one : candidates) {
    const double left = left_by(one);
    if (!(left < least)) continue;
    least = left;
    best = &one;
  }
  return *best;
}

/// The clock or, if two lags are about as likely, the one with the smaller residuals of positions.
template <typename LeftBy>
ClockFit NearestClock(const SmoothedLog& log, const ClockFit& clock, const LeftBy& left_by) {
  if (!(clock.second_peak > kAboutAsLikely * clock.peak)) return clock;
  ClockFit other = clock;
  other.lag_s = clock.second_lag_s;
  other.drift_ppm = 0.0;
  return left_by(log, other) < left_by(log, clock) ? other : clock;
}

}  // namespace

std::optional<LogMistake> FindLogMistake(const MarkedRobot& robot, const std::vector<int>& markers,
                                         const std::vector<int>& standing, const SmoothedLog& log,
                                         const std::vector<int>& coordinates,
                                         const Eigen::MatrixXd& speeds,
                                         const MarkerTrajectories& trajectories,
                                         const std::optional<double>& expected_lag_s,
                                         const ClockOptions& options, const ClockFit& clock) {
  const double rate_hz = trajectories.rate_hz;
  if (clock.peak > kFitsAsItIs) return std::nullopt;
  const double least_peak = std::max(kLeastPeak, 1.0 - kFarBetter * (1.0 - clock.peak));
  std::vector<Candidate> candidates;
  const auto try_one = [&](LogMistake mistake) {
    const SmoothedLog changed = WithoutMistake(log, mistake);
    const ClockFit fit = EstimateTrialClock(
        speeds, rate_hz, PredictSpeeds(robot, markers, standing, changed, coordinates, rate_hz),
        expected_lag_s, options);
    if (fit.state != ClockState::kReliable || fit.peak < least_peak) return;
    mistake.peak = fit.peak;
    candidates.push_back({mistake, fit});
  };
  const std::vector<int> columns = MovingColumns(robot, markers, log, coordinates);
  for (std::size_t a = 0; a < columns.size(); ++a) {
    for (std::size_t b = a; b < columns.size(); ++b) try_one({columns[a], columns[b]});
  }
  for (const LogMistake& moved : MovedBlocks(robot, markers, coordinates, log.joints)) {
    try_one(moved);
  }
  const auto left_by = [&](const SmoothedLog& by, const ClockFit& fit) {
    return LeftByPositions(robot, markers, standing, by, coordinates, trajectories, fit);
  };
  const auto left_without = [&](const Candidate& one) {
    return left_by(WithoutMistake(log, one.mistake), one.fit);
  };
  const double left = left_by(log, NearestClock(log, clock, left_by));
  const auto chosen = BestByPositions(std::move(candidates), left_without);
  std::optional<LogMistake> best;
  if (chosen && left_without(*chosen) < kNearer * left) best = chosen->mistake;
  const LoggedSpeeds logged = PredictSpeeds(robot, markers, standing, log, coordinates, rate_hz);
  for (const int column : columns) {
    const auto [still_from, still_to] = LongestStill(log, columns, column);
    if (still_to - still_from < kLeastFrozen_s) continue;
    const double begin = still_from - kJumpSpreads_s, end = still_to + kJumpSpreads_s;
    const ClockFit fit = EstimateTrialClock(
        speeds, rate_hz,
        PredictSpeeds(robot, markers, standing, WithoutSpan(log, begin, end), coordinates, rate_hz),
        expected_lag_s, options);
    if (fit.state != ClockState::kReliable || fit.peak < least_peak) continue;
    if (CorrelationOfPart(logged, speeds, rate_hz, fit, begin, end) > kPartFits) continue;
    if (!(left_by(WithoutSpan(log, begin, end), fit) < left)) continue;
    if (!best || fit.peak > best->peak) best = {column, column, fit.peak, still_from, still_to};
  }
  return best;
}

std::string NameOf(const LogMistake& mistake, const std::vector<std::string>& names) {
  const std::string& name = names[mistake.column];
  if (mistake.frozen_to_s > mistake.frozen_from_s) return "frozen:" + name;
  if (mistake.exchanged == mistake.column) return "sign:" + name;
  const std::string& other = names[mistake.exchanged];
  return "exchange:" + std::min(name, other) + "," + std::max(name, other);
}

std::vector<LogMistake> MistakesOf(const std::vector<std::string>& mistakes,
                                   const std::vector<std::string>& names) {
  std::vector<LogMistake> found;
  const auto count = static_cast<int>(names.size());
  for (int a = 0; a < count; ++a) {
    for (int b = a; b < count; ++b) {
      const LogMistake one{.column = a, .exchanged = b};
      const std::string name = NameOf(one, names);
      const bool wanted = std::find(mistakes.begin(), mistakes.end(), name) != mistakes.end();
      if (wanted) found.push_back(one);
    }
  }
  return found;
}

SmoothedLog WithoutMistake(SmoothedLog log, const LogMistake& mistake) {
  if (mistake.frozen_to_s > mistake.frozen_from_s) return log;
  for (LogPiece& piece : log.pieces) {
    if (mistake.moved != 0) {
      const int size = mistake.exchanged - mistake.column + 1;
      const Eigen::MatrixXd logged = piece.values.middleCols(mistake.column, size);
      for (int k = 0; k < size; ++k) {
        piece.values.col(mistake.column + k) = logged.col((k + mistake.moved + size) % size);
      }
    } else if (mistake.exchanged == mistake.column) {
      piece.values.col(mistake.column) *= -1.0;
    } else {
      piece.values.col(mistake.column).swap(piece.values.col(mistake.exchanged));
    }
  }
  return log;
}

std::string DescribeCopies(const SmoothedLog& log, const std::vector<std::string>& names) {
  for (int a = 0; a < log.joints; ++a) {
    for (int b = a + 1; b < log.joints; ++b) {
      const bool same = std::all_of(log.pieces.begin(), log.pieces.end(), [&](const auto& piece) {
        return piece.values.col(a) == piece.values.col(b);
      });
      if (!same || !Moves(log, a)) continue;
      return "the columns of " + names[a] + " and " + names[b] +
             " are copies of each other, number for number";
    }
  }
  return "";
}

std::string Describe(const LogMistake& mistake, const std::vector<std::string>& names) {
  char peak[40];
  std::snprintf(peak, sizeof peak, "(correlation %.4f)", mistake.peak);
  if (mistake.frozen_to_s > mistake.frozen_from_s) {
    char text[300];
    std::snprintf(
        text, sizeof text,
        "the positions of %s are frozen from %.2f to %.2f s of its log, while others move; "
        "without that part the log fits %s",
        names[mistake.column].c_str(), mistake.frozen_from_s, mistake.frozen_to_s, peak);
    return text;
  }
  if (mistake.moved != 0) {
    return "with the columns of " + names[mistake.column] + " to " + names[mistake.exchanged] +
           " moved by one (" + names[mistake.column] + " has that of " +
           names[mistake.moved > 0 ? mistake.column + 1 : mistake.exchanged] + ") the log fits " +
           peak + ": is its header right?";
  }
  const std::string what =
      mistake.exchanged == mistake.column
          ? "the sign of " + names[mistake.column] + " reversed"
          : names[mistake.column] + " and " + names[mistake.exchanged] + " exchanged";
  return "with " + what + " the log fits " + peak;
}

}  // namespace elastocal
