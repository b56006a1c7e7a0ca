// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/fault_or_causes.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/calibration/marker_places.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/mistakes/trial_offset.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/screening/recording_faults.hpp"

namespace elastocal {
namespace {

constexpr double kClearlyLess = 0.8;  // ratio of errors of fits

std::vector<std::string> AllJoints() { return {"*"}; }

/// In a table, distances within a cluster tell a marker that was glued on again, whatever else is
/// wrong. In trials, a fault of a joint looks like knocks.
KnockSearch PlainKnocks(const Recording& recording) {
  return recording.trials.empty() ? KnockSearch::kAll : KnockSearch::kNone;
}

/// Whether a cause is a function of the joints' positions alone, as a gain is. The direction of the
/// last motion and loads are none, and a robot with a wrong gain still has them.
bool IsOfPositions(CorrectionShape shape) {
  switch (shape) {
    case CorrectionShape::kSin:
    case CorrectionShape::kCos:
    case CorrectionShape::kSinTwice:
    case CorrectionShape::kCosTwice:
    case CorrectionShape::kGear:
    case CorrectionShape::kCoupling:
      return true;
    default:
      return false;
  }
}

/// Whether any of these causes is estimated five times as large as a robot's typically are.
bool AreOfNoRobot(const std::set<std::string>& causes, const CalibrationResult& result) {
  constexpr double kOfTypical = 5.0;
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    const Parameter& parameter = result.model.parameters[Size(i)];
    if (parameter.correction < 0) continue;
    const Correction& of = result.model.elasticity.corrections[Size(parameter.correction)];
    const bool large = std::abs(result.delta[i]) > kOfTypical * parameter.typical;
    if (large && causes.contains(of.cause)) return true;
  }
  return false;
}

/// Causes of a joint that may look like this fault of it.
std::set<std::string> CausesLike(const RecordingFault& fault, const ErrorModel& model) {
  const std::string& joint = JointOfCoordinate(model.tree, fault.coordinate).name;
  std::set<std::string> causes;
  for (const Correction& correction : model.elasticity.corrections) {
    const std::string& cause = correction.cause;
    const bool of = cause.starts_with(joint + ".") || cause.ends_with(".coupling_" + joint);
    const bool alike = fault.kind != FaultKind::kJointGain || IsOfPositions(correction.shape);
    if (of && alike) causes.insert(cause);
  }
  return causes;
}

/// Whether the robot of a project leaves at most a tenth more than `left` of a recording from which
/// the faults are removed, without causes that no robot has in their place.
bool LeavesNoMore(const Project& project, std::optional<std::uint64_t> seed, Measurements undone,
                  const std::vector<RecordingFault>& faults, double left) {
  constexpr double kAsWellAsCauses = 1.1;
  try {
    const RecordedModel robot =
        MakeRecordedModel(project, seed, undone, PlainKnocks(undone.calibration));
    const CalibrationResult fit = Calibrate(robot.model, undone.calibration, robot.base,
                                            ModelKinds(robot.model).back(), project.calibration);
    if (MarkerError(fit, undone.calibration, project.calibration) > kAsWellAsCauses * left) {
      return false;
    }
    return std::ranges::none_of(faults, [&](const RecordingFault& fault) {
      return AreOfNoRobot(CausesLike(fault, fit.model), fit);
    });
  } catch (const InputError&) {
    return false;
  }
}

/// Faults that are certain or, without any, the suspected one that explains most, if a fit to the
/// recording without it leaves less than half of the error.
std::vector<RecordingFault> ProvedFaults(const CalibrationResult& result,
                                         const BaseParameters& base, const Recording& recording,
                                         const CalibrationOptions& options) {
  constexpr double kLeftOfProved = 0.5;
  // What is certain is suspected as well, so that a clean recording is searched once. The search
  // for suspected faults looks more closely where one is, and so may find others that are certain.
  std::vector<RecordingFault> faults =
      FindRecordingFaults(result, recording, options, Certainty::kSuspected);
  const auto is_certain = [](const RecordingFault& one) { return IsCertain(one); };
  if (std::ranges::any_of(faults, is_certain)) {
    std::vector<RecordingFault> certain = FindRecordingFaults(result, recording, options);
    if (!certain.empty()) return certain;
  }
  if (faults.empty() || faults.front().linkage >= 0) return {};
  faults.resize(1);
  const Recording without = WithoutFault(recording, faults.front());
  const double left =
      MarkerError(Calibrate(result.model, without, base, result.kind, options), without, options);
  if (left < kLeftOfProved * MarkerError(result, recording, options)) return faults;
  return {};
}

}  // namespace

