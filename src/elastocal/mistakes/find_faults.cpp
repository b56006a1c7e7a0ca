// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/find_faults.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/general_fault.hpp"
#include "elastocal/mistakes/impossible_gears.hpp"
#include "elastocal/mistakes/missed_springs.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/mistakes/recordings_apart.hpp"
#include "elastocal/mistakes/spoiling_cluster.hpp"
#include "elastocal/mistakes/stated_corrections.hpp"
#include "elastocal/mistakes/trial_offset.hpp"
#include "elastocal/mistakes/tried_correction.hpp"
#include "elastocal/mistakes/unrecorded_motion.hpp"
#include "elastocal/mistakes/up_by_loads.hpp"
#include "elastocal/screening/camera_scale.hpp"
#include "elastocal/screening/carrying_link.hpp"
#include "elastocal/screening/coarse_positions.hpp"
#include "elastocal/screening/odd_postures.hpp"
#include "elastocal/screening/recording_faults.hpp"
#include "elastocal/screening/up_by_torques.hpp"
#include "elastocal/screening/up_check.hpp"

namespace elastocal {
namespace {

constexpr double kLeftByOdd = 0.5;        // of the error of a fit, without them
constexpr double kLeftBesideGears = 0.8;  // of the error of a fit with wrong gains as gears

struct FoundFault : GeneralFault {
  bool of_one_trial = false;  ///< FindTrialOffset: which trial is wrong, others do not tell
};

/// What looks like knocks of several clusters may be a fault that moves them all, so it is looked
/// for without the knocks, too.
std::optional<FoundFault> FindGeneralFault(const Project& project,
                                           std::optional<std::uint64_t> seed,
                                           Measurements as_recorded, const RecordedModel& robot,
                                           const Recording& recording,
                                           const CalibrationResult& result) {
  const CalibrationOptions& options = project.calibration;
  GeneralFault general{{},      robot.model,           robot.base, recording, result.kind,
                       options, as_recorded.validation};
  std::vector<RecordingFault> faults = FindRecordingFaults(result, recording, options);
  std::optional<RecordingFault> hidden;
  if (robot.knocks.empty()) {
    if (faults.empty()) {
      hidden = FindTrialOffset(result, robot.base, recording, options, general.held_out);
    }
  } else {
    RecordedModel plain = MakeRecordedModel(project, seed, as_recorded, KnockSearch::kNone);
    const CalibrationResult without =
        Calibrate(plain.model, as_recorded.calibration, plain.base, result.kind, options);
    std::vector<RecordingFault> found =
        FindRecordingFaults(without, as_recorded.calibration, options);
    if (found.empty() && faults.empty()) {
      hidden =
          FindTrialOffset(without, plain.base, as_recorded.calibration, options, general.held_out);
    }
    if (!found.empty() || hidden) {
      faults = std::move(found);
      general.model = std::move(plain.model);
      general.base = std::move(plain.base);
      general.recording = std::move(as_recorded.calibration);
    }
  }
  if (hidden) faults = {*hidden};
  if (faults.empty()) return std::nullopt;
  general.fault = faults.front();
  return FoundFault{general, hidden.has_value()};
}

bool IsFarOff(const std::vector<RecordingFault>& gears) {
  constexpr double kFarOffGear = 0.1;  // beyond it, a linear estimate is none
  return std::any_of(gears.begin(), gears.end(),
                     [](const RecordingFault& gear) { return std::abs(gear.size) > kFarOffGear; });
}

/// The general fault of a robot without the causes that it seemed to have.
std::optional<FoundFault> FindWithoutCauses(Project project, std::optional<std::uint64_t> seed,
                                            const Measurements& as_recorded, ModelKind kind) {
  project.elasticity.extra.clear();
  Measurements plain = as_recorded;
  const RecordedModel robot = MakeRecordedModel(project, seed, plain, KnockSearch::kNone);
  const CalibrationResult fit =
      Calibrate(robot.model, plain.calibration, robot.base, kind, project.calibration);
  return FindGeneralFault(project, seed, as_recorded, robot, plain.calibration, fit);
}

/// What undoes a wrong scale: `scale=1.00200` in all trials, else `scale:TRIAL=1.00200` in each.
std::string ScaleCorrections(const std::vector<const TrialSummary*>& wrong, bool all) {
  constexpr double kAlike = 5e-4;
  double least = wrong.front()->scale->size, most = least, sum = 0.0;
  std::string each;
  for (const TrialSummary* trial : wrong) {
    least = std::min(least, trial->scale->size);
    most = std::max(most, trial->scale->size);
    sum += trial->scale->size;
    each += fmt::format(" scale:{}={:.5f}", trial->trial.name, 1.0 + trial->scale->size);
  }
  if (!all || most - least > kAlike) return each;
  return fmt::format(" scale={:.5f}", 1.0 + sum / static_cast<double>(wrong.size()));
}

/// The trials whose scale the reference lengths contradict, in a sentence; empty without any.
std::string DescribeWrongScales(const std::vector<TrialSummary>& trials) {
  std::vector<const TrialSummary*> wrong;
  bool all = true;
  std::string names;
  for (const TrialSummary& trial : trials) {
    if (!trial.refused.empty()) continue;
    if (trial.scale && IsWrong(*trial.scale)) {
      wrong.push_back(&trial);
      names += (names.empty() ? "" : ", ") + trial.trial.name;
    } else {
      all = false;
    }
  }
  if (wrong.empty()) return "";
  return fmt::format(
      "the cameras' scale is wrong: by the reference lengths, positions are {} times the true ones "
      "in {} (--accept{} corrects it)",
      Describe(*wrong.front()->scale), all ? "all trials" : "trial " + names,
      ScaleCorrections(wrong, all));
}

/// Mistakes in a few rows of a table which are too small beside what the nominal robot errs by,
/// each with what corrects none of them: proved by a fit without them.
std::vector<std::string> OddBesideCalibrated(const Project& project, const RecordedModel& robot,
                                             const Recording& recording,
                                             const CalibrationResult& result, double left) {
  const std::vector<OddPostures> odd =
      FindOddPostures(result.model, recording, SeenClusters(project, recording), &result.delta);
  if (odd.empty()) return {};
  const double after = MarkerError(
      Calibrate(robot.model, odd.back().corrected, robot.base, result.kind, project.calibration),
      odd.back().corrected, project.calibration);
  if (!(after < kLeftByOdd * left)) return {};
  std::vector<std::string> said;
  for (const OddPostures& one : odd) {
    said.push_back(
        fmt::format("{}; without that the error of the fit falls from {:.3g} to {:.3g} mm",
                    one.what, 1e3 * left, 1e3 * after));
  }
  return said;
}

/// Whether a fault is of one trial, or begins with one: trials of another robot look so.
bool IsOfTrials(const RecordingFault& fault, const Recording& recording) {
  constexpr int kBeside = 2;  // postures
  if (recording.trials.empty()) return false;
  if (fault.trial >= 0) return true;
  if (fault.posture <= kBeside) return false;  // it is of all
  const int last = recording.posture_count() - 1;
  return recording.trial[Size(std::min(last, fault.posture - kBeside))] !=
         recording.trial[Size(std::min(last, fault.posture + kBeside))];
}

/// The steps of FindFaults, the plainest faults first: what one leaves looks like the next.
class FaultsInTurn {
 public:
  FaultsInTurn(const Project& project, std::optional<std::uint64_t> seed,
               const Measurements& as_recorded, const RecordedModel& robot,
               const Recording& recording, const ModelComparison& comparison)
      : project_(project),
        seed_(seed),
        as_recorded_(as_recorded),
        robot_(robot),
        recording_(recording),
        comparison_(comparison),
        gears_(FindImpossibleGears(comparison.largest())),
        of_slides_(ScaleOfSlides(gears_, comparison.largest(), project.calibration)),
        // Where the cameras are right, a robot whose lengths are all off is of another size.
        scale_is_known_(ScaleIsKnown(as_recorded.trials)) {}

