// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/transfer_faults.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "elastocal/calibration/prediction.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/thinned_motions.hpp"
#include "elastocal/mistakes/check_alternatives.hpp"
#include "elastocal/mistakes/general_fault.hpp"
#include "elastocal/mistakes/held_out_contrast.hpp"
#include "elastocal/mistakes/moved_between.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/robot/linkage.hpp"
#include "elastocal/screening/measured_faults.hpp"

namespace elastocal {
namespace {

constexpr double kLeftOfRatio = 0.5;   // share of the largest ratio
constexpr int kMomentsToSearch = 120;  // moments of motions
constexpr double kAsMuch = 1.1;        // ratio to the error that an offset in one trial leaves
constexpr const char* kContradiction = "calibration and recording contradict each other: ";

/// Error of a cluster in a trial, or in a table.
struct ClusterError {
  std::size_t cluster = 0;
  int trial = 0;
  double ratio = 0.0;  ///< ratio of the rms distance of its markers to the expected one
};

/// The search of FindTransferFaults.
class TransferSearch {
 public:
  explicit TransferSearch(const TransferredCalibration& of)
      : of_(of), clusters_(SeenClusters(of.project, of.recording)) {}

  std::vector<std::string> Run() {
    uncalibrated_ = SquaresOf(of_.transfer.uncalibrated.result, of_.recording);
    errors_ = Errors(of_.transfer.calibrated.result, of_.recording);
    if (!(Largest(errors_) > kSuspicious)) return {};
    const Recording thinned = WithThinnedMotions(of_.recording, kMomentsToSearch);
    if (thinned.posture_count() == of_.recording.posture_count()) return Found();
    const TransferValidation transfer =
        ValidateTransfer(of_.robot.model, thinned, of_.robot.base, options(), of_.joint_errors);
    TransferSearch of_few({.project = of_.project,
                           .robot = of_.robot,
                           .as_recorded = of_.as_recorded,
                           .recording = thinned,
                           .transfer = transfer,
                           .joint_errors = of_.joint_errors,
                           .expected = of_.expected,
                           .holds = of_.holds});
    of_few.uncalibrated_ = of_few.SquaresOf(transfer.uncalibrated.result, thinned);
    of_few.errors_ = of_few.Errors(transfer.calibrated.result, thinned);
    return of_few.Found();
  }

 private:
  std::vector<std::string> Found() const {
    std::vector<std::string> found = FindAlternatives(
        {.refit = [&](const Recording& one) { return Refitted(one); }, .holds = of_.holds},
        of_.recording, of_.as_recorded, of_.project);
    for (std::string& one : found) one = kContradiction + one;
    if (found.empty()) found = OfJoints();
    if (found.empty()) found = OfClusters();
    return found;
  }

  const CalibrationOptions& options() const { return of_.project.calibration; }
  const CalibrationResult& fit() const { return of_.transfer.calibrated.result; }

  CalibrationResult Fit(const ErrorModel& model, const BaseParameters& base,
                        const Recording& recording) const {
    return RefitExternals(model, recording, base, options(), of_.joint_errors);
  }
  Refit Refitted(const Recording& recording) const {
    return RefitTo(of_.robot.model, recording, of_.robot.base, options(), of_.joint_errors);
  }

  Eigen::ArrayXXd SquaresOf(const CalibrationResult& result, const Recording& recording) const {
    return Predict(result.model, result.delta, recording, options()).distances.array().square();
  }

  /// Root mean square distance of a cluster's markers in a trial; 0 where it is not seen.
  double RmsOf(const Eigen::ArrayXXd& squares, const LabelCluster& cluster, int trial) const {
    double sum = 0.0, count = 0.0;
    for (Eigen::Index i = 0; i < squares.rows(); ++i) {
      if (!of_.recording.trials.empty() && of_.recording.trial[i] != trial) continue;
      for (const int m : cluster.markers) {
        if (!std::isfinite(squares(i, m))) continue;
        sum += squares(i, m);
        ++count;
      }
    }
    return count > 0.0 ? std::sqrt(sum / count) : 0.0;
  }

  std::vector<ClusterError> Errors(const CalibrationResult& result,
                                   const Recording& recording) const {
    const Eigen::ArrayXXd squares = SquaresOf(result, recording);
    const int trials = std::max(1, static_cast<int>(recording.trials.size()));
    std::vector<ClusterError> errors;
    for (std::size_t k = 0; k < clusters_.size(); ++k) {
      for (int trial = 0; trial < trials; ++trial) {
        const double expected =
            std::max(of_.expected, kBestExpected * RmsOf(uncalibrated_, clusters_[k], trial));
        if (!(expected > 0.0)) continue;
        errors.push_back({k, trial, RmsOf(squares, clusters_[k], trial) / expected});
      }
    }
    return errors;
  }

  static double Largest(const std::vector<ClusterError>& errors) {
    double largest = 0.0;
    for (const ClusterError& one : errors) largest = std::max(largest, one.ratio);
    return largest;
  }

