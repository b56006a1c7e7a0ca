// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/general_fault.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/describe_posture.hpp"
#include "elastocal/mistakes/clusters_beside.hpp"
#include "elastocal/mistakes/placed_gains.hpp"
#include "elastocal/mistakes/placed_offset.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/mistakes/stated_corrections.hpp"
#include "elastocal/mistakes/tried_correction.hpp"
#include "elastocal/recorded/find_base.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/robot/move_motors.hpp"
#include "elastocal/screening/frame_shifts.hpp"
#include "elastocal/screening/measured_faults.hpp"
#include "elastocal/screening/recording_faults.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMostTogether = 4;
constexpr int kMostFits = 8;
constexpr int kSweeps = 2;  // rounds in which each size is estimated beside the others
// Largest change of a gain in one step, beyond which a derivative tells little.
constexpr double kLargestStep = 0.3;
constexpr double kFewestSds = 6.0;      // of a fault beside the others
constexpr int kSamePlace = 2;           // postures
constexpr std::size_t kFewHomed = 2;    // more joints than this differ in another robot
constexpr std::size_t kSeveral = 2;     // number of joints that begin to be off at the same place
constexpr double kClearlyBetter = 0.8;  // ratio to the error that one joint leaves
constexpr double kAsWell = 1.1;         // ratio to the error that joints leave

/// Corrects the chosen fault, fits, and searches again.
class FaultExplanation {
 public:
  FaultExplanation(const GeneralFault& general, const Project& project)
      : general_(general), project_(project) {
    Collect(general.fault, true);
    if (faults_.size() > 1 && Drifts()) TryWithoutDrift();
    if (complete_ && faults_.front().linkage < 0) EstimateTogether();
    if (complete_) faults_ = PlaceGains(faults_, Undone(), general_);
    if (complete_ && faults_.size() == 1) {
      const PlacedOffset offset = PlaceOffset(faults_.front(), general_);
      faults_.front() = offset.fault;
      placed_ = offset.told || offset.refuted;
      refuted_ = offset.refuted;
    }
  }

  bool complete() const { return complete_; }
  bool placed() const { return placed_; }
  double left() const { return left_; }
  const std::vector<RecordingFault>& faults() const { return faults_; }

  std::string Describe() const {
    const bool single = faults_.size() == 1 && complete_;
    const std::string cluster = MovedCluster(single ? kClearlyBetter : kAsWell);
    if (!cluster.empty()) return cluster;
    if (single) return Remedy(faults_.front()) + (refuted_ ? kOrInAllOthers : "");
    const std::string together = SeveralJoints();
    if (!together.empty()) return together;
    if (complete_) return FaultsAndRemedies(faults_, project_.tree, general_.recording);
    std::string text;
    for (const RecordingFault& one : faults_) {
      text += (text.empty() ? "" : "; ") + DescribeFault(one, project_.tree, general_.recording);
    }
    return "something differs between the postures that no few faults explain; nearest to it "
           "come: " +
           text;
  }

 private:
  std::string Remedy(const RecordingFault& fault) const {
    return FaultAndRemedy(fault, project_.tree, general_.recording);
  }

  struct SplitRecording {
    ErrorModel model;
    Recording recording;
  };

  CalibrationResult Fit(const ErrorModel& model, const BaseParameters& base,
                        const Recording& recording) const {
    if (general_.fit) return general_.fit(model, base, recording);
    return Calibrate(model, recording, base, general_.kind, general_.options);
  }
  CalibrationResult Fit(const Recording& recording) const {
    return Fit(general_.model, general_.base, recording);
  }
  CalibrationResult Fit(const SplitRecording& split) const {
    return Fit(split.model, FindBaseOf(project_, split.model, split.recording), split.recording);
  }

  static bool IsSame(const RecordingFault& a, const RecordingFault& b) {
    return a.kind == b.kind && a.coordinate == b.coordinate && a.trial == b.trial &&
           a.posture == b.posture && a.end == b.end && a.by_axis == b.by_axis &&
           (a.axis == b.axis || a.kind == FaultKind::kJointOffset);
  }

  static double Sum(const RecordingFault& fault, double more) {
    const bool factor = fault.kind == FaultKind::kJointGain ||
                        fault.kind == FaultKind::kCameraScale ||
                        fault.kind == FaultKind::kCameraAxis;
    return factor ? (1.0 + fault.size) * (1.0 + more) - 1.0 : fault.size + more;
  }

  void Add(const RecordingFault& found) {
    for (RecordingFault& one : faults_) {
      if (!IsSame(one, found)) continue;
      if (one.kind == FaultKind::kFrameShift) {
        AddShift(found, one);
      } else {
        one.size = Sum(one, found.size);
      }
      one.sd = found.sd;
      return;
    }
    faults_.push_back(found);
  }