std::optional<FoundFault> FindGeneralFault(const Project& project,
                                           std::optional<std::uint64_t> seed,
                                           Measurements as_recorded, const RecordedModel& robot,
                                           const Recording& recording,
                                           const CalibrationResult& result) {
  const CalibrationOptions& options = project.calibration;
  GeneralFault general{{},      robot.model,           robot.base, recording, result.kind,
                       options, as_recorded.validation};
  std::vector<RecordingFault> faults = ProvedFaults(result, robot.base, recording, options);
  std::optional<RecordingFault> hidden;
  if (robot.knocks.empty() || recording.trials.empty()) {
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

bool AreGainsOf(const std::vector<RecordingFault>& faults,
                const std::vector<RecordingFault>& gears) {
  std::set<int> of_faults, of_gears;
  for (const RecordingFault& gear : gears) of_gears.insert(gear.coordinate);
  for (const RecordingFault& fault : faults) {
    if (fault.kind != FaultKind::kJointGain || fault.trial >= 0) return false;
    of_faults.insert(fault.coordinate);
  }
  return of_faults == of_gears;
}

bool MayHideFault(const Project& project, bool springs_by_data) {
  if (KnowsRobot(project.calibration.earlier)) return false;
  const ElasticityChoice& own = project.elasticity;
  if (!own.extra.empty()) return project.calibration.extra.automatic;
  if (!springs_by_data) return false;
  return own.torsion != AllJoints() || (own.bending && !own.bending->empty());
}

std::optional<FoundFault> FindWithoutCauses(Project project, std::optional<std::uint64_t> seed,
                                            const Measurements& as_recorded, bool springs_by_data) {
  project.elasticity.extra.clear();
  if (springs_by_data) {
    project.elasticity.torsion = AllJoints();
    project.elasticity.bending.reset();
  }
  try {
    Measurements plain = as_recorded;
    const RecordedModel robot =
        MakeRecordedModel(project, seed, plain, PlainKnocks(plain.calibration));
    const CalibrationResult fit = Calibrate(robot.model, plain.calibration, robot.base,
                                            ModelKinds(robot.model).back(), project.calibration);
    auto found = FindGeneralFault(project, seed, as_recorded, robot, plain.calibration, fit);
    if (found) found->without_causes = MarkerError(fit, plain.calibration, project.calibration);
    return found;
  } catch (const InputError&) {  // fewer equations than the unknowns of a robot with springs
    return std::nullopt;
  }
}

bool ExplainPlainFit(double few, double plain) { return few < kClearlyLess * plain; }

bool LeaveLess(double few, double chosen, bool bends) {
  return few < kClearlyLess * chosen || (bends && few < chosen);
}

bool ReplaceCauses(const std::vector<RecordingFault>& faults, Project project,
                   std::optional<std::uint64_t> seed, const Measurements& as_recorded,
                   const CalibrationResult& with, double left, const ChoiceByData& choose) {
  Measurements undone = as_recorded;
  std::set<std::string> removed;
  for (const RecordingFault& fault : faults) {
    const bool of_joint =
        fault.kind == FaultKind::kJointGain || fault.kind == FaultKind::kJointOffset;
    if (!of_joint || fault.coordinate < 0 || fault.linkage >= 0) return false;
    removed.merge(CausesLike(fault, with.model));
    undone.calibration = WithoutFault(undone.calibration, fault);
  }
  if (!AreOfNoRobot(removed, with)) return false;
  std::erase_if(project.elasticity.extra,
                [&](const std::string& cause) { return removed.contains(cause); });
  if (LeavesNoMore(project, seed, undone, faults, left)) return true;
  if (!choose) return false;
  try {
    project.elasticity = choose(undone);
  } catch (const InputError&) {  // the fault explains too little of it for any model
    return false;
  }
  return LeavesNoMore(project, seed, undone, faults, left);
}

}  // namespace elastocal
