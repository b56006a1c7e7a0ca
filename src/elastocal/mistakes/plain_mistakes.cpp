// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/plain_mistakes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/log_alternatives.hpp"
#include "elastocal/mistakes/offsets_fit.hpp"
#include "elastocal/mistakes/other_followers.hpp"
#include "elastocal/mistakes/other_zeros.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/mistakes/tried_correction.hpp"
#include "elastocal/mistakes/whole_limbs.hpp"
#include "elastocal/recorded/find_base.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/screening/log_check.hpp"
#include "elastocal/screening/moved_frame.hpp"
#include "elastocal/screening/odd_postures.hpp"
#include "elastocal/screening/placed_misfit.hpp"
#include "elastocal/screening/told_positions.hpp"

namespace elastocal {
namespace {

constexpr int kFewestPlaced = 8;    // with fewer, anything can be explained
constexpr double kMostLeft = 0.02;  // m: largest error that estimated errors of a robot leave
// Largest share that is left with a mistake corrected, for the placed nominal robot:
constexpr double kLeftOfMisfit = 0.7;
constexpr double kLeftByOneOfSeveral = 0.9;
constexpr double kMuchLess = 0.5;             // share of what other mistakes leave
constexpr double kLeftByToldPositions = 0.3;  // for the positions of one joint by the markers
constexpr double kUntold = std::numeric_limits<double>::infinity();
constexpr double kLeftWhereNoRobot = 0.5;  // where the offsets with the mistake are impossible
// ... and for the robot with joint offsets:
constexpr double kLeftOfOffsets = 0.5;
constexpr double kLeftByNoRobot = 0.98;      // where those with and without it are impossible
constexpr double kNoWorseThanNoRobot = 1.1;  // where only those without it are possible
// For a root link that moved:
constexpr double kFarFromRobot = 0.05;  // m: beyond the error of a fit that has not converged
constexpr double kLeftOfGeometry = 0.3;
constexpr int kFewestBodies = 2;  // bodies that show whether it moved
constexpr int kEnoughPostures = 500;

/// A robot and its recording, with a mistake corrected.
struct Alternative {
  std::string what;  ///< the mistake as text
  std::string name;  ///< name for `--accept`; empty: the mistake is in the project
  ErrorModel model;
  Recording recording;
};

ErrorModel ModelOf(const Project& project, const Recording& recording) {
  return SelectMarkers(MakeProjectModel(project, {}), recording.marker_names);
}

double MisfitOf(const ErrorModel& model, const Recording& recording) {
  try {
    return PlacedMisfit(model, recording);
  } catch (const InputError&) {  // rods that do not close
    return std::numeric_limits<double>::infinity();
  }
}

std::string Describe(const MovedFrame& moved) {
  return fmt::format(
      "from posture {} on the frame of the markers lies elsewhere against the root link: {} on it "
      "moved by {:.2g} mm and {:.2g} mrad, which displaces the other markers by {:.2g} mm (a "
      "tracker or the base was pushed). Calibrate the postures before and after apart, or let "
      "these markers place the root link in each posture (recording: {{root: free}} in the "
      "project)",
      moved.posture + 1, fmt::join(moved.markers, ", "), 1e3 * moved.shift, 1e3 * moved.angle,
      1e3 * moved.displaced);
}

/// The same with fewer postures, evenly chosen, which determine the root link well enough.
Alternative Thinned(Alternative robot) {
  const int count = robot.recording.posture_count();
  if (count <= kEnoughPostures) return robot;
  std::vector<int> some;
  for (int i = 0; i < kEnoughPostures; ++i) {
    some.push_back(static_cast<int>(static_cast<std::int64_t>(i) * count / kEnoughPostures));
  }
  robot.recording = SelectPostures(robot.recording, some);
  return robot;
}

std::optional<CalibrationResult> Fit(const Alternative& robot, ModelKind kind,
                                     const Project& project) {
  try {
    return Calibrate(robot.model, robot.recording,
                     FindBaseOf(project, robot.model, robot.recording), kind, project.calibration);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// Root mean square distance of the markers from the calibrated robot, m, however large its errors
/// are. Where offsets are large, the nominal robot may fit better with a mistake than without.
double ErrorOf(const Alternative& robot, ModelKind kind, const Project& project) {
  const auto result = Fit(robot, kind, project);
  return result ? MarkerError(*result, robot.recording, project.calibration)
                : std::numeric_limits<double>::infinity();
}

/// Search for mistakes that the placed nominal robot shows and a robot with joint offsets confirms.
class PlainSearch {
 public:
  PlainSearch(const Project& project, const Recording& recording)
      : project_(project),
        given_{"", "", ModelOf(project, recording), recording},
        misfit_(MisfitOf(given_.model, recording)),
        least_(MostLeft(project.tree)) {}

  /// Returns the mistakes, each found beside those before it; empty: none.
  std::vector<Alternative> Run() {
    if (std::vector<Alternative> turned = FindTurned(); !turned.empty()) return turned;
    for (const auto& search : {&PlainSearch::FindInTableOrZero, &PlainSearch::FindExchange,
                               &PlainSearch::FindWrongFollower, &PlainSearch::FindWholeLimb,
                               &PlainSearch::FindLostColumn, &PlainSearch::FindHalfTurn,
                               &PlainSearch::FindOtherColumn, &PlainSearch::FindPair}) {
      std::vector<Alternative> found = Confirmed((this->*search)());
      if (!found.empty()) return found;
    }
    std::vector<Alternative> odd = ConfirmedByOffsets(FindOdd());
    return odd.empty() ? FindMovedRoot() : odd;
  }

 private:
  /// Takes what leaves less: half a turn of a joint may look like the sign of another one.
  std::vector<Alternative> FindInTableOrZero() const {
    std::vector<Alternative> in_table = FindInTable(), zero = FindOtherZero();
    if (in_table.empty() || zero.empty()) return zero.empty() ? in_table : zero;
    const OffsetsFit by_zero = FitOffsetsOf(zero.back()), by_table = FitOffsetsOf(in_table.back());
    return by_zero.error < kMuchLess * by_table.error ? zero : in_table;
  }

  double LeftOf(const std::vector<Alternative>& steps) const {
    return MisfitOf(steps.back().model, steps.back().recording);
  }

  std::vector<Alternative> FindInTable() const {
    const auto misfit = [&](const Recording& corrected) {
      return MisfitOf(given_.model, corrected);
    };
    const auto signs = [&](const Recording& recording, double) {
      std::vector<LogSuspicion> all = PossibleLogMistakes(recording, project_.tree);
      std::erase_if(all, [](const auto& one) { return one.kind != LogContradiction::kSign; });
      return all;
    };
    std::vector<Alternative> found;
    std::size_t told = 0;  // the last mistake that explains most of what the ones before it leave
    for (RecordingMistake& one :
         FindMistakesBy(project_, given_.recording, misfit_, misfit, signs, kLeftByOneOfSeveral)) {
      found.push_back({one.what, one.name, given_.model, std::move(one.corrected)});
      if (one.after < kLeftOfMisfit * one.before) told = found.size();
    }
    found.resize(told);
    return found;
  }

  std::vector<Alternative> FindExchange() const {
    const std::vector<LogSuspicion> possible = PossibleLogMistakes(given_.recording, project_.tree);
    const LogSuspicion* best = nullptr;
    double least = kLeftOfMisfit * misfit_;
    for (const LogSuspicion& one : possible) {
      if (one.kind != LogContradiction::kExchange) continue;
      const double left = MisfitWithout(one);
      if (!(left < least)) continue;
      least = left;
      best = &one;
    }
    if (best == nullptr) return {};
    return {{DescribeSuspicion(*best, project_.tree, given_.recording),
             NameOf(*best, project_.tree), given_.model,
             WithoutMistake(given_.recording, *best, project_.tree)}};
  }

  double MisfitWithout(const LogSuspicion& mistake) const {
    try {
      return MisfitOf(given_.model, WithoutMistake(given_.recording, mistake, project_.tree));
    } catch (const InputError&) {
      return std::numeric_limits<double>::infinity();
    }
  }

  std::vector<Alternative> FindWrongFollower() const {
    std::vector<Alternative> found;
    double least = kLeftOfMisfit * misfit_;
    for (FollowerAlternative& one : OtherFollowers(project_)) {
      Alternative other{std::move(one.what), "", ModelOf(one.project, given_.recording),
                        given_.recording};
      const double left = MisfitOf(other.model, other.recording);
      if (!(left < least)) continue;
      least = left;
      found = {std::move(other)};
    }
    return found;
  }

  /// Finds a joint that moved although its column is the same in all rows; the markers show its
  /// positions. Since they explain a part of any mistake, they must explain most of the misfit.
  std::vector<Alternative> FindLostColumn() const {
    if (given_.recording.free_root || misfit_ < least_) return {};
    const RobotTree& tree = project_.tree;
    std::vector<Alternative> found;
    double least = kLeftByToldPositions * misfit_;
    for (const int k : given_.model.active_joints) {
      const Joint& joint = tree.joints[Size(k)];
      const auto column = given_.recording.q.col(joint.coordinate);
      if (joint.mimic || IsMovedByRods(tree, k) || column.maxCoeff() > column.minCoeff()) continue;
      Recording told = WithToldPositions(given_.model, given_.recording, joint.coordinate);
      const double left = MisfitOf(given_.model, told);
      if (!(left < least)) continue;
      least = left;
      found = {{joint.name +
                    ": its positions are the same in all rows, and the markers show that it moved "
                    "(a column that was not logged?)",
                "", given_.model, std::move(told)}};
    }
    return found;
  }

  /// Finds a joint whose positions are logged within half a turn although it turns further.
  std::vector<Alternative> FindHalfTurn() const {
    std::vector<Alternative> found;
    double least = kLeftOfMisfit * misfit_;
    for (const int k : given_.model.active_joints) {
      const Joint& joint = project_.tree.joints[Size(k)];
      if (joint.mimic || IsMovedByRods(project_.tree, k)) continue;
      HalfTurns half = FindHalfTurns(given_.model, given_.recording, joint.coordinate);
      if (half.postures.empty() || !(MisfitOf(given_.model, half.turned) < least)) continue;
      least = MisfitOf(given_.model, half.turned);
      found = {{fmt::format("{}: its positions are off by half a turn in {} of {} postures (logged "
                            "modulo half a turn?)",
                            joint.name, half.postures.size(), half.turned.posture_count()),
                "", given_.model, std::move(half.turned)}};
    }
    return found;
  }

  std::vector<Alternative> FindOtherZero() const {
    if (misfit_ < least_) return {};
    return BestOf(OtherZeros(given_.recording, project_.tree, given_.model.active_joints));
  }

  std::vector<Alternative> FindWholeLimb() const {
    if (misfit_ < least_) return {};
    return BestOf(WholeLimbs(given_.recording, project_));
  }

  std::vector<Alternative> FindOtherColumn() const {
    if (misfit_ < least_) return {};
    return BestOf(OtherColumns(given_.recording, project_.tree, given_.model.active_joints));
  }

  /// The alternative that explains most, if it explains enough.
  std::vector<Alternative> BestOf(std::vector<LogAlternative> others) const {
    std::vector<Alternative> found;
    double least = kLeftOfMisfit * misfit_;
    for (LogAlternative& one : others) {
      const double left = MisfitOf(given_.model, one.recording);
      if (!(left < least)) continue;
      least = left;
      found = {{std::move(one.what), std::move(one.name), given_.model, std::move(one.recording)}};
    }
    return found;
  }

  /// Finds mistakes that impossible offsets explain, which distances of markers hardly show.
  std::vector<Alternative> FindTurned() const {
    std::vector<Alternative> found;
    OffsetsFit fit = FitOffsetsOf(given_);
    const double with = fit.error;
    if (!(with < kMostLeft)) return found;
    for (LogAlternative& one : FindTurnedZeros(project_, given_.model, given_.recording, fit)) {
      one.what += fmt::format(
          "; without that, markers are {:.3g} mm off with joint offsets estimated, with it {:.3g} "
          "mm "
          "by offsets that no robot has",
          1e3 * fit.error, 1e3 * with);
      found.push_back(
          {std::move(one.what), std::move(one.name), given_.model, std::move(one.recording)});
    }
    return found;
  }

  std::vector<Alternative> FindPair() const {
    if (misfit_ < least_) return {};
    std::vector<Alternative> found;
    for (LogAlternative& one : BestPair(given_.recording, project_.tree, [&](const Recording& of) {
           return MisfitOf(given_.model, of);
         })) {
      found.push_back(
          {std::move(one.what), std::move(one.name), given_.model, std::move(one.recording)});
    }
    return found;
  }

  /// Finds mistakes in a part of the table.
  std::vector<Alternative> FindOdd() const {
    std::vector<Alternative> found;
    for (OddPostures& one : FindOddPostures(given_.model, given_.recording,
                                            SeenClusters(project_, given_.recording))) {
      found.push_back({std::move(one.what), "", given_.model, std::move(one.corrected)});
    }
    return found;
  }

  /// Finds a root link that moves although it should stand still. In each posture its pose also
  /// explains errors of the robot; these are therefore all estimated first.
  std::vector<Alternative> FindMovedRoot() const {
    if (given_.recording.free_root) return {};
    std::set<int> bodies;
    for (const Marker& marker : given_.model.markers) {
      bodies.insert(project_.tree.links[Size(marker.link)].body);
    }
    if (bodies.size() < kFewestBodies) return {};
    Alternative free = given_;
    free.recording.free_root = true;
    if (!(MisfitOf(free.model, free.recording) < kLeftOfMisfit * misfit_)) return {};
    const double before = ErrorOf(Thinned(given_), ModelKind::kGeometric, project_);
    if (!(before > kFarFromRobot)) return {};
    const double after = ErrorOf(Thinned(free), ModelKind::kGeometric, project_);
    if (!(after < kLeftOfGeometry * before) || after > kMostLeft) return {};
    free.what = fmt::format(
        "the root link seems to stand elsewhere in each posture (if it does, write recording: "
        "{{root: free}} into the project); with all geometric errors estimated, markers are {:.3g} "
        "mm off if so, and {:.3g} mm if not",
        1e3 * after, 1e3 * before);
    return {free};
  }

  OffsetsFit FitOffsetsOf(const Alternative& of) const {
    return FitOffsets(project_, of.model, of.recording);
  }

  /// Returns all of them with their evidence, unless joint offsets explain them.
  std::vector<Alternative> Confirmed(std::vector<Alternative> steps) const {
    if (steps.empty()) return {};
    const double left = LeftOf(steps);
    if (left > kLeftOfMisfit * misfit_) return {};
    return ConfirmedByOffsets(std::move(steps), left);
  }

  /// The same by the offsets alone: the typical distance tells little about a part of the table.
  std::vector<Alternative> ConfirmedByOffsets(std::vector<Alternative> steps,
                                              double left = kUntold) const {
    if (steps.empty()) return {};
    const OffsetsFit with = FitOffsetsOf(given_), without = FitOffsetsOf(steps.back());
    if (!std::isfinite(with.error) || !(without.error < kMostLeft)) return {};
    // Offsets of half a turn, and zeros of motors, explain much or all with values that are
    // impossible for a robot.
    const bool no_robot = !with.robot && left < kLeftWhereNoRobot * misfit_;
    double most = no_robot ? kLeftByNoRobot : kLeftOfOffsets;
    if (no_robot && without.robot) most = kNoWorseThanNoRobot;
    if (without.error > most * with.error) return {};
    for (Alternative& one : steps) {
      one.what += fmt::format(
          "; without that, and with joint offsets estimated, markers are {:.3g} mm off, with it "
          "{:.3g} mm{}",
          1e3 * without.error, 1e3 * with.error, no_robot ? " by errors that no robot has" : "");
    }
    return steps;
  }

  const Project& project_;
  Alternative given_;
  double misfit_;  ///< PlacedMisfit, m
  double least_;   ///< largest misfit that a mistake may leave, m
};

}  // namespace

std::vector<std::string> FindPlainMistakes(const Project& project, const Recording& recording) {
  if (!recording.trials.empty() || recording.posture_count() < kFewestPlaced) return {};
  std::vector<std::string> found;
  if (const auto moved = FindMovedFrame(ModelOf(project, recording), recording)) {
    return {Describe(*moved)};
  }
  for (const Alternative& one : PlainSearch(project, recording).Run()) {
    found.push_back(one.name.empty() ? one.what
                                     : one.what + " (--accept " + one.name + " corrects it)");
  }
  return found;
}

}  // namespace elastocal