  std::vector<std::string> Run() {
    std::vector<std::string> faults = OfWholeRecording();
    if (!faults.empty()) return faults;
    left_ = MarkerError(comparison_.largest(), recording_, project_.calibration);
    faults = OfWhatIsLeft();
    if (faults.empty()) return faults;
    const double otherwise =
        few_ && few_->complete ? few_->left : std::numeric_limits<double>::infinity();
    const std::string springs = FindMissedSprings(project_, seed_, as_recorded_, left_, otherwise);
    return springs.empty() ? faults : std::vector<std::string>{springs};
  }

 private:
  std::vector<std::string> OfWhatIsLeft() {
    std::vector<std::string> faults = OfUpByLoads();
    if (!faults.empty()) return faults;
    if (!of_slides_.empty() && !scale_is_known_) return {of_slides_};
    faults = OfCoarsePositions();
    if (!faults.empty()) return faults;
    Look();
    if (!few_->complete && LeavesMoreThanCameras(fit(), left_)) {
      const std::string motion = FindUnrecordedMotion(project_, robot_, recording_, fit());
      if (!motion.empty()) return {motion};
    }
    const std::string apart = OfRecordingsApart();
    if (!apart.empty()) return {apart};
    if (!gears_.empty()) return OfGears();
    return found_ ? OfGeneralFault() : OfFewRowsOrMarkers();
  }

