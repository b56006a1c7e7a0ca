// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/find_faults.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/fault_or_causes.hpp"
#include "elastocal/mistakes/find_contradictions.hpp"
#include "elastocal/mistakes/general_fault.hpp"
#include "elastocal/mistakes/impossible_gears.hpp"
#include "elastocal/mistakes/missed_springs.hpp"
#include "elastocal/mistakes/placed_offset.hpp"
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

constexpr double kAlikeScales = 5e-4;
constexpr double kLeftByOdd = 0.5;  // share of the error of a fit, without them
// Share of the error of a fit that has no faults, but for instance gears instead of wrong gains.
constexpr double kLeftBesideGears = 0.8;

bool IsFarOff(const std::vector<RecordingFault>& gears) {
  constexpr double kFarOffGear = 0.1;  // beyond this, a linear estimate is invalid
  return std::any_of(gears.begin(), gears.end(),
                     [](const RecordingFault& gear) { return std::abs(gear.size) > kFarOffGear; });
}

/// Whether one factor describes the scales of all trials.
bool AreAlike(const std::vector<const TrialSummary*>& wrong) {
  double least = wrong.front()->scale->size, most = least;
  for (const TrialSummary* trial : wrong) {
    least = std::min(least, trial->scale->size);
    most = std::max(most, trial->scale->size);
  }
  return most - least <= kAlikeScales;
}

/// Names that correct a wrong scale: `scale=1.00200` for all trials, else `scale:TRIAL=1.00200` for
/// each.
std::string ScaleCorrections(const std::vector<const TrialSummary*>& wrong, bool all) {
  double sum = 0.0;
  std::string each;
  for (const TrialSummary* trial : wrong) {
    sum += trial->scale->size;
    each += fmt::format(" scale:{}={:.5f}", trial->trial.name, 1.0 + trial->scale->size);
  }
  if (!all || !AreAlike(wrong)) return each;
  return fmt::format(" scale={:.5f}", 1.0 + sum / static_cast<double>(wrong.size()));
}

/// "1.00502 +- 0.00012 times the true ones in trial a, 0.99502 +- 0.00012 times in trial b".
std::string TimesInTrials(const std::vector<const TrialSummary*>& wrong, bool all) {
  const std::string first = Describe(*wrong.front()->scale) + " times the true ones in ";
  if (all && AreAlike(wrong)) return first + "all trials";
  std::string text = first + "trial " + wrong.front()->trial.name;
  for (std::size_t k = 1; k < wrong.size(); ++k) {
    text += ", ";
    if (!AreAlike(wrong)) text += Describe(*wrong[k]->scale) + " times in trial ";
    text += wrong[k]->trial.name;
  }
  return text;
}

/// A sentence about the trials whose scale the reference lengths contradict; empty without any.
std::string DescribeWrongScales(const std::vector<TrialSummary>& trials) {
  std::vector<const TrialSummary*> wrong;
  bool all = true;
  for (const TrialSummary& trial : trials) {
    if (!trial.refused.empty()) continue;
    if (trial.scale && IsWrong(*trial.scale)) {
      wrong.push_back(&trial);
    } else {
      all = false;
    }
  }
  if (wrong.empty()) return "";
  return fmt::format(
      "the cameras' scale is wrong: by the reference lengths, positions are {} (--accept{} "
      "corrects it)",
      TimesInTrials(wrong, all), ScaleCorrections(wrong, all));
}

/// Finds mistakes in a few rows of a table that are small compared with errors of the nominal
/// robot; each is proved by a fit without these rows, which does not correct them.
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

/// Whether a fault is that of one trial, or begins with one: trials of another robot look so.
bool IsOfTrials(const RecordingFault& fault, const Recording& recording) {
  constexpr int kBeside = 2;  // postures
  if (recording.trials.empty()) return false;
  if (fault.trial >= 0) return true;
  if (fault.posture <= kBeside) return false;  // then the fault is in all postures
  const int last = recording.posture_count() - 1;
  return recording.trial[Size(std::min(last, fault.posture - kBeside))] !=
         recording.trial[Size(std::min(last, fault.posture + kBeside))];
}

/// The steps of FindFaults, the plainest faults first, because the consequences of one look like
/// the next.
class FaultsInTurn {
 public:
  FaultsInTurn(const Project& project, std::optional<std::uint64_t> seed,
               const Measurements& as_recorded, const RecordedModel& robot,
               const Recording& recording, const ModelComparison& comparison, bool springs_by_data,
               const ChoiceByData& choose)
      : project_(project),
        seed_(seed),
        as_recorded_(as_recorded),
        robot_(robot),
        recording_(recording),
        comparison_(comparison),
        springs_by_data_(springs_by_data),
        choose_(choose),
        gears_(FindImpossibleGears(comparison.largest())),
        of_slides_(OfSlides(gears_)),
        // With a correct scale, a robot whose lengths are all off has another size.
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
    if (!of_slides_.empty() && !scale_is_known_) return {OfScale(of_slides_)};
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

