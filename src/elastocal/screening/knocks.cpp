// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/knocks.hpp"

#include <algorithm>
#include <numeric>

#include "elastocal/calibration/fit.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/moments.hpp"
#include "elastocal/measurement/thinned_motions.hpp"
#include "elastocal/screening/displacement_step.hpp"
#include "elastocal/screening/split_markers.hpp"

namespace elastocal {
namespace {

constexpr int kMaxKnocks = 4;
constexpr int kKnockUpdates = 6;         // steps, each with an update of the noise
constexpr double kLeastDistance = 1e-3;  // m
constexpr double kLeastScatters = 3.0;
// Least significance in motions, where correlations are known only roughly.
constexpr double kLeastInMotion = 2.0;
// Moments of motions by which it is decided whether a search is worth its time.
constexpr int kMostMoments = 250;
constexpr int kWorthThinning = 4;     // ratio of postures from which thinning saves time
constexpr double kShareOfStep = 0.7;  // share of a step that few of the moments must show

std::vector<int> Estimated(const ErrorModel& model, const BaseParameters& base) {
  std::vector<int> free;
  for (int i = 0; i < model.parameter_count(); ++i) {
    const bool held = std::binary_search(base.held.begin(), base.held.end(), i);
    if (!held && model.parameters[i].kind != ParameterKind::kWaistPose) free.push_back(i);
  }
  return free;
}

bool IsKnock(const DisplacementStep& step, double significance) {
  return step.cluster >= 0 && step.significance > significance &&
         step.displacement.norm() >= std::max(kLeastDistance, kLeastScatters * step.scatter);
}

bool SeenOnBothSides(const Recording& recording, int marker, int posture) {
  bool sides[2] = {false, false};
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (Seen(recording, i, marker)) sides[i < posture ? 0 : 1] = true;
  }
  return sides[0] && sides[1];
}

std::string NameBefore(const std::string& name, const std::vector<std::string>& taken) {
  for (int n = 1;; ++n) {
    std::string candidate = name + (n == 1 ? "(before)" : "(before " + std::to_string(n) + ")");
    if (std::find(taken.begin(), taken.end(), candidate) == taken.end()) return candidate;
  }
}

/// For each posture: whether it is one of the first `count`.
std::vector<char> First(std::ptrdiff_t count, const Recording& recording) {
  std::vector<char> first(Size(recording.posture_count()), 0);
  std::fill_n(first.begin(), count, 1);
  return first;
}

void SplitOne(const Knock& knock, ErrorModel& model, Recording& recording) {
  std::vector<std::string> names;
  for (const int m : knock.markers) {
    names.push_back(NameBefore(model.markers[m].name, recording.marker_names));
  }
  SplitMarkersOf(knock.markers, names, First(knock.posture, recording), model, recording);
}

/// The experiment, split at the knocks that were found so far.
struct SplitExperiment {
  ErrorModel model;
  Recording recording;
  std::vector<LabelCluster> clusters;
  std::vector<int> free;
  Fit fit;
};

Knock KnockAt(const DisplacementStep& step, const SplitExperiment& search) {
  std::vector<int> markers = search.clusters[step.cluster].markers;
  std::erase_if(markers,
                [&](int m) { return !SeenOnBothSides(search.recording, m, step.posture); });
  return {search.clusters[step.cluster].name, markers,          step.posture, step.last_before,
          step.displacement.norm(),           step.significance};
}

/// Splits the markers of a cluster; each new marker gets the position of its other half.
void Split(const Knock& knock, int cluster, SplitExperiment& search) {
  const int first_new = search.model.marker_count();
  SplitOne(knock, search.model, search.recording);
  Fit& fit = search.fit;
  const auto first = fit.delta.size();
  fit.delta.conservativeResize(search.model.parameter_count());
  LabelCluster before = search.clusters[cluster];
  before.name += "(before)";
  before.markers.clear();
  for (std::size_t n = 0; n < knock.markers.size(); ++n) {
    const auto at = first + 3 * static_cast<Eigen::Index>(n);
    fit.delta.segment<3>(at) = fit.delta.segment<3>(first - 3 * (first_new - knock.markers[n]));
    for (int axis = 0; axis < 3; ++axis) search.free.push_back(static_cast<int>(at) + axis);
    before.markers.push_back(first_new + static_cast<int>(n));
  }
  search.clusters.push_back(std::move(before));
}

/// In a motion: the step computed again, with errors as correlated as they are without the knock.
DisplacementStep AmongCorrelated(const DisplacementStep& step, SplitExperiment search,
                                 const CalibrationOptions& options) {
  SplitExperiment without = search;
  Split(KnockAt(step, search), step.cluster, without);
  const std::vector<int> groups = NoiseGroups(search.model, search.recording);
  const FitProblem problem{without.model, without.recording, options, groups};
  const Selection selection = SelectAll(without.model, without.recording);
  without.fit = FitParameters(problem, selection, without.free, without.fit, Robustness::kMoments,
                              kKnockUpdates);
  CorrelateMotions(problem, selection, without.free, without.fit);
  search.fit.noise = without.fit.noise;
  return FindLargestStep({search.model, search.recording, options, groups},
                         SelectAll(search.model, search.recording), search.free, search.fit,
                         search.clusters, options.outlier_probability);
}

SplitExperiment StartSearch(const ErrorModel& model, const Recording& recording,
                            const BaseParameters& base, const std::vector<LabelCluster>& clusters,
                            const CalibrationOptions& options) {
  SplitExperiment search{model, recording, clusters, Estimated(model, base), {}};
  const FitProblem problem{search.model, search.recording, options, NoiseGroups(model, recording)};
  search.fit = StartFit(problem, SelectAll(model, recording),
                        Eigen::VectorXd::Zero(model.parameter_count()));
  return search;
}

/// Fits what is known so far, and finds the largest step in each of these sets of clusters.
std::vector<DisplacementStep> NextSteps(const CalibrationOptions& options,
                                        const std::vector<std::vector<LabelCluster>>& sets,
                                        SplitExperiment& search) {
  const FitProblem problem{search.model, search.recording, options,
                           NoiseGroups(search.model, search.recording)};
  const Selection selection = SelectAll(search.model, search.recording);
  search.fit = FitParameters(problem, selection, search.free, search.fit, Robustness::kMoments,
                             kKnockUpdates);
  std::vector<DisplacementStep> steps;
  for (const std::vector<LabelCluster>& clusters : sets) {
    steps.push_back(FindLargestStep(problem, selection, search.free, search.fit, clusters,
                                    options.outlier_probability));
  }
  return steps;
}

/// Whether a recording of thousands of moments may contain a knock, by every tenth of its moments.
/// A step in all moments is about as large in these, and has about a tenth of its significance.
/// Only steps of its own cluster are compared, because postures of rest, which are all kept, may
/// give another cluster a larger one.
bool MayHaveKnock(const ErrorModel& model, const Recording& recording, const BaseParameters& base,
                  const std::vector<LabelCluster>& clusters, const CalibrationOptions& options) {
  const Recording thinned = WithThinnedMotions(recording, kMostMoments);
  if (kWorthThinning * thinned.posture_count() > recording.posture_count()) return true;
  SplitExperiment search = StartSearch(model, thinned, base, clusters, options);
  std::vector<std::vector<LabelCluster>> each;
  for (const LabelCluster& cluster : clusters) each.push_back({cluster});
  const double share = static_cast<double>(thinned.posture_count()) / recording.posture_count();
  const std::vector<DisplacementStep> steps = NextSteps(options, each, search);
  return std::any_of(steps.begin(), steps.end(), [&](const DisplacementStep& step) {
    return step.cluster >= 0 && step.significance > kShareOfStep * share &&
           step.displacement.norm() >=
               kShareOfStep * std::max(kLeastDistance, kLeastScatters * step.scatter);
  });
}

}  // namespace