  const CalibrationResult& fit() const { return comparison_.largest(); }

  std::optional<FoundFault> General() const {
    return FindGeneralFault(project_, seed_, as_recorded_, robot_, recording_, fit());
  }

  /// The direction of gravity, the scale of the cameras, mistakes, and clusters on other links.
  std::vector<std::string> OfWholeRecording() const {
    std::vector<std::string> faults;
    if (const auto up = FindWrongUp(robot_.model, recording_)) faults.push_back(Describe(*up));
    const Recording& measured = as_recorded_.calibration;  // with sensors that contradict statics
    if (const auto up = FindUpByTorques(NominalModel(project_, measured), measured,
                                        project_.calibration.slip)) {
      faults.push_back(Describe(*up));
    }
    const std::string wrong_scales = DescribeWrongScales(as_recorded_.trials);
    if (!wrong_scales.empty()) faults.push_back(wrong_scales);
    for (const RecordingMistake& mistake :
         FindRecordingMistakes(project_, seed_, as_recorded_, recording_, fit())) {
      faults.push_back(DescribeMistake(mistake));
    }
    if (faults.empty()) {
      const auto carried =
          FindCarryingLink(robot_.model, recording_, SeenClusters(project_, recording_));
      if (carried) return {Describe(*carried)};
    }
    if (!wrong_scales.empty() || scale_is_known_) return faults;
    if (const auto scale = FindWrongScale(fit(), project_.calibration)) {
      // The scale of one trial, or axis, is spread over the lengths that it tells.
      const auto found = General();
      const bool of_cameras =
          found && (found->fault.kind == FaultKind::kCameraScale || IsInCameraSpace(found->fault));
      faults.push_back(of_cameras           ? ExplainFault(*found, project_).text
                       : of_slides_.empty() ? Describe(*scale)
                                            : of_slides_);
    }
    return faults;
  }

  /// Faults of joints and others that move several clusters; looked for once.
  void Look() {
    if (few_) return;
    // Causes take up a part of what a fault of a joint does.
    found_ =
        gears_.empty() ? General() : FindWithoutCauses(project_, seed_, as_recorded_, fit().kind);
    few_ = found_ ? ExplainFault(*found_, project_) : FaultsInWords();
  }

  /// What looks like another robot may be one joint that is off in the trial in which it stands: it
  /// displaces all that the trial shows. Whether such a joint explains as much as robots of their
  /// own do, which leave this error, m.
  bool IsOneJoint(double apart) {
    const auto offset = FindTrialOffset(fit(), robot_.base, recording_, project_.calibration,
                                        as_recorded_.validation, OffsetTrials::kAny);
    if (!offset) return false;
    const FoundFault one{{*offset, robot_.model, robot_.base, recording_, fit().kind,
                          project_.calibration, as_recorded_.validation},
                         true};
    FaultsInWords words = ExplainFault(one, project_);
    if (!words.complete || AreApart(apart, words.left)) return false;
    found_ = one;
    few_ = std::move(words);
    return true;
  }

