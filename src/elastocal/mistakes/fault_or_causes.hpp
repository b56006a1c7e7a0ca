// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "elastocal/mistakes/general_fault.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/recorded/recorded_model.hpp"

namespace elastocal {

struct FoundFault : GeneralFault {
  /// From FindTrialOffset: other trials do not tell which trial is wrong.
  bool of_one_trial = false;
  /// From FindWithoutCauses: error of the robot without causes, the fault not undone, m.
  double without_causes = std::numeric_limits<double>::infinity();
};

/// Finds the fault that explains most of what the fit `result` leaves. Several apparent knocks may
/// be one fault that displaces all these clusters, which is therefore also searched for without the
/// knocks; not in a table, where distances within a cluster tell a marker that was glued on again.
/// `as_recorded` is the recording before markers were split at knocks.
std::optional<FoundFault> FindGeneralFault(const Project& project,
                                           std::optional<std::uint64_t> seed,
                                           Measurements as_recorded, const RecordedModel& robot,
                                           const Recording& recording,
                                           const CalibrationResult& result);

/// Whether data that have a fault may have chosen what hides it: causes or, in a table, which
/// joints give way and how. What the project states hides nothing.
bool MayHideFault(const Project& project, bool springs_by_data);

/// Finds the fault of a robot without the causes that it seemed to have. Where the data chose the
/// springs, all its joints are elastic about their axes.
std::optional<FoundFault> FindWithoutCauses(Project project, std::optional<std::uint64_t> seed,
                                            const Measurements& as_recorded, bool springs_by_data);

/// Whether faults, and not the springs beside them, explain what a plain fit leaves. `few`: its
/// error with the faults undone, `plain`: with them (FoundFault::without_causes), m.
bool ExplainPlainFit(double few, double plain);

/// Whether few faults leave less than what the data chose: far less or, where the data chose that
/// joints bend and no causes, less with fewer parameters. `few`: error of the plain fit with the
/// faults undone, `chosen`: of the fit with what was chosen, m.
bool LeaveLess(double few, double chosen, bool bends);

/// Lets the data of a table choose springs and causes.
using ChoiceByData = std::function<ElasticityChoice(const Measurements&)>;

/// Whether faults of joints explain a recording as well as the causes that these joints have in the
/// fit `with`: an eccentricity and an ellipticity together look like a gain (of which play and
/// stiffening are no part). Causes of this size (five times the typical one) are in no robot. With
/// the faults undone, a fit without these causes, or one with what the data choose then (`choose`;
/// may be empty), leaves at most a tenth more than `left`, the error of `with`, m.
bool ReplaceCauses(const std::vector<RecordingFault>& faults, Project project,
                   std::optional<std::uint64_t> seed, const Measurements& as_recorded,
                   const CalibrationResult& with, double left, const ChoiceByData& choose);

/// Whether the faults are gains, in all trials, of the joints of these gears and of no others.
bool AreGainsOf(const std::vector<RecordingFault>& faults,
                const std::vector<RecordingFault>& gears);

}  // namespace elastocal
