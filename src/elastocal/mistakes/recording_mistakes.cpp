// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/recording_mistakes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/calibration/prediction.hpp"
#include "elastocal/calibration/turned_axes.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/thinned_motions.hpp"
#include "elastocal/mistakes/stated_corrections.hpp"
#include "elastocal/mistakes/suspected_signs.hpp"
#include "elastocal/mistakes/tried_correction.hpp"
#include "elastocal/screening/log_check.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMostMistakes = 3;
constexpr int kRoughUpdates = 20;         // updates of noise and prior where a suspicion is tried
constexpr std::size_t kMostTried = 3;     // suspicions of one kind at a time
constexpr std::size_t kMostUndone = 100;  // mistakes that AcceptMistakes corrects in a recording
constexpr double kClearlyRight = 0.2;  // share of the error below which no other suspicion is tried
constexpr std::size_t kManyLeftOut = 4;  // one in so many postures
constexpr double kLeftByLeavingOut = 0.3;
constexpr double kNoWorse = 1.2;       // ratio to the error without the postures
constexpr double kLikeTheMost = 0.95;  // share of the widest prior
constexpr int kMostMoments = 120;      // moments of motions by which a suspicion is tried first
constexpr double kMostLeftByFew = 0.75;

/// Corrections of the sign, in all postures, of each joint that moves in these postures.
std::vector<TriedCorrection> SignsIn(const std::vector<int>& postures, const RobotTree& tree,
                                     const Recording& recording) {
  std::vector<TriedCorrection> signs;
  for (int c = 0; c < tree.coordinate_count(); ++c) {
    const Eigen::VectorXd positions = recording.q.col(c)(postures);
    if (!(positions.maxCoeff() > positions.minCoeff())) continue;
    signs.push_back(Undone(SignOf(c, recording), tree, recording));
  }
  return signs;
}

/// Mistakes with these names in a table, since the nominal robot does not show all of them.
std::vector<TriedCorrection> NamedOfTable(const std::vector<std::string>& names,
                                          const Recording& recording, const RobotTree& tree) {
  std::vector<TriedCorrection> named;
  for (const LogSuspicion& one : PossibleLogMistakes(recording, tree)) {
    const bool wanted = std::find(names.begin(), names.end(), NameOf(one, tree)) != names.end();
    if (wanted) AddUndone(one, tree, recording, named);
  }
  return named;
}

/// Makes the corrections that the user accepts, in the recordings that show the mistakes.
class Acceptance {
 public:
  /// `told` are names that the clocks of trials have shown.
  Acceptance(const Project& project, const std::vector<std::string>& names,
             const std::set<std::string>& told)
      : project_(project), names_(names), told_(told), shown_(told) {}

  void Undo(Recording& recording, std::vector<std::optional<Transform>>& truth) {
    if (recording.posture_count() == 0) return;
    const ErrorModel nominal = NominalModel(project_, recording);
    std::set<std::string> done;  // completely corrected: what is left of them was correct
    for (const std::string& name : told_) {
      if (UndoInTrials(nominal, name, recording)) done.insert(name);
    }
    for (std::size_t round = 0; round < kMostUndone; ++round) {
      const std::optional<TriedCorrection> next = Next(nominal, recording, done);
      if (!next) return;
      if (UndoInTrials(nominal, next->name, recording)) {
        done.insert(next->name);
        told_.insert(next->name);
        continue;
      }
      undone_.push_back(next->what);
      if (!truth.empty()) {
        std::for_each(next->left_out.rbegin(), next->left_out.rend(),
                      [&](int posture) { truth.erase(truth.begin() + posture); });
      }
      recording = next->corrected;
    }
  }

  /// Names that the recordings have shown (a table need not show them), and descriptions of the
  /// corrections.
  const std::set<std::string>& shown() const { return shown_; }
  const std::vector<std::string>& undone() const { return undone_; }

 private:
  bool IsWanted(const std::string& name) const {
    return std::find(names_.begin(), names_.end(), name) != names_.end();
  }

