// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/recording_mistakes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/calibration/prediction.hpp"
#include "elastocal/calibration/turned_axes.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/thinned_motions.hpp"
#include "elastocal/mistakes/suspected_signs.hpp"
#include "elastocal/mistakes/tried_correction.hpp"
#include "elastocal/screening/log_check.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMostMistakes = 3;
constexpr int kRoughUpdates = 20;      // updates of noise and prior where a suspicion is tried
constexpr std::size_t kMostTried = 3;  // suspicions of one kind at a time
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