  /// Finds offsets of joints in all postures. FindRecordingFaults takes such an offset for an error
  /// of the robot, but here the robot's errors are known.
  std::vector<RecordingFault> OffsetsInAll() const {
    std::vector<RecordingFault> sought;
    const RobotTree& tree = of_.robot.model.tree;
    for (const int k : of_.robot.model.active_joints) {
      const Joint& joint = tree.joints[Size(k)];
      if (joint.mimic || IsMovedByRods(tree, k)) continue;
      sought.push_back({.kind = FaultKind::kJointOffset, .coordinate = joint.coordinate});
    }
    std::vector<RecordingFault> offsets = MeasureFaults(sought, fit(), of_.recording, options());
    std::erase_if(offsets, [&](const RecordingFault& one) {
      const bool slides = JointOfCoordinate(tree, one.coordinate).type == JointType::kPrismatic;
      const double size = std::abs(one.size);
      return !(size > LeastSize(one.kind, slides)) || !(size < LargestSize(one.kind, slides)) ||
             !IsCertain(one);
    });
    return offsets;
  }

  /// Whether correcting these faults halves the contradiction to the calibration.
  bool Explain(const std::vector<RecordingFault>& faults) const {
    Recording without = of_.recording;
    for (const RecordingFault& one : faults) without = WithoutFault(without, one);
    return Largest(Errors(Refitted(without).result, without)) < kLeftOfRatio * Largest(errors_);
  }

  double LeftWithout(const RecordingFault& fault) const {
    return Refitted(WithoutFault(of_.recording, fault)).metrics_all.rmse_3d;
  }

  std::vector<std::string> OfJoints() const {
    std::vector<RecordingFault> faults = FindRecordingFaults(fit(), of_.recording, options());
    std::ranges::move(OffsetsInAll(), std::back_inserter(faults));
    std::erase_if(faults, [&](const RecordingFault& one) {
      return one.linkage >= 0 || MayBeInertia(one, of_.recording);
    });
    std::stable_sort(faults.begin(), faults.end(),
                     [](const auto& a, const auto& b) { return a.share > b.share; });
    if (faults.empty()) return {};
    GeneralFault general{faults.front(), of_.robot.model, of_.robot.base,
                         of_.recording,  fit().kind,      options()};
    general.fit = [this](const ErrorModel& model, const BaseParameters& base,
                         const Recording& recording) { return Fit(model, base, recording); };
    const FaultsInWords words = ExplainFault(general, of_.project);
    if (!words.complete || !Explain(words.faults)) return {};
    return {kContradiction + words.text + OrMovedSince(words.faults)};
  }

  /// Adds that a joint which only these postures show may have moved since the calibration.
  std::string OrMovedSince(const std::vector<RecordingFault>& faults) const {
    std::vector<std::string> joints;
    for (const RecordingFault& one : faults) {
      if (one.kind != FaultKind::kJointOffset) continue;
      RecordingFault in_all = one;
      in_all.trial = -1;
      in_all.posture = in_all.end = 0;
      const bool all = one.trial < 0 && one.posture == 0 && one.end == 0;
      if (!all && LeftWithout(in_all) > kAsMuch * LeftWithout(one)) continue;
      const RobotTree& tree = of_.robot.model.tree;
      joints.push_back(JointOfCoordinate(tree, one.coordinate).name);
    }
    if (joints.empty()) return "";
    return fmt::format(
        "; {} may as well have moved since the calibration, or have been homed anew: no trial "
        "shows the calibrated position",
        fmt::join(joints, ", "));
  }

  /// The trials in which a cluster is off, the worst first. If these are all that show it, only the
  /// worst one, because the refit puts its markers between the positions.
  std::vector<ClusterError> SuspectedTrials(std::size_t cluster) const {
    std::vector<ClusterError> trials;
    for (const ClusterError& one : errors_) {
      if (one.cluster == cluster && one.ratio > 0.0) trials.push_back(one);
    }
    std::ranges::stable_sort(trials, std::greater(), &ClusterError::ratio);
    const auto calm = std::ranges::find_if(
        trials, [](const ClusterError& one) { return !(one.ratio > kSuspicious); });
    const bool all = calm == trials.end() && trials.size() > 1;
    trials.erase(all ? trials.begin() + 1 : calm, trials.end());
    return trials;
  }

  std::vector<std::string> OfClusters() const {
    if (of_.recording.trials.empty()) return {};
    std::vector<std::pair<double, MovedSuspect>> suspects;
    for (std::size_t k = 0; k < clusters_.size(); ++k) {
      const std::vector<ClusterError> trials = SuspectedTrials(k);
      if (trials.empty()) continue;
      MovedSuspect suspect{clusters_[k], std::vector<char>(Size(of_.recording.posture_count()), 0)};
      for (int i = 0; i < of_.recording.posture_count(); ++i) {
        suspect.there[Size(i)] = std::ranges::any_of(
            trials, [&](const ClusterError& one) { return one.trial == of_.recording.trial[i]; });
      }
      suspects.emplace_back(trials.front().ratio, std::move(suspect));
    }
    std::stable_sort(suspects.begin(), suspects.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<MovedSuspect> sorted;
    for (auto& [ratio, suspect] : suspects) sorted.push_back(std::move(suspect));
    const std::string moved = FindMovedBetween(
        of_.project, fit(), of_.recording, options(), sorted,
        [this](const ErrorModel& model, const BaseParameters& base, const Recording& recording) {
          return Fit(model, base, recording);
        });
    if (moved.empty()) return {};
    return {kContradiction + moved};
  }

  TransferredCalibration of_;
  std::vector<LabelCluster> clusters_;
  Eigen::ArrayXXd uncalibrated_;  ///< squared distances, m^2
  std::vector<ClusterError> errors_;
};

}  // namespace

std::vector<std::string> FindTransferFaults(const TransferredCalibration& calibration) {
  try {
    return TransferSearch(calibration).Run();
  } catch (const InputError&) {  // too few postures for any of the fits
    return {};
  }
}

}  // namespace elastocal
