// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/recording_mistakes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/calibration/label_check.hpp"
#include "elastocal/calibration/log_check.hpp"
#include "elastocal/calibration/prediction.hpp"
#include "elastocal/calibration/row_shift.hpp"
#include "elastocal/calibration/table_check.hpp"
#include "elastocal/calibration/turned_axes.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/log_alternatives.hpp"
#include "elastocal/mistakes/stated_corrections.hpp"
#include "elastocal/mistakes/suspected_signs.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMostMistakes = 3;
constexpr int kRoughUpdates = 20;         // of noise and prior, where a suspicion is tried
constexpr std::size_t kMostTried = 3;     // of a kind, at a time
constexpr std::size_t kMostUndone = 100;  // by AcceptMistakes, in a recording
constexpr double kClearlyRight = 0.2;     // of the error is left: no other suspicion is tried
constexpr std::size_t kManyLeftOut = 4;   // a quarter of the postures
constexpr double kLeftByLeavingOut = 0.3;
// No robot whose errors are estimated leaves more, m and as a share of its size.
constexpr double kExplained = 0.02;
constexpr double kExplainedShare = 0.008;
constexpr double kNoWorse = 1.2;       // of what is left without the postures
constexpr double kLikeTheMost = 0.95;  // of the widest prior

/// A suspicion of any kind.
struct TriedCorrection {
  std::string name, what;  ///< no name: it is to be mended where it comes from
  Recording corrected;
  std::vector<int> left_out = {};  ///< postures that `corrected` is without, ascending
  /// It takes postures out and corrects none: whatever is wrong with them is gone, too.
  bool only_leaves_out = false;
};

/// m.
double MostLeft(const RobotTree& tree) {
  return std::min(kExplained, kExplainedShare * RobotSize(tree));
}

std::string NameOf(const LabelSuspicion& suspicion) {
  return "labels:" + std::min(suspicion.a, suspicion.b) + "," + std::max(suspicion.a, suspicion.b);
}

TriedCorrection Undone(const LogSuspicion& one, const RobotTree& tree, const Recording& recording) {
  return {NameOf(one, tree), DescribeSuspicion(one, tree, recording),
          WithoutMistake(recording, one, tree),
          one.kind == LogContradiction::kFrozen ? one.postures : std::vector<int>(),
          one.kind == LogContradiction::kFrozen};
}

/// Adds it; not where rods would not close without it.
void AddUndone(const LogSuspicion& one, const RobotTree& tree, const Recording& recording,
               std::vector<TriedCorrection>& tried) {
  try {
    tried.push_back(Undone(one, tree, recording));
  } catch (const InputError&) {
  }
}

/// What the nominal robot makes one suspect, with the recording that is left once it is undone; at
/// most so many of labels and of the log.
std::vector<TriedCorrection> Suspicions(const Project& project, const ErrorModel& nominal,
                                        const Recording& recording, std::size_t most) {
  const std::vector<LabelCluster> clusters = SeenClusters(project, recording);
  TableSuspicions suspicions = FindTableSuspicions(nominal, recording, clusters);
  if (!recording.trials.empty()) {
    suspicions = {FindLogSuspicions(nominal, recording),
                  FindLabelSuspicions(nominal, recording, clusters)};
  }
  std::vector<TriedCorrection> tried;
  for (const LabelSuspicion& one : suspicions.labels) {
    if (tried.size() >= most) break;
    tried.push_back(
        {NameOf(one), DescribeSuspicion(one, recording), WithoutExchange(recording, one)});
  }
  std::size_t frozen = 0, others = 0;
  for (const LogSuspicion& one : suspicions.log) {
    std::size_t& used = one.kind == LogContradiction::kFrozen ? frozen : others;
    if (used < most) AddUndone(one, project.tree, recording, tried);
    ++used;
  }
  if (const std::optional<RowShift> shift = FindRowShift(nominal, recording)) {
    tried.push_back({fmt::format("rows:{:+d}", shift->rows), DescribeShift(*shift, recording),
                     WithoutShift(recording, *shift), WithoutPartner(*shift, recording)});
  }
  if (!recording.trials.empty() && LooksMirrored(nominal, recording, MostLeft(project.tree))) {
    tried.insert(tried.begin(), {"", kLeftHanded, Mirrored(recording)});
  }
  return tried;
}

/// The signs of the joints that move in these postures, undone in all.
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

