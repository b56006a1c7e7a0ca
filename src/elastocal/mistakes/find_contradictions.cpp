// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/find_contradictions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/measurement/thinned_motions.hpp"
#include "elastocal/measurement/trial_names.hpp"
#include "elastocal/mistakes/estimated_place.hpp"
#include "elastocal/mistakes/general_fault.hpp"
#include "elastocal/mistakes/held_out_contrast.hpp"
#include "elastocal/mistakes/moved_between.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/mistakes/trials_apart.hpp"
#include "elastocal/screening/recording_faults.hpp"
#include "elastocal/validation/held_out.hpp"

namespace elastocal {
namespace {

constexpr double kContradicted = 10.0;
constexpr double kLeftByMistake = 0.3;  // of the error on held-out trials
constexpr int kUpdatesTogether = 15;  // of the noise, of trials that seem to contradict each other
constexpr std::size_t kManyKnocks = 3;  // clusters: of another robot, all are elsewhere
constexpr int kAtTheSeam = 2;           // postures
constexpr int kFilterSpreads = 2;       // postures beside exchanged ones, which the filter mixes

/// Without the markers that knocks added (SplitMarkers), which the project does not know.
Recording AsRecorded(const Recording& recording, const std::vector<Knock>& knocks) {
  Recording own = recording;
  for (const Knock& knock : knocks) {
    own.marker_names.resize(own.marker_names.size() - knock.markers.size());
  }
  own.markers.conservativeResize(Eigen::NoChange, 3 * own.marker_count());
  return own;
}

/// Of the largest model, m; infinite where nothing is judged.
double MeanError(const ModelComparison& comparison, const ErrorTable& table) {
  const auto found = table.mean_rmse_3d.find(comparison.largest_kind());
  return found == table.mean_rmse_3d.end() ? std::numeric_limits<double>::infinity()
                                           : found->second;
}

/// A mistake in the log or labels of held-out trials that the calibrated robot proves; else empty.
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

/// Whether the estimate has each of two markers where the project has the other.
bool AreExchanged(const CalibrationResult& result, int a, int b) {
  const auto from = [&](int m, int other) {
    return (EstimatedPlace(result, m) - result.model.markers[Size(other)].p_link_marker)
        .squaredNorm();
  };
  return from(a, b) + from(b, a) < from(a, a) + from(b, b);
}

std::string TrialsThatSee(const Recording& recording, int a, int b) {
  return TrialNames(recording, TrialsWith(recording, [&](int i) {
                      return Seen(recording, i, a) && Seen(recording, i, b);
                    }));
}

/// Two markers of one cluster that have each other's labels in all trials of the estimate that see
/// them, or in held-out postures.
struct Exchange {
  int a = -1, b = -1;
  std::vector<int> postures;  ///< held-out ones that are nearer to the model with it undone
  double before = 0.0;        ///< rms of all held-out distances, m
  double after = 0.0;         ///< with it undone
  bool of_estimate = false;   ///< the labels are wrong there, not in the held-out postures