  /// A joint that is off in one trial explains much of a trial of another robot, too: there, robots
  /// of their own leave far less than that.
  std::string OfRecordingsApart() {
    const bool of_trials = std::ranges::any_of(
        few_->faults, [&](const RecordingFault& fault) { return IsOfTrials(fault, recording_); });
    if (few_->complete && !of_trials) return "";
    const double left = few_->complete ? std::min(left_, few_->left) : left_;
    if (!LeavesMoreThanCameras(fit(), left)) return "";
    const auto apart = FindRecordingsApart(project_, robot_, recording_, fit(), left);
    if (!apart || (!few_->complete && IsOneJoint(apart->error))) return "";
    return apart->said;
  }

  /// Faults of joints load them as another direction of gravity might.
  std::vector<std::string> OfUpByLoads() {
    const auto up = FindUpByLoads(project_, seed_, as_recorded_, left_);
    if (!up) return {};
    Look();
    if (few_->complete && few_->left <= up->found) return {};
    return {Describe(*up, recording_)};
  }

  std::vector<std::string> OfCoarsePositions() const {
    std::vector<std::string> faults;
    for (const CoarsePositions& one :
         FindCoarsePositions(fit(), recording_, project_.calibration, as_recorded_.trials)) {
      if (IsTooCoarse(one, project_.tree)) faults.push_back(Describe(one, project_.tree));
    }
    return faults;
  }

  std::vector<std::string> OfGears() const {
    const bool better = few_->complete && few_->left < kLeftBesideGears * left_;
    if (found_ && (better || IsFarOff(gears_))) return {few_->text};
    std::vector<std::string> faults;
    for (const RecordingFault& gear : gears_) {
      faults.push_back(FaultAndRemedy(gear, project_.tree, recording_));
    }
    return faults;
  }

  std::vector<std::string> OfGeneralFault() const {
    const std::string of_slide =
        scale_is_known_ ? "" : ScaleOfSlides({found_->fault}, fit(), project_.calibration);
    if (!of_slide.empty()) return {of_slide};
    if (!few_->complete) {
      const auto odd = OddBesideCalibrated(project_, robot_, recording_, fit(), left_);
      if (!odd.empty()) return odd;
      const auto loose = FindSpoilingCluster(project_, robot_, recording_, fit());
      if (!loose.empty()) return loose;
    }
    if (!found_->of_one_trial || !few_->complete || few_->placed) return {few_->text};
    return {few_->text +
            "; it may as well be off by the opposite in all other trials that show it"};
  }

  std::vector<std::string> OfFewRowsOrMarkers() const {
    std::vector<std::string> faults =
        OddBesideCalibrated(project_, robot_, recording_, fit(), left_);
    if (!faults.empty()) return faults;
    const auto scattered = FindScatteredPositions(fit(), recording_, project_.calibration);
    if (!scattered) return FindSpoilingCluster(project_, robot_, recording_, fit());
    if (!IsTooLoose(*scattered, project_.tree)) return {};
    return {Describe(*scattered, project_.tree)};
  }

  const Project& project_;
  std::optional<std::uint64_t> seed_;
  const Measurements& as_recorded_;
  const RecordedModel& robot_;
  const Recording& recording_;
  const ModelComparison& comparison_;
  std::vector<RecordingFault> gears_;
  std::string of_slides_;
  bool scale_is_known_;
  double left_ = 0.0;  ///< error of the markers, m
  std::optional<FoundFault> found_;
  std::optional<FaultsInWords> few_;
};

}  // namespace

bool ScaleIsKnown(const std::vector<TrialSummary>& trials) {
  return !trials.empty() &&
         std::all_of(trials.begin(), trials.end(), [](const TrialSummary& trial) {
           return !trial.refused.empty() || (trial.scale && !IsWrong(*trial.scale));
         });
}

std::vector<std::string> FindFaults(const Project& project, std::optional<std::uint64_t> seed,
                                    const Measurements& as_recorded, const RecordedModel& robot,
                                    const Recording& recording, const ModelComparison& comparison) {
  return FaultsInTurn(project, seed, as_recorded, robot, recording, comparison).Run();
}

}  // namespace elastocal
