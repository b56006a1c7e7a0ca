#include "elastocal/pipeline/recording_mistakes.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/calibration/label_check.hpp"
#include "elastocal/calibration/log_check.hpp"
#include "elastocal/calibration/prediction.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/recorded_model.hpp"

namespace elastocal {
namespace {

constexpr double kLeftOfError = 0.5;  // at most, without a mistake
constexpr std::size_t kMostMistakes = 3;
constexpr std::size_t kMostTried = 3;  // of a kind, at a time
constexpr double kClearlyRight = 0.2;  // of the error is left: no other suspicion is tried
constexpr double kLikeTheMost = 0.95;  // of the widest prior

/// A suspicion of any kind.
struct TriedCorrection {
  std::string what;
  Recording corrected;
};

/// Whether the prior had to be widened beyond what an error of a robot can be: axes turned by half
/// a turn explain a reversed sign perfectly.
bool IsNoRobot(const PriorScale& scale) {
  for (PriorGroup group : {PriorGroup::kAngles, PriorGroup::kLengths}) {
    if (scale.factor[static_cast<std::size_t>(group)] >= kLikeTheMost * MostWidening(group)) {
      return true;
    }
  }
  return false;
}

/// rms distance of all markers from where a calibrated robot has them, m; infinite where that is no
/// robot.
double FitError(const CalibrationResult& result, const Recording& recording,
                const CalibrationOptions& options) {
  if (IsNoRobot(result.prior_scale)) return std::numeric_limits<double>::infinity();
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

class MistakeSearch {
 public:
  MistakeSearch(const Project& project, std::optional<std::uint64_t> seed,
                const Measurements& measured, double error)
      : error_(error), project_(project), as_recorded_(measured), recording_(measured.calibration) {
    nominal_ = SelectMarkers(MakeProjectModel(project, recording_.trials), recording_.marker_names);
    seed_ = seed;
  }

  std::vector<RecordingMistake> Run() {
    std::vector<RecordingMistake> mistakes;
    while (mistakes.size() < kMostMistakes) {
      const std::vector<TriedCorrection> tried = Suspicions();
      if (tried.empty()) break;
      const TriedCorrection* best = nullptr;
      double least = kLeftOfError * error_;
      for (const TriedCorrection& one : tried) {
        const double left = Error(one.corrected);
        if (!(left < least)) continue;
        least = left;
        best = &one;
        if (left < kClearlyRight * error_) break;
      }
      if (best == nullptr) break;
      mistakes.push_back({best->what, error_, least});
      recording_ = Recording(best->corrected);
      error_ = least;
    }
    return mistakes;
  }

 private:
  std::vector<TriedCorrection> Suspicions() const {
    std::vector<TriedCorrection> tried;
    for (const LabelSuspicion& one :
         FindLabelSuspicions(nominal_, recording_, SeenClusters(project_, recording_))) {
      if (tried.size() >= kMostTried) break;
      tried.push_back({DescribeSuspicion(one, recording_), WithoutExchange(recording_, one)});
    }
    const std::size_t labels = tried.size();
    for (const LogSuspicion& one : FindLogSuspicions(nominal_, recording_)) {
      if (tried.size() >= labels + kMostTried) break;
      tried.push_back(
          {DescribeSuspicion(one, project_.tree, recording_), WithoutMistake(recording_, one)});
    }
    return tried;
  }

  /// Of a robot calibrated from the recording; infinite where nothing can be fitted.
  double Error(const Recording& recording) {
    if (!base_) {
      Measurements plain = as_recorded_;
      RecordedModel robot = MakeRecordedModel(project_, seed_, plain, KnockSearch::kNone);
      model_ = std::move(robot.model);
      base_ = std::move(robot.base);
    }
    try {
      return FitError(
          Calibrate(*model_, recording, *base_, ModelKinds(*model_).back(), project_.calibration),
          recording, project_.calibration);
    } catch (const InputError&) {
      return std::numeric_limits<double>::infinity();
    }
  }

  double error_;  // of the fit so far, m
  const Project& project_;
  const Measurements& as_recorded_;
  Recording recording_;
  ErrorModel nominal_;
  std::optional<std::uint64_t> seed_;
  std::optional<ErrorModel> model_;
  std::optional<BaseParameters> base_;
};

}  // namespace

std::vector<RecordingMistake> FindRecordingMistakes(const Project& project,
                                                    std::optional<std::uint64_t> seed,
                                                    const Measurements& measured,
                                                    const Recording& fitted,
                                                    const CalibrationResult& result) {
  if (measured.calibration.trials.empty()) return {};
  const double error = FitError(result, fitted, project.calibration);
  return MistakeSearch(project, seed, measured, error).Run();
}

std::string DescribeMistake(const RecordingMistake& mistake) {
  if (std::isinf(mistake.before)) {
    return fmt::format(
        "{}; without that the recording is explained to {:.3g} mm, with it only by errors that no "
        "robot has",
        mistake.what, 1e3 * mistake.after);
  }
  return fmt::format("{}; without that the error of the fit falls from {:.3g} to {:.3g} mm",
                     mistake.what, 1e3 * mistake.before, 1e3 * mistake.after);
}

}  // namespace elastocal