/// Mistakes in the log of a table of these names: the nominal robot does not show all of them.
std::vector<TriedCorrection> NamedOfTable(const std::vector<std::string>& names,
                                          const Recording& recording, const RobotTree& tree) {
  std::vector<TriedCorrection> named;
  for (const LogSuspicion& one : PossibleLogMistakes(recording, tree)) {
    const bool wanted = std::find(names.begin(), names.end(), NameOf(one, tree)) != names.end();
    if (wanted) AddUndone(one, tree, recording, named);
  }
  return named;
}

ErrorModel NominalModel(const Project& project, const Recording& recording) {
  return SelectMarkers(MakeProjectModel(project, recording.trials), recording.marker_names);
}

/// Undoes what has one of these names; adds the names that the recording shows and what was undone.
void Accept(const Project& project, const std::vector<std::string>& names, Recording& recording,
            std::vector<std::optional<Transform>>& truth, std::set<std::string>& shown,
            std::vector<std::string>& undone) {
  if (recording.posture_count() == 0) return;
  const ErrorModel nominal = NominalModel(project, recording);
  std::set<std::string> named_done;
  for (std::size_t round = 0; round < kMostUndone; ++round) {
    const TriedCorrection* next = nullptr;
    const std::vector<TriedCorrection> tried = Suspicions(project, nominal, recording, kMostUndone);
    for (const TriedCorrection& one : tried) {
      if (one.name.empty()) continue;
      shown.insert(one.name);
      const bool wanted = std::find(names.begin(), names.end(), one.name) != names.end();
      if (wanted && next == nullptr) next = &one;
    }
    const std::vector<TriedCorrection> named = next == nullptr
                                                   ? NamedOfTable(names, recording, project.tree)
                                                   : std::vector<TriedCorrection>();
    for (const TriedCorrection& one : named) {
      if (!shown.contains(one.name) && named_done.insert(one.name).second) next = &one;
    }
    if (next == nullptr) break;
    undone.push_back(next->what);
    if (!truth.empty()) {
      std::for_each(next->left_out.rbegin(), next->left_out.rend(),
                    [&](int posture) { truth.erase(truth.begin() + posture); });
    }
    recording = Recording(next->corrected);
  }
  shown.insert(named_done.begin(), named_done.end());
}

/// Whether an estimate is beyond what an error of a robot can be, by an axis or by the width of the
/// prior: axes turned by half a turn explain a reversed sign perfectly.
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
    // What is right comes to rest soon; what is wrong may never.
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

/// None where too much is left in the end.
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
    // A joint that rests while another limb is measured looks frozen where that limb is wrong.
    std::stable_partition(tried.begin(), tried.end(),
                          [](const TriedCorrection& one) { return !one.only_leaves_out; });
    const TriedCorrection* best = nullptr;
    double least = left_of_error * error;
    const auto try_one = [&](const TriedCorrection& one) {  // whether it is clearly right
      const double left = error_of(one.corrected);
      if (!(left < least)) return false;
      if (one.only_leaves_out && left > kLeftByLeavingOut * error) return false;
      least = left;
      best = &one;
      return left < std::min(kClearlyRight * error, most_left);
    };
    for (const TriedCorrection& one : tried) {
      if (one.only_leaves_out && best != nullptr && least < most_left) break;
      if (try_one(one)) break;
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
  const auto error_of_corrected = [&](const Recording& corrected) {
    if (!robot) {
      Measurements measured = as_recorded;
      robot = MakeRecordedModel(project, seed, measured, KnockSearch::kNone);
    }
    try {
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
  // Once one mistake is undone, what remains is not worth a fit for each joint.
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
  return Explained(
      project.tree,
      FindMistakesBy(
          project, measured.calibration, FitError(result, fitted, project.calibration),
          [&](const Recording& recording) { return refitting.Error(recording); }, signs));
}

std::vector<std::string> AcceptMistakes(const Project& project,
                                        const std::vector<std::string>& accepted,
                                        Measurements& measured) {
  std::vector<std::string> undone;
  std::vector<std::string> names;  // of mistakes that the recording must show
  for (const std::string& name : accepted) {
    if (const auto stated = ParseStatedCorrection(name, project.tree)) {
      undone.push_back(ApplyCorrection(*stated, project.tree, measured));
    } else {
      names.push_back(name);
    }
  }
  if (names.empty()) return undone;
  std::set<std::string> shown;
  Accept(project, names, measured.calibration, measured.calibration_truth, shown, undone);
  Accept(project, names, measured.validation, measured.validation_truth, shown, undone);
  for (const std::string& name : names) {
    if (!shown.contains(name)) RefuseAccepted(name, shown);
  }
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