  /// Faults found in a recording. For motors of rods, only the first fault can be corrected.
  std::vector<RecordingFault> FaultsIn(const Recording& recording, bool with_drift) {
    const CalibrationResult fit = Fit(recording);
    left_ = MarkerError(fit, recording, general_.options);
    std::vector<RecordingFault> found = FindRecordingFaults(fit, recording, general_.options);
    std::erase_if(found, [&](const RecordingFault& one) {
      return one.linkage >= 0 || (one.kind == FaultKind::kJointDrift && !with_drift);
    });
    return found;
  }

  void Collect(RecordingFault next, bool with_drift) {
    faults_.clear();
    complete_ = false;
    Recording current = general_.recording;
    for (int fits = 0; fits < kMostFits; ++fits) {
      const bool gain = next.kind == FaultKind::kJointGain;
      if (gain) next.size = std::clamp(next.size, -kLargestStep, kLargestStep);
      Add(next);
      if (next.linkage >= 0) complete_ = true;
      if (complete_ || faults_.size() > kMostTogether) return;
      current = WithoutFault(current, next);
      std::vector<RecordingFault> found;
      try {
        found = FaultsIn(current, with_drift);
      } catch (const InputError&) {
        return;
      }
      if (found.empty()) {
        complete_ = left_ < MostLeft(project_.tree);
        return;
      }
      next = found.front();
    }
  }

  bool Drifts() const {
    return std::any_of(faults_.begin(), faults_.end(), [](const RecordingFault& one) {
      return one.kind == FaultKind::kJointDrift;
    });
  }

  /// Tries without a drift: several slips in one direction look like a drift with other faults.
  void TryWithoutDrift() {
    const std::vector<RecordingFault> found = FaultsIn(general_.recording, false);
    if (found.empty()) return;
    const std::vector<RecordingFault> with_drift = faults_;
    const bool complete = complete_;
    Collect(found.front(), false);
    if (complete_ && (!complete || faults_.size() <= with_drift.size())) return;
    faults_ = with_drift;
    complete_ = complete;
  }

  Recording Undone() const {
    Recording recording = general_.recording;
    for (const RecordingFault& one : faults_) recording = WithoutFault(recording, one);
    return recording;
  }