  /// The next named mistake that the recording shows or, in a table, that it need not show.
  std::optional<TriedCorrection> Next(const ErrorModel& nominal, const Recording& recording,
                                      std::set<std::string>& done) {
    std::optional<TriedCorrection> next;
    for (TriedCorrection& one :
         Suspicions(project_, nominal, recording, kMostUndone, SuspicionsOf::kNamed)) {
      shown_.insert(one.name);
      if (!next && IsWanted(one.name) && !done.contains(one.name)) next = std::move(one);
    }
    if (next) return next;
    for (TriedCorrection& one : NamedOfTable(names_, recording, project_.tree)) {
      const bool of_this = !shown_.contains(one.name) || named_.contains(one.name);
      if (!of_this || !done.insert(one.name).second) continue;
      named_.insert(one.name);
      shown_.insert(one.name);
      return std::move(one);
    }
    return std::nullopt;
  }

  /// Corrects a sign or an exchange in all trials but those that would then show it, because the
  /// logging program assigns columns once. Returns whether it did; not in a table, nor where rods
  /// would not close.
  bool UndoInTrials(const ErrorModel& nominal, const std::string& name, Recording& recording) {
    if (recording.trials.empty()) return false;
    Recording as_table = recording;
    as_table.trials.clear();
    as_table.q.row(0).array() += 1.0;  // so that joints that stand still here are possible, too
    for (LogSuspicion& one : PossibleLogMistakes(as_table, project_.tree)) {
      if (NameOf(one, project_.tree) != name) continue;
      try {
        const Recording in_all = WithoutMistake(recording, one, project_.tree);
        for (const LogSuspicion& other : FindLogSuspicions(nominal, in_all)) {
          if (NameOf(other, project_.tree) == name) Remove(other.postures, one.postures);
        }
        recording = WithoutMistake(recording, one, project_.tree);
      } catch (const InputError&) {
        return false;
      }
      if (one.postures.empty()) return false;
      undone_.push_back(DescribeSuspicion(one, project_.tree, recording));
      return true;
    }
    return false;
  }

  static void Remove(const std::vector<int>& removed, std::vector<int>& ascending) {
    std::erase_if(ascending, [&](int posture) {
      return std::binary_search(removed.begin(), removed.end(), posture);
    });
  }

  const Project& project_;
  const std::vector<std::string>& names_;
  std::set<std::string> told_;
  std::set<std::string> shown_;
  std::set<std::string> named_;  // names that no recording shows
  std::vector<std::string> undone_;
};

/// Whether an estimate is impossible for a robot, by an axis or by the width of the prior: axes
/// turned by half a turn explain a reversed sign perfectly.
bool IsNoRobot(const CalibrationResult& result) {
  const PriorScale& scale = result.prior_scale;
  const auto at_most = [&](PriorGroup group) {
    return scale.factor[static_cast<std::size_t>(group)] >= kLikeTheMost * MostWidening(group);
  };
  return at_most(PriorGroup::kAngles) || at_most(PriorGroup::kLengths) ||
         !TurnedAxes(result).empty();
}

/// Calibrates the robot from recordings of the same trials.
class Refitting {
 public:
  Refitting(const Project& project, std::optional<std::uint64_t> seed, const Measurements& measured)
      : project_(project), as_recorded_(measured), seed_(seed) {}

  /// Error of the robot that is calibrated from the recording; infinite where nothing can be
  /// fitted.
  double Error(const Recording& recording) {
    if (!base_) {
      Measurements plain = as_recorded_;
      RecordedModel robot = MakeRecordedModel(project_, seed_, plain, KnockSearch::kNone);
      model_ = std::move(robot.model);
      base_ = std::move(robot.base);
    }
    // A correct recording comes to rest soon; a wrong one may never.
    CalibrationOptions roughly = project_.calibration;
    roughly.max_iterations = std::min(roughly.max_iterations, kRoughUpdates);
    try {
      return FitError(Calibrate(*model_, recording, *base_, ModelKinds(*model_).back(), roughly),
                      recording, project_.calibration);
    } catch (const InputError&) {
      return std::numeric_limits<double>::infinity();
    }
  }

 private:
  const Project& project_;
  const Measurements& as_recorded_;
  std::optional<std::uint64_t> seed_;
  std::optional<ErrorModel> model_;
  std::optional<BaseParameters> base_;
};

