// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/find_contradictions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/measurement/thinned_motions.hpp"
#include "elastocal/measurement/trial_names.hpp"
#include "elastocal/mistakes/exchange_within_cluster.hpp"
#include "elastocal/mistakes/general_fault.hpp"
#include "elastocal/mistakes/held_out_contrast.hpp"
#include "elastocal/mistakes/moved_between.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/mistakes/recordings_apart.hpp"
#include "elastocal/mistakes/trials_apart.hpp"
#include "elastocal/screening/recording_faults.hpp"
#include "elastocal/validation/held_out.hpp"

namespace elastocal {
namespace {

constexpr double kContradicted = 10.0;
constexpr char kContradict[] = "trials for calibration and for validation contradict each other: ";
constexpr double kLeftByMistake = 0.3;  // share of the error on held-out trials
// Updates of the noise for trials that seem to contradict each other.
constexpr int kUpdatesTogether = 15;
constexpr int kAtTheSeam = 2;      // postures
constexpr int kFilterSpreads = 2;  // postures beside exchanged ones, which the filter mixes

/// The recording without the markers that knocks added (SplitMarkers), which the project does not
/// have.
Recording AsRecorded(const Recording& recording, const std::vector<Knock>& knocks) {
  Recording own = recording;
  for (const Knock& knock : knocks) {
    own.marker_names.resize(own.marker_names.size() - knock.markers.size());
  }
  own.markers.conservativeResize(Eigen::NoChange, 3 * own.marker_count());
  return own;
}

/// Mean error of the largest model, m; infinite where nothing is judged.
double MeanError(const ModelComparison& comparison, const ErrorTable& table) {
  const auto found = table.mean_rmse_3d.find(comparison.largest_kind());
  return found == table.mean_rmse_3d.end() ? std::numeric_limits<double>::infinity()
                                           : found->second;
}

/// Finds a mistake in the log or labels of held-out trials that the calibrated robot proves; else
/// empty.
std::string MistakeInHeldOut(const Project& project, const Recording& held_out,
                             const std::vector<Knock>& knocks, const ModelComparison& comparison,
                             const ErrorTable& table) {
  const double before = MeanError(comparison, table);
  const auto error_of = [&](Recording corrected) {
    AddUnseenMarkers(comparison.largest().model, corrected);
    try {
      return MeanError(comparison,
                       JudgeLargestOnTrials(comparison, corrected, project.calibration).table);
    } catch (const InputError&) {
      return std::numeric_limits<double>::infinity();
    }
  };
  const std::vector<RecordingMistake> mistakes =
      FindMistakesBy(project, AsRecorded(held_out, knocks), before, error_of, {}, kLeftByMistake);
  if (mistakes.empty()) return "";
  std::string what, names;
  for (const RecordingMistake& one : mistakes) {
    what += (what.empty() ? "" : "; ") + one.what;
    if (!one.name.empty()) names += " " + one.name;
  }
  return fmt::format(
      "in trials for validation {}; without that the calibrated robot errs by {:.3g} mm on them, "
      "with it by {:.3g} mm{}",
      what, 1e3 * mistakes.back().after, 1e3 * before,
      names.empty() ? "" : " (--accept" + names + " corrects it)");
}

/// If a joint is off in all held-out trials, adds that it may instead be off in those of the
/// estimate; else empty.
std::string OrInThoseOfTheEstimate(const RecordingFault& fault, const Recording& all,
                                   const Recording& estimated) {
  const bool to_the_end = fault.trial < 0 || fault.trial + 1 == std::ssize(all.trials);
  const bool in_all_held_out = fault.kind == FaultKind::kJointOffset && fault.linkage < 0 &&
                               fault.end == 0 && to_the_end &&
                               std::abs(fault.posture - estimated.posture_count()) <= kAtTheSeam;
  if (!in_all_held_out) return "";
  std::vector<int> moving = TrialsThatMove(all, fault.coordinate);
  std::erase_if(moving, [&](int trial) { return trial >= std::ssize(estimated.trials); });
  const std::string names = TrialNames(estimated, moving);
  return names.empty() ? ""
                       : "; it may as well be off by the opposite in " + names +
                             ", which the recording does not tell: measure it there again";
}

/// `factor` as names that correct it in each trial of the recording.
std::string NamesOfScale(double factor, const Recording& recording) {
  std::string names;
  for (const Trial& trial : recording.trials) {
    names += fmt::format(" scale:{}={:.5f}", trial.name, factor);
  }
  return names;
}

/// If the cameras' scale is wrong in all held-out trials, adds that that of the trials of the
/// estimate may be wrong by the inverse instead; else empty.
std::string OrInverseScale(const std::vector<RecordingFault>& faults, const Recording& all,
                           const Recording& estimated) {
  double scale = 1.0;
  int scales = 0;
  for (const RecordingFault& fault : faults) {
    if (fault.kind != FaultKind::kCameraScale) continue;
    if (fault.trial < std::ssize(estimated.trials)) return "";
    scale *= 1.0 + fault.size;
    ++scales;
  }
  if (scales == 0 || scales < std::ssize(all.trials) - std::ssize(estimated.trials)) return "";
  const double inverse = 1.0 / std::pow(scale, 1.0 / scales);
  return fmt::format(
      "; they may as well be {:.4f} times the true ones in trial {} (--accept{} corrects that), "
      "which the recording does not tell: measure a known length (recording.reference_lengths)",
      inverse, TrialNames(estimated, TrialsWith(estimated, [](int) { return true; })),
      NamesOfScale(inverse, estimated));
}

/// The recording without the observations that the estimate left out.
Recording AsUsed(const Recording& recording, const CalibrationResult& result) {
  Recording used = recording;
  for (int i = 0; i < recording.posture_count(); ++i) {
    for (int m = 0; m < recording.marker_count(); ++m) {
      if (!result.used(i, m)) used.markers.block<1, 3>(i, 3 * m).setConstant(kNaN);
    }
  }
  return used;
}

/// Finds clusters that were knocked between trials or within one, by all trials together, the
/// held-out ones last. The trials of the estimate alone need not show it: if each shows other
/// limbs, a waist that was knocked between them displaces everything that they show.
std::vector<Knock> KnocksOfAll(const Project& project, const RecordedModel& robot,
                               const Recording& all) {
  return FindKnocks(robot.model, all, robot.base, SeenClusters(project, all), project.calibration);
}

std::string DescribeKnockOfAll(const Knock& knock, const Recording& all) {
  return fmt::format(
      "{}cluster {} seems to lie {:.1f} mm elsewhere from {} on than up to {} (trials for "
      "validation come last): was it knocked, or glued on again? Measure again what was recorded "
      "before or after it",
      kContradict, knock.cluster, 1e3 * knock.distance, DescribePosture(all, knock.posture),
      DescribePosture(all, knock.last_before));
}

/// All trials, with the times of their postures where both have them: within each trial they tell
/// how fast joints moved.
Recording JoinedWithTimes(const Recording& recording, const Recording& held_out) {
  Recording all = JoinTrials(recording, held_out);
  all.time_s.resize(recording.time_s.size() + held_out.time_s.size());
  all.time_s << recording.time_s, held_out.time_s;
  if (all.time_s.size() != all.posture_count()) all.time_s.resize(0);
  return all;
}

/// Describes the contrast of a group, or that of a cluster where the former says too little.
std::string DescribeContrast(const Contrasts& contrasts) {
  const bool by_group = contrasts.of_groups.ratio() > kContradicted;
  const Contrast& contrast = by_group ? contrasts.of_groups : contrasts.of_clusters;
  return fmt::format(
      "held-out trials of {}{} contradict those of the estimate: the model errs by {:.3g} mm on "
      "them, and by {:.3g} mm on those of the estimate; something differs between the recordings",
      by_group ? "" : "cluster ", contrast.name, 1e3 * contrast.held_out, 1e3 * contrast.fitted);
}

ErrorTable FittedTable(const Project& project, const Recording& recording,
                       const ModelComparison& comparison) {
  return JudgeOnTrials(comparison, AsUsed(recording, comparison.largest()), project.calibration)
      .table;
}

/// How much worse held-out trials are predicted than those of the estimate are fitted.
Contrasts ContrastsOf(const Project& project, const Recording& recording,
                      const ModelComparison& comparison, const ErrorTable& fitted,
                      const ErrorTable& held_out_table) {
  return LargestContrasts(fitted, held_out_table, SeenClusters(project, recording),
                          comparison.largest_kind());
}

/// Trials of the estimate and held-out ones, and one fit of all of them.
struct AllTrials {
  Recording held_out;  ///< fewer moments of its motions
  Recording recording;
  CalibrationOptions options;
  CalibrationResult fit;
};

AllTrials FitTogether(const Project& project, const RecordedModel& robot,
                      const Recording& recording, const Recording& held_out, ModelKind kind) {
  AllTrials all;
  all.held_out = WithThinnedMotions(held_out, recording.posture_count());
  // Noise and outliers of contradictory trials hardly come to rest.
  all.options = project.calibration;
  all.options.outliers = OutlierPolicy::kKeep;
  all.options.max_iterations = std::min(all.options.max_iterations, kUpdatesTogether);
  all.fit =
      Calibrate(robot.model, JoinTrials(recording, all.held_out), robot.base, kind, all.options);
  all.recording = JoinedWithTimes(recording, all.held_out);
  return all;
}

/// Factor of the scale of the cameras in the trials of the estimate to that in held-out trials: one
/// robot leaves least in all of them with the former undone. Nothing where that leaves more than
/// half of `left`, the error without it, m.
std::optional<double> ScaleBetween(const Project& project, const RecordedModel& robot,
                                   const Recording& recording, const Recording& held_out,
                                   ModelKind kind, double left) {
  constexpr double kLeftByScale = 0.5;
  const auto square = [&](double factor) {
    Recording undone = recording;
    undone.markers /= factor;
    const AllTrials all = FitTogether(project, robot, undone, held_out, kind);
    return std::pow(MarkerError(all.fit, all.recording, all.options), 2);
  };
  double best = 1.0, least = left * left;
  for (const double step : {1e-2, 1e-3, 1e-4}) {  // the square is nearly a parabola of the factor
    const double below = square(best - step), above = square(best + step);
    const double bend = below - 2.0 * least + above;
    if (!(bend > 0.0)) return std::nullopt;
    best += 0.5 * step * (below - above) / bend;
    least = square(best);
    if (!(least < std::pow(kLeftByScale * left, 2))) return std::nullopt;
  }
  return best;
}

std::string DescribeScaleBetween(double factor, const Recording& recording) {
  return fmt::format(
      "{}camera positions are {:.4f} times the true ones in trial {} (--accept{} corrects it)",
      kContradict, factor, TrialNames(recording, TrialsWith(recording, [](int) { return true; })),
      NamesOfScale(factor, recording));
}

/// Says that the held-out trials are of another robot; empty where they are not. They are if two
/// separate robots leave less than half of `left`, the error of one robot (m), and if one robot
/// whose markers are elsewhere in the held-out trials leaves clearly more than the two: else
/// clusters were knocked or glued on anew.
std::string AnotherRobot(const Project& project, const RecordedModel& robot,
                         const Recording& recording, const AllTrials& all, double left) {
  std::vector<PartOfRecording> parts = {{"calibration", {}}, {"validation", {}}};
  for (int i = 0; i < all.recording.posture_count(); ++i) {
    parts[i < recording.posture_count() ? 0 : 1].postures.push_back(i);
  }
  const auto alone = [&](const Recording& part) {
    return ErrorAlone(robot, part, all.fit.kind, all.options);
  };
  const std::vector<double> errors = {alone(recording), alone(all.held_out)};
  if (!std::isfinite(errors[0]) || !std::isfinite(errors[1])) return "";
  const double apart = ErrorOverParts(all.recording, parts, errors);
  if (!AreApart(apart, left) ||
      AreMarkersApart(ErrorWithOwnMarkers(project, all.fit, all.recording, parts), apart)) {
    return "";
  }
  return fmt::format(
      "{}one robot leaves an error of {:.3g} mm, robots of their own {:.3g} mm and {:.3g} mm. Are "
      "they of different robots or days, or was the robot changed in between? Measure one of them "
      "again",
      kContradict, 1e3 * left, 1e3 * errors[0], 1e3 * errors[1]);
}

/// Faults of a robot in all trials, the one that explains most first.
std::vector<RecordingFault> FaultsOfAll(const AllTrials& all, const CalibrationOptions& options) {
  std::vector<RecordingFault> faults = FindRecordingFaults(all.fit, all.recording, options);
  std::erase_if(faults,
                [&](const RecordingFault& one) { return MayBeInertia(one, all.recording); });
  return faults;
}

}  // namespace

std::string LeaveOutBriefExchange(const Project& project, const Recording& recording,
                                  const ModelComparison& comparison,
                                  const ErrorTable& held_out_table, Recording& held_out) {
  const ErrorTable fitted = FittedTable(project, recording, comparison);
  if (!ContrastsOf(project, recording, comparison, fitted, held_out_table).suspicious()) return "";
  const std::optional<LabelExchange> found =
      ExchangeWithinCluster(project, recording, held_out, comparison);
  if (!found || found->of_estimate) return "";
  // Half of the observations of the two in these trials: a tracker lost them for a while.
  int seen = 0;
  for (int i = 0; i < held_out.posture_count(); ++i) {
    const bool in_trial =
        std::any_of(found->postures.begin(), found->postures.end(), [&](int exchanged) {
          return held_out.trials.empty() || held_out.trial[exchanged] == held_out.trial[i];
        });
    if (in_trial && Seen(held_out, i, found->a) && Seen(held_out, i, found->b)) ++seen;
  }
  if (2 * static_cast<int>(found->postures.size()) > seen) return "";
  const std::string text = DescribeExchange(*found, recording, held_out) +
                           ". The two are left out of the judgement there";
  for (const int exchanged : found->postures) {
    const int first = std::max(0, exchanged - kFilterSpreads);
    const int last = std::min(held_out.posture_count() - 1, exchanged + kFilterSpreads);
    for (int i = first; i <= last; ++i) {
      if (!held_out.trials.empty() && held_out.trial[i] != held_out.trial[exchanged]) continue;
      for (const int marker : {found->a, found->b}) {
        held_out.markers.block<1, 3>(i, 3 * marker).setConstant(std::nan(""));
      }
    }
  }
  return text;
}

std::vector<std::string> FindContradictions(const Project& project, const RecordedModel& robot,
                                            const Recording& recording, const Recording& held_out,
                                            const ModelComparison& comparison,
                                            const ErrorTable& held_out_table) {
  const ErrorTable fitted = FittedTable(project, recording, comparison);
  const Contrasts contrasts = ContrastsOf(project, recording, comparison, fitted, held_out_table);
  if (!contrasts.suspicious()) return {};
  const std::string mistake =
      MistakeInHeldOut(project, held_out, robot.knocks, comparison, held_out_table);
  if (!mistake.empty()) return {mistake};
  const std::optional<LabelExchange> exchange =
      ExchangeWithinCluster(project, recording, held_out, comparison);
  if (exchange) {
    return {DescribeExchange(*exchange, recording, held_out) +
            ". Correct the labels and calibrate again"};
  }
  const AllTrials all = FitTogether(project, robot, recording, held_out, comparison.largest_kind());
  const std::vector<RecordingFault> faults = FaultsOfAll(all, project.calibration);
  if (!faults.empty()) {
    const GeneralFault general{
        faults.front(), robot.model, robot.base, all.recording, comparison.largest_kind(),
        all.options};
    const FaultsInWords words = ExplainFault(general, project);
    const std::string other =
        words.complete ? "" : AnotherRobot(project, robot, recording, all, words.left);
    if (!other.empty()) return {other};
    return {kContradict + words.text +
            OrInThoseOfTheEstimate(faults.front(), all.recording, recording) +
            OrInverseScale(words.faults, all.recording, recording)};
  }
  if (!(contrasts.largest() > kContradicted)) return {};
  const std::vector<Knock> knocks = KnocksOfAll(project, robot, all.recording);
  if (!knocks.empty()) {
    const double left = MarkerError(all.fit, all.recording, all.options);
    const std::string other = AnotherRobot(project, robot, recording, all, left);
    return {other.empty() ? DescribeKnockOfAll(knocks.front(), all.recording) : other};
  }
  const std::string moved =
      FindMovedBetween(project, all.fit, all.recording, all.options,
                       MovedSuspects(SeenClusters(project, recording), fitted, held_out_table,
                                     comparison.largest_kind(), all.recording));
  if (!moved.empty()) return {kContradict + moved};
  return {DescribeContrast(contrasts)};
}

std::string TellScaleOfTrials(const Project& project, const RecordedModel& robot,
                              const Recording& recording, const Recording& held_out, ModelKind kind,
                              const std::string& of_all) {
  if (recording.trials.empty() || held_out.posture_count() == 0 ||
      held_out.marker_names != recording.marker_names) {
    return of_all;
  }
  try {
    const AllTrials all = FitTogether(project, robot, recording, held_out, kind);
    const double left = MarkerError(all.fit, all.recording, all.options);
    const auto factor = ScaleBetween(project, robot, recording, held_out, kind, left);
    return factor ? DescribeScaleBetween(*factor, recording) : of_all;
  } catch (const InputError&) {
    return of_all;  // too little can be judged
  }
}

}  // namespace elastocal