  /// Estimates all faults together; what seemed a fault while others were unknown may be none.
  void EstimateTogether() {
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (RecordingFault& one : faults_) {
        const Recording undone = Undone();
        const RecordingFault left = MeasureFault(one, Fit(undone), undone, general_.options);
        one.size = Sum(one, left.size);
        one.sd = left.sd;
      }
    }
    std::erase_if(faults_, [&](const RecordingFault& one) {
      return faults_.size() > 1 && std::abs(one.size) < kFewestSds * one.sd;
    });
    complete_ = std::abs(faults_.front().size) >= kFewestSds * faults_.front().sd;
  }

  /// A cluster that is displaced on its link from where the first fault begins, if that leaves less
  /// than `times` the error that the faults leave; else empty.
  std::string MovedCluster(double times) const {
    const RecordingFault& first = general_.fault;
    const bool displaces = first.kind == FaultKind::kFrameShift ||
                           (first.kind == FaultKind::kJointOffset && first.linkage < 0);
    if (!displaces || (first.posture == 0 && first.trial < 0)) return "";
    const Recording undone = Undone();
    double least = times * MarkerError(Fit(undone), undone, general_.options);
    std::string found;
    int found_at = 0;
    SplitRecording best;
    for (const auto& [begin, end] : Stretches(first.kind)) {
      for (const LabelCluster& cluster : MovableClusters(first.kind, begin, end)) {
        SplitRecording split = SplitWithin(cluster, begin, end);
        const CalibrationResult fit = Fit(split);
        const double left = MarkerError(fit, split.recording, general_.options);
        if (!(left < least)) continue;
        least = left;
        found = cluster.name;
        found_at = begin;
        best = std::move(split);
      }
    }
    if (found.empty()) return "";
    // Another robot displaces other clusters as well.
    const CalibrationResult fit = Fit(best);
    if (!FindRecordingFaults(fit, best.recording, general_.options).empty()) return "";
    return fmt::format(
        "cluster {}: its markers seem to be elsewhere on their link from {} on (knocked, or glued "
        "on again?). Calibrate the postures before and after apart",
        found, DescribePosture(general_.recording, found_at));
  }

  /// Splits the markers of a cluster into those within the postures and those outside.
  SplitRecording SplitWithin(const LabelCluster& cluster, int begin, int end) const {
    SplitRecording split{general_.model, general_.recording};
    std::vector<Knock> knocks;
    for (const int posture : {begin, end}) {
      if (posture > 0 && posture < general_.recording.posture_count()) {
        knocks.push_back({.cluster = cluster.name, .markers = cluster.markers, .posture = posture});
      }
    }
    SplitMarkers(knocks, split.model, split.recording);
    return split;
  }

  std::set<std::pair<int, int>> Stretches(FaultKind kind) const {
    std::set<std::pair<int, int>> stretches;
    for (const RecordingFault& one : faults_) {
      if (one.kind == kind) stretches.insert(StretchOf(one));
    }
    return stretches;
  }

  /// Clusters whose markers are seen within these postures and outside, and whose displacement may
  /// look like faults of that kind.
  std::vector<LabelCluster> MovableClusters(FaultKind kind, int from, int to) const {
    std::vector<LabelCluster> clusters = SeenClusters(project_, general_.recording);
    const int count = general_.recording.posture_count();
    for (LabelCluster& cluster : clusters) {
      std::erase_if(cluster.markers, [&](int m) { return !SeenWithin(m, from, to); });
    }
    std::erase_if(clusters, [](const LabelCluster& one) { return one.markers.empty(); });
    if (kind == FaultKind::kJointOffset) {
      std::vector<int> coordinates;
      for (const RecordingFault& one : faults_) {
        if (one.kind == kind) coordinates.push_back(one.coordinate);
      }
      clusters = ClustersBeside(coordinates, clusters, general_.model);
    }
    for (LabelCluster& cluster : clusters) {
      std::erase_if(cluster.markers,
                    [&](int m) { return !SeenWithin(m, 0, from) && !SeenWithin(m, to, count); });
    }
    std::erase_if(clusters, [](const LabelCluster& one) { return one.markers.empty(); });
    return clusters;
  }

  /// The postures in which a cluster may be displaced instead of a joint; in a trial, all.
  std::pair<int, int> StretchOf(const RecordingFault& fault) const {
    const Recording& recording = general_.recording;
    const int count = recording.posture_count();
    if (fault.trial < 0) return {fault.posture, fault.end > 0 ? fault.end : count};
    const auto first = std::find(recording.trial.begin(), recording.trial.end(), fault.trial);
    const auto begin = static_cast<int>(first - recording.trial.begin());
    return {begin, begin + static_cast<int>(std::count(first, recording.trial.end(), fault.trial))};
  }

  bool SeenWithin(int marker, int begin, int end) const {
    for (int i = begin; i < end; ++i) {
      if (Seen(general_.recording, i, marker)) return true;
    }
    return false;
  }

  /// Offsets of joints that begin at the same posture as this one, itself included.
  std::vector<RecordingFault> BeginWith(const RecordingFault& first) const {
    std::vector<RecordingFault> there;
    if (first.kind != FaultKind::kJointOffset) return there;
    for (const RecordingFault& one : faults_) {
      const bool same = one.kind == first.kind && one.trial == first.trial &&
                        std::abs(one.posture - first.posture) <= kSamePlace;
      const bool known = std::any_of(there.begin(), there.end(), [&](const RecordingFault& other) {
        return other.coordinate == one.coordinate;
      });
      if (same && !known) there.push_back(one);
    }
    return there;
  }

  /// Joints that are off from the same posture on, or in the same trial; else empty.
  std::string SeveralJoints() const {
    std::vector<RecordingFault> joints;
    const RecordingFault* first = nullptr;
    for (const RecordingFault& one : faults_) {
      std::vector<RecordingFault> there = BeginWith(one);
      if (there.size() <= joints.size()) continue;
      joints = std::move(there);
      first = &one;
    }
    if (joints.size() < kSeveral) return "";
    std::vector<std::string> sizes;
    for (const RecordingFault& one : joints) {
      const LoggedPosition logged = LoggedPositionOf(project_.tree, one.linkage, one.coordinate);
      sizes.push_back(fmt::format("{} by {:.2f} {}", logged.name,
                                  one.size * (logged.slides ? 1e3 : 180.0 / M_PI),
                                  logged.slides ? "mm" : "deg"));
    }
    const bool of_trial = first->trial >= 0 && !IsInPartOfTrial(*first, general_.recording);
    return fmt::format(
        "positions of several joints are off {} ({}): another robot, or joints that were homed "
        "anew? Calibrate what was recorded before and after apart{}",
        of_trial ? "in trial " + general_.recording.trials[Size(first->trial)].name
                 : "from " + DescribePosture(general_.recording, first->posture) + " on",
        fmt::join(sizes, ", "), IfHomed(joints));
  }

  /// The correction, if these joints are all that was found.
  std::string IfHomed(const std::vector<RecordingFault>& joints) const {
    if (!complete_ || joints.size() < faults_.size() || joints.size() > kFewHomed) return "";
    std::string names;
    for (const RecordingFault& one : joints) {
      const auto name = NameOfCorrection(one, project_.tree, general_.recording);
      if (!name) return "";
      names += " " + *name;
    }
    return " (if they were homed anew, --accept" + names + " corrects them)";
  }

  const GeneralFault& general_;
  const Project& project_;
  std::vector<RecordingFault> faults_;
  bool complete_ = false;  ///< nothing is found beside the faults, and they explain the recording
  bool placed_ = false;    ///< held-out trials tell of PlacedOffset
  bool refuted_ = false;   ///< PlacedOffset::refuted
  double left_ = 0.0;      ///< error of the last fit, m
};

}  // namespace

FaultsInWords ExplainFault(const GeneralFault& general, const Project& project) {
  const FaultExplanation explanation(general, project);
  return {explanation.Describe(), explanation.complete(), explanation.left(), explanation.faults(),
          explanation.placed()};
}

}  // namespace elastocal