std::vector<Knock> FindKnocks(const ErrorModel& model, const Recording& recording,
                              const BaseParameters& base, const std::vector<LabelCluster>& clusters,
                              const CalibrationOptions& options) {
  if (recording.trials.empty()) return {};
  CalibrationOptions quick = options;
  quick.support_form = SupportForm::kNuisance;
  if (!MayHaveKnock(model, recording, base, clusters, quick)) return {};
  SplitExperiment search = StartSearch(model, recording, base, clusters, quick);
  std::vector<Knock> knocks;
  while (static_cast<int>(knocks.size()) < kMaxKnocks) {
    DisplacementStep step = NextSteps(quick, {search.clusters}, search).front();
    if (!IsKnock(step, 1.0)) break;
    if (HasMotion(recording)) {
      step = AmongCorrelated(step, search, quick);
      if (!IsKnock(step, kLeastInMotion)) break;
    }
    knocks.push_back(KnockAt(step, search));
    Split(knocks.back(), step.cluster, search);
  }
  return knocks;
}

void SplitMarkers(const std::vector<Knock>& knocks, ErrorModel& model, Recording& recording) {
  for (const Knock& knock : knocks) SplitOne(knock, model, recording);
}

void SplitLeftOut(const std::vector<Knock>& knocks, const ErrorModel& model,
                  const std::vector<int>& searched, const std::vector<int>& left_out,
                  Recording& recording) {
  for (const Knock& knock : knocks) {
    const auto before =
        std::upper_bound(left_out.begin(), left_out.end(), searched[knock.last_before]);
    const auto after = std::lower_bound(left_out.begin(), left_out.end(), searched[knock.posture]);
    for (int m : knock.markers) {
      SplitMarker(m, model.markers[recording.marker_count()].name,
                  First(before - left_out.begin(), recording), recording);
      recording.markers.middleCols<3>(3 * m)
          .middleRows(before - left_out.begin(), after - before)
          .setConstant(kNaN);
    }
  }
}

std::vector<int> MarkersBeforeSplit(const std::vector<Knock>& knocks, int marker_count) {
  std::vector<int> origins(marker_count);
  std::iota(origins.begin(), origins.end(), 0);
  for (const Knock& knock : knocks) {
    for (int m : knock.markers) origins.push_back(origins[m]);
  }
  return origins;
}

void AddUnseenMarkers(const ErrorModel& model, Recording& recording) {
  const Eigen::Index before = recording.markers.cols();
  for (int m = recording.marker_count(); m < model.marker_count(); ++m) {
    recording.marker_names.push_back(model.markers[m].name);
  }
  recording.markers.conservativeResize(Eigen::NoChange, 3 * recording.marker_count());
  recording.markers.rightCols(recording.markers.cols() - before).setConstant(kNaN);
}

}  // namespace elastocal