/// The mistakes; empty where too large an error is left in the end.
std::vector<RecordingMistake> Explained(const RobotTree& tree,
                                        std::vector<RecordingMistake> mistakes) {
  if (!mistakes.empty() && mistakes.back().after > MostLeft(tree)) mistakes.clear();
  return mistakes;
}

}  // namespace

double FitError(const CalibrationResult& result, const Recording& recording,
                const CalibrationOptions& options) {
  if (IsNoRobot(result)) return std::numeric_limits<double>::infinity();
  return MarkerError(result, recording, options);
}

double MarkerError(const CalibrationResult& result, const Recording& recording,
                   const CalibrationOptions& options) {
  const Prediction prediction = Predict(result.model, result.delta, recording, options);
  double squares = 0.0;
  double count = 0.0;
  for (double distance : prediction.distances.reshaped()) {
    if (!std::isfinite(distance)) continue;
    squares += distance * distance;
    ++count;
  }
  return count == 0.0 ? std::numeric_limits<double>::infinity() : std::sqrt(squares / count);
}

std::vector<RecordingMistake> FindMistakesBy(
    const Project& project, const Recording& recording, double error,
    const std::function<double(const Recording&)>& error_of, const FurtherSuspicions& more,
    double left_of_error) {
  std::vector<RecordingMistake> mistakes;
  if (recording.posture_count() == 0) return mistakes;
  const ErrorModel nominal = NominalModel(project, recording);
  // Where no robot explains the recording, anything that lets one do so seems to help.
  const double most_left = MostLeft(project.tree);
  Recording current = recording;
  while (mistakes.size() < kMostMistakes) {
    std::vector<TriedCorrection> tried = Suspicions(project, nominal, current, kMostTried);
    if (more) {
      for (const LogSuspicion& one : more(current, error)) {
        AddUndone(one, project.tree, current, tried);
      }
    }
    // A joint that rests while another limb is measured looks frozen if that limb is wrong.
    std::stable_partition(tried.begin(), tried.end(),
                          [](const TriedCorrection& one) { return !one.only_leaves_out; });
    const TriedCorrection* best = nullptr;
    double least = left_of_error * error;
    const auto try_one = [&](const TriedCorrection& one) {  // returns whether it is clearly right
      const double left = error_of(one.corrected);
      if (!(left < least)) return false;
      if (one.only_leaves_out && left > kLeftByLeavingOut * error) return false;
      least = left;
      best = &one;
      return left < std::min(kClearlyRight * error, most_left);
    };
    bool clear = false;
    for (const TriedCorrection& one : tried) {
      // The same mistake in other trials may be better still.
      if (clear && (one.name.empty() || one.name != best->name)) break;
      if (one.only_leaves_out && best != nullptr && least < most_left) break;
      clear = try_one(one) || clear;
    }
    if (best == nullptr) break;
    TriedCorrection found = *best;
    const bool many = kManyLeftOut * found.left_out.size() >= Size(current.posture_count());
    if (found.only_leaves_out && many) {
      const double without = std::exchange(least, kNoWorse * least);
      const std::vector<TriedCorrection> signs = SignsIn(found.left_out, project.tree, current);
      best = nullptr;
      for (const TriedCorrection& one : signs) try_one(one);
      if (best != nullptr) {
        found = *best;
      } else {
        least = without;
      }
    }
    mistakes.push_back({found.name, found.what, error, least, found.corrected});
    current = found.corrected;
    error = least;
  }
  return mistakes;
}