  std::string Description(const Recording& recording, const Recording& held_out) const {
    return fmt::format(
        "the labels of {} and {} seem exchanged in {}: exchanged back, held-out trials are {:.3g} "
        "mm off the model, as they are {:.3g} mm",
        recording.marker_names[Size(a)], recording.marker_names[Size(b)],
        of_estimate ? "trial " + TrialsThatSee(recording, a, b)
                    : fmt::format("{} postures of trial {}", postures.size(),
                                  TrialsThatSee(SelectPostures(held_out, postures), a, b)),
        1e3 * after, 1e3 * before);
  }
};

/// Each side fits by itself, and where the distances to the cluster's others are much alike, only
/// the robot tells.
std::optional<Exchange> ExchangeWithinCluster(const Project& project, const Recording& recording,
                                              const Recording& held_out,
                                              const ModelComparison& comparison) {
  const auto squares_of = [&](const Recording& judged) -> Eigen::ArrayXXd {
    const HeldOut result = JudgeLargestOnTrials(comparison, judged, project.calibration);
    const auto& distances =
        result.predictions[static_cast<std::size_t>(comparison.largest_kind())].distances;
    return distances.array().isFinite().select(distances.array().square(), 0.0);
  };
  const Eigen::ArrayXXd given = squares_of(held_out);
  const double before = given.sum();
  const auto count = static_cast<double>((given > 0.0).count());
  double least = kLeftByMistake * kLeftByMistake * before;
  std::optional<Exchange> found;
  for (const LabelCluster& cluster : SeenClusters(project, recording)) {
    for (std::size_t i = 0; i < cluster.markers.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const int one = cluster.markers[j], other = cluster.markers[i];
        const Eigen::ArrayXd of_pair = given.col(one) + given.col(other);
        if (before - of_pair.sum() > least) continue;
        Recording exchanged = held_out;
        exchanged.markers.middleCols<3>(3 * one).swap(exchanged.markers.middleCols<3>(3 * other));
        const Eigen::ArrayXXd squares = squares_of(exchanged);
        const Eigen::ArrayXd left = squares.col(one) + squares.col(other);
        double gained = 0.0;
        std::vector<int> nearer;
        for (int k = 0; k < held_out.posture_count(); ++k) {
          if (!(left[k] < kLeftByMistake * of_pair[k])) continue;
          gained += of_pair[k] - left[k];
          nearer.push_back(k);
        }
        if (!(before - gained < least)) continue;
        least = before - gained;
        found = {one, other, nearer, std::sqrt(before / count), std::sqrt(least / count)};
      }
    }
  }
  if (found) found->of_estimate = AreExchanged(comparison.largest(), found->a, found->b);
  return found;
}

/// A joint that is off in all held-out trials may as well be off in those of the estimate; else
/// empty.
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

/// Without what the estimate left out.
Recording AsUsed(const Recording& recording, const CalibrationResult& result) {
  Recording used = recording;
  for (int i = 0; i < recording.posture_count(); ++i) {
    for (int m = 0; m < recording.marker_count(); ++m) {
      if (!result.used(i, m)) used.markers.block<1, 3>(i, 3 * m).setConstant(kNaN);
    }
  }
  return used;
}

/// Clusters that were knocked between trials or within one, as all of them together tell, the
/// held-out ones last. The trials of the estimate need not: where each shows other limbs, a waist
/// that was knocked between them moves all that they show.
std::vector<Knock> KnocksOfAll(const Project& project, const RecordedModel& robot,
                               const Recording& all) {
  return FindKnocks(robot.model, all, robot.base, SeenClusters(project, all), project.calibration);
}

std::string DescribeKnockOfAll(const Knock& knock, const Recording& all) {
  return fmt::format(
      "trials for calibration and for validation contradict each other: cluster {} seems to lie "
      "{:.1f} mm elsewhere from {} on than up to {} (trials for validation come last): was it "
      "knocked, or glued on again? Measure again what was recorded before or after it",
      knock.cluster, 1e3 * knock.distance, DescribePosture(all, knock.posture),
      DescribePosture(all, knock.last_before));
}

/// What says that the held-out trials are of another robot: where they are explained by themselves,
/// and those of the estimate by themselves, by half of the error that is left of both together (m)
/// once faults are undone; else empty.
std::string AnotherRobot(const RecordedModel& robot, const Recording& recording,
                         const Recording& held_out, const CalibrationResult& estimate, double left,
                         const CalibrationOptions& options) {
  std::vector<PartOfRecording> parts(2);
  for (int i = 0; i < recording.posture_count(); ++i) parts[0].postures.push_back(i);
  for (int i = 0; i < held_out.posture_count(); ++i) {
    parts[1].postures.push_back(recording.posture_count() + i);
  }
  const std::vector<double> errors = {MarkerError(estimate, recording, options),
                                      ErrorAlone(robot, held_out, estimate.kind, options)};
  if (!std::isfinite(errors[1])) return "";
  const double apart = ErrorOverParts(JoinTrials(recording, held_out), parts, errors);
  if (!AreApart(apart, left)) return "";
  return fmt::format(
      "trials for calibration and for validation contradict each other: one robot leaves an error "
      "of {:.3g} mm, robots of their own {:.3g} mm and {:.3g} mm. Are they of different robots or "
      "days, or was the robot changed in between? Measure one of them again",
      1e3 * left, 1e3 * errors[0], 1e3 * errors[1]);
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

std::string DescribeContrast(const Contrast& contrast) {
  char text[200];
  std::snprintf(text, sizeof text,
                "the model errs by %.3g mm on them, and by %.3g mm on those of the estimate; "
                "something differs between the recordings",
                1e3 * contrast.held_out, 1e3 * contrast.fitted);
  return "held-out trials of " + contrast.group + " contradict those of the estimate: " + text;
}

ErrorTable FittedTable(const Project& project, const Recording& recording,
                       const ModelComparison& comparison) {
  return JudgeOnTrials(comparison, AsUsed(recording, comparison.largest()), project.calibration)
      .table;
}

/// Whether held-out trials are suspiciously worse than those of the estimate, and by how much.
Contrast ContrastOf(const Project& project, const Recording& recording,
                    const ModelComparison& comparison, const ErrorTable& fitted,
                    const ErrorTable& held_out_table) {
  return LargestContrast(fitted, held_out_table, SeenClusters(project, recording),
                         comparison.largest_kind());
}

}  // namespace

std::string LeaveOutBriefExchange(const Project& project, const Recording& recording,
                                  const ModelComparison& comparison,
                                  const ErrorTable& held_out_table, Recording& held_out) {
  const ErrorTable fitted = FittedTable(project, recording, comparison);
  if (!ContrastOf(project, recording, comparison, fitted, held_out_table).suspicious()) return "";
  const std::optional<Exchange> found =
      ExchangeWithinCluster(project, recording, held_out, comparison);
  if (!found || found->of_estimate) return "";
  // Half of what the trials that it is in show of the two: a tracker that lost them for a while.
  int seen = 0;
  for (int i = 0; i < held_out.posture_count(); ++i) {
    const bool in_trial =
        std::any_of(found->postures.begin(), found->postures.end(), [&](int exchanged) {
          return held_out.trials.empty() || held_out.trial[exchanged] == held_out.trial[i];
        });
    if (in_trial && Seen(held_out, i, found->a) && Seen(held_out, i, found->b)) ++seen;
  }
  if (2 * static_cast<int>(found->postures.size()) > seen) return "";
  const std::string text =
      found->Description(recording, held_out) + ". The two are left out of the judgement there";
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
  const Contrast contrast = ContrastOf(project, recording, comparison, fitted, held_out_table);
  if (!contrast.suspicious()) return {};
  const std::string mistake =
      MistakeInHeldOut(project, held_out, robot.knocks, comparison, held_out_table);
  if (!mistake.empty()) return {mistake};
  const std::optional<Exchange> exchange =
      ExchangeWithinCluster(project, recording, held_out, comparison);
  if (exchange) {
    return {exchange->Description(recording, held_out) +
            ". Correct the labels and calibrate again"};
  }
  const Recording thinned = WithThinnedMotions(held_out, recording.posture_count());
  const Recording all = JoinedWithTimes(recording, thinned);
  // Trials that contradict each other keep noise and outliers from coming to rest.
  CalibrationOptions roughly = project.calibration;
  roughly.outliers = OutlierPolicy::kKeep;
  roughly.max_iterations = std::min(roughly.max_iterations, kUpdatesTogether);
  const CalibrationResult together = Calibrate(robot.model, JoinTrials(recording, thinned),
                                               robot.base, comparison.largest().kind, roughly);
  const auto another = [&] {
    return AnotherRobot(robot, recording, thinned, comparison.largest(),
                        MarkerError(together, all, roughly), roughly);
  };
  std::vector<RecordingFault> faults = FindRecordingFaults(together, all, project.calibration);
  std::erase_if(faults, [&](const RecordingFault& one) { return MayBeInertia(one, all); });
  if (!faults.empty()) {
    const GeneralFault general{
        faults.front(), robot.model, robot.base, all, comparison.largest_kind(), roughly};
    const FaultsInWords words = ExplainFault(general, project);
    const std::string other = words.complete ? "" : another();
    if (!other.empty()) return {other};
    return {"trials for calibration and for validation contradict each other: " + words.text +
            OrInThoseOfTheEstimate(faults.front(), all, recording)};
  }
  if (!(std::max(contrast.ratio(), contrast.largest_of_clusters) > kContradicted)) return {};
  const std::vector<Knock> knocks = KnocksOfAll(project, robot, all);
  const std::string other = knocks.size() < kManyKnocks ? "" : another();
  if (!other.empty()) return {other};
  if (!knocks.empty()) return {DescribeKnockOfAll(knocks.front(), all)};
  const std::string moved =
      FindMovedBetween(project, together, all, roughly,
                       MovedSuspects(SeenClusters(project, recording), fitted, held_out_table,
                                     comparison.largest_kind(), all));
  if (!moved.empty()) {
    return {"trials for calibration and for validation contradict each other: " + moved};
  }
  if (!(contrast.ratio() > kContradicted)) return {};
  return {DescribeContrast(contrast)};
}

}  // namespace elastocal