  std::string OfSlides(const std::vector<RecordingFault>& faults) const {
    if (faults.empty()) return "";
    return ScaleOfSlides(faults, project_.tree, EstimateCommonScale(fit(), project_.calibration));
  }

  std::optional<FoundFault> General() const {
    return FindGeneralFault(project_, seed_, as_recorded_, robot_, recording_, fit());
  }

  /// Examines the direction of gravity, the scale of the cameras, mistakes, and clusters on other
  /// links.
  std::vector<std::string> OfWholeRecording() const {
    std::vector<std::string> faults;
    if (const auto up = FindWrongUp(robot_.model, recording_)) faults.push_back(Describe(*up));
    // With the sensors that contradict statics.
    const Recording& measured = as_recorded_.calibration;
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
      // The scale of one trial, or along one axis, is distributed over the lengths that it affects.
      const auto found = General();
      const bool of_cameras =
          found && (found->fault.kind == FaultKind::kCameraScale || IsInCameraSpace(found->fault));
      faults.push_back(of_cameras ? ExplainFault(*found, project_).text
                                  : OfScale(of_slides_.empty() ? Describe(*scale) : of_slides_));
    }
    return faults;
  }

  /// A wrong scale of the cameras, in words as one of all trials, as held-out trials have it.
  std::string OfScale(const std::string& of_all) const {
    return TellScaleOfTrials(project_, robot_, recording_, as_recorded_.validation, fit().kind,
                             of_all);
  }

  /// Finds faults of joints and others that displace several clusters; the search is made once.
  void Look() {
    if (few_) return;
    if (!gears_.empty() || MayHideFault(project_, springs_by_data_)) {
      Explain(FindWithoutCauses(project_, seed_, as_recorded_, springs_by_data_));
      if (!gears_.empty() || IsFaultInstead()) return;
    }
    Explain(General());
  }

  /// Whether few faults explain the recording instead of what the data have chosen: far better, or
  /// better than bending joints with fewer parameters, or as well as causes of no robot. Where the
  /// plain fit is compared, the faults have to explain it, not the springs beside them.
  bool IsFaultInstead() const {
    const bool like_play = std::ranges::any_of(few_->faults, [](const RecordingFault& fault) {
      return fault.kind == FaultKind::kUnfinished || fault.kind == FaultKind::kJointLag;
    });
    if (!few_->complete || like_play) return false;
    const ElasticityChoice& own = project_.elasticity;
    const bool bends =
        springs_by_data_ && own.bending && !own.bending->empty() && own.extra.empty();
    const bool explain = ExplainPlainFit(few_->left, found_->without_causes);
    if (explain && LeaveLess(few_->left, left_, bends)) return true;
    return ReplaceCauses(few_->faults, project_, seed_, as_recorded_, fit(), left_, choose_);
  }

  void Explain(std::optional<FoundFault> found) {
    found_ = std::move(found);
    few_ = found_ ? ExplainFault(*found_, project_) : FaultsInWords();
  }

  /// Whether one joint with an offset in one trial explains as much as separate robots do, whose
  /// error is `apart`, m. Such a joint displaces everything that the trial shows, and so looks like
  /// another robot.
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

  /// Finds recordings of different robots. A joint with an offset in one trial also explains much
  /// of a trial of another robot, but there separate robots leave far less.
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

  /// Finds a wrong direction of gravity. Faults of joints look similar, and are examined first.
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
    // Other causes share an impossible gear's gain with it, so that few faults are more exact.
    const bool better = few_->complete &&
                        (few_->left < kLeftBesideGears * left_ || AreGainsOf(few_->faults, gears_));
    if (found_ && (better || IsFarOff(gears_))) return {few_->text};
    std::vector<std::string> faults;
    for (const RecordingFault& gear : gears_) {
      faults.push_back(FaultAndRemedy(gear, project_.tree, recording_));
    }
    return faults;
  }

  std::vector<std::string> OfGeneralFault() const {
    const std::string of_slide = scale_is_known_ ? "" : OfSlides({found_->fault});
    if (!of_slide.empty()) return {OfScale(of_slide)};
    if (!few_->complete) {
      const auto odd = OddBesideCalibrated(project_, robot_, recording_, fit(), left_);
      if (!odd.empty()) return odd;
      const auto loose = FindSpoilingCluster(project_, robot_, recording_, fit());
      if (!loose.empty()) return loose;
    }
    if (!found_->of_one_trial || !few_->complete || few_->placed) return {few_->text};
    return {few_->text + kOrInAllOthers};
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
  bool springs_by_data_;
  const ChoiceByData& choose_;
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
                                    const Recording& recording, const ModelComparison& comparison,
                                    bool springs_by_data, const ChoiceByData& choose) {
  return FaultsInTurn(project, seed, as_recorded, robot, recording, comparison, springs_by_data,
                      choose)
      .Run();
}

}  // namespace elastocal