std::vector<RecordingMistake> FindMistakesBy(
    const Project& project, std::optional<std::uint64_t> seed, const Measurements& as_recorded,
    double error, const std::function<double(const RecordedModel&, const Recording&)>& error_of) {
  std::optional<RecordedModel> robot;  // made when there is a suspicion
  const Recording& recorded = as_recorded.calibration;
  // A fit to a wrong recording hardly comes to rest, which takes minutes with thousands of moments.
  const auto hardly_helps = [&](const Recording& corrected) {
    const std::vector<int> few = FewPostures(recorded, corrected, kMostMoments);
    return !few.empty() && error_of(*robot, SelectPostures(corrected, few)) >
                               kMostLeftByFew * error_of(*robot, SelectPostures(recorded, few));
  };
  const auto error_of_corrected = [&](const Recording& corrected) {
    if (!robot) {
      Measurements measured = as_recorded;
      robot = MakeRecordedModel(project, seed, measured, KnockSearch::kNone);
    }
    try {
      if (hardly_helps(corrected)) return std::numeric_limits<double>::infinity();
      return error_of(*robot, corrected);
    } catch (const InputError&) {
      return std::numeric_limits<double>::infinity();
    }
  };
  return Explained(project.tree,
                   FindMistakesBy(project, as_recorded.calibration, error, error_of_corrected));
}

std::vector<RecordingMistake> FindRecordingMistakes(const Project& project,
                                                    std::optional<std::uint64_t> seed,
                                                    const Measurements& measured,
                                                    const Recording& fitted,
                                                    const CalibrationResult& result) {
  Refitting refitting(project, seed, measured);
  // Once a mistake is corrected, the rest does not justify a fit for each joint.
  bool unexplained = result.marker_sd > project.calibration.plausible_marker_sd;
  const auto signs = [&](const Recording& recording, double error) {
    std::vector<LogSuspicion> suspected;
    if (std::exchange(unexplained, false)) suspected = AllSigns(project.tree, recording);
    // A robot that explains a recording has no turned axes.
    if (suspected.empty() && !(error < MostLeft(project.tree))) {
      suspected = SignsOfTurnedAxes(result, recording);
    }
    return suspected;
  };
  double error = FitError(result, fitted, project.calibration);
  // Where clusters were split that were not knocked, a fit may explain nothing that explains much
  // with whole clusters. A mistake must then leave less than that.
  const bool in_sets = fitted.marker_count() != measured.calibration.marker_count();
  if (in_sets && !(error < MostLeft(project.tree))) {
    error = std::min(error, refitting.Error(measured.calibration));
  }
  return Explained(
      project.tree,
      FindMistakesBy(
          project, measured.calibration, error,
          [&](const Recording& recording) { return refitting.Error(recording); }, signs));
}

std::vector<std::string> AcceptMistakes(const Project& project,
                                        const std::vector<std::string>& accepted,
                                        Measurements& measured) {
  std::vector<std::string> undone;
  std::vector<std::string> names;  // names of mistakes that the recording must show
  std::vector<StatedCorrection> stated;
  for (const std::string& name : accepted) {
    if (const auto one = ParseStatedCorrection(name, project.tree)) {
      stated.push_back(*one);
    } else {
      names.push_back(name);
    }
  }
  for (const StatedCorrection& one : stated) {
    undone.push_back(ApplyCorrection(one, project.tree, measured));
  }
  if (names.empty()) return undone;
  std::set<std::string> told;
  for (const TrialSummary& trial : measured.trials) {
    told.insert(trial.clock_without.begin(), trial.clock_without.end());
  }
  Acceptance acceptance(project, names, told);
  acceptance.Undo(measured.calibration, measured.calibration_truth);
  acceptance.Undo(measured.validation, measured.validation_truth);
  for (const std::string& name : names) {
    if (!acceptance.shown().contains(name)) RefuseAccepted(name, acceptance.shown());
  }
  undone.insert(undone.end(), acceptance.undone().begin(), acceptance.undone().end());
  return undone;
}

std::string DescribeUndone(const std::string& what) { return "corrected on request: " + what; }

std::string DescribeMistake(const RecordingMistake& mistake) {
  const std::string remedy =
      mistake.name.empty() ? "" : fmt::format(" (--accept {} corrects it)", mistake.name);
  if (std::isinf(mistake.before)) {
    return fmt::format(
        "{}; without that the recording is explained to {:.3g} mm, with it only by errors that no "
        "robot has{}",
        mistake.what, 1e3 * mistake.after, remedy);
  }
  return fmt::format("{}; without that the error of the fit falls from {:.3g} to {:.3g} mm{}",
                     mistake.what, 1e3 * mistake.before, 1e3 * mistake.after, remedy);
}

}  // namespace elastocal
