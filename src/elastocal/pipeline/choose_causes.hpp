// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/cause_search.hpp"
#include "elastocal/calibration/marker_places.hpp"
#include "elastocal/observation/observation_fit.hpp"
#include "elastocal/pipeline/cause_pictures.hpp"
#include "elastocal/recorded/measurements.hpp"

namespace elastocal {

/// What a recording says about causes of error beyond geometry and springs.
struct CauseReport {
  CauseSearch search;
  std::vector<Parameter> parameters;    ///< that CauseFinding::parameters refer to
  std::vector<Correction> corrections;  ///< that these refer to
  int postures = 0;
  /// Whether errors are in m; else in standard deviations of the noise of what was observed.
  bool in_metres = true;
  double error_factor() const { return in_metres ? 1e3 : 1.0; }
  const char* error_unit() const { return in_metres ? "mm" : "sds"; }
  std::vector<CausePicture> pictures;  ///< of the causes that were taken, and of the best others
};

/// Calibrates without extra causes (those of `given` are ignored, but for those of an earlier
/// calibration that is the prior), then tests each and searches the best set. `places`: of markers,
/// as measured; those that contradict the recording are left out. Throws what Calibrate throws.
CauseReport StudyCauses(const Project& given, const Measurements& measured,
                        std::optional<std::uint64_t> seed,
                        const std::vector<MarkerMeasurement>& places = {});

/// The same of tables of observations, beside what `model` has: `fit` is that of `model`.
CauseReport StudyObservedCauses(const Project& project, const ObservedRobot& model,
                                const Observations& observations, const ObservationFit& fit,
                                std::optional<std::uint64_t> seed);

/// Whether a table of so many postures may choose causes without being asked: 15 to 300.
bool MayChooseCauses(int postures);

/// Sets the extra causes of the project's models as `calibration.extra` says: those named, none,
/// or those that the held-out error of a table of 15 to 300 postures asks for and that a
/// calibration with all of them does not find within their uncertainty; then what was found on the
/// way.
std::optional<CauseReport> ChooseCauses(const Measurements& measured,
                                        std::optional<std::uint64_t> seed, Project& project);

/// The same of tables of observations, where `fit` is that of `model`: the causes, and what was
/// found on the way. The same tables give the same causes. Throws InputError for names of
/// `calibration.extra` that these tables cannot show.
struct ObservedCauses {
  std::vector<std::string> extra;
  std::optional<CauseReport> report;
};
ObservedCauses ChooseObservedCauses(const Project& project, const ObservedRobot& model,
                                    const Observations& observations, const ObservationFit& fit);

/// Extra causes that a stored calibration has, by the names of its parameters; not those of its
/// recording alone (drift).
std::vector<std::string> StoredCauses(const RobotTree& tree,
                                      const std::map<std::string, double>& joint_errors);

/// The least significant cause of a calibration that has several, if zero lies within the region of
/// two standard deviations of all its parameters together: another cause, or a spring, then
/// explains what it was found by. (Each parameter alone may be doubtful although the cause is
/// plain.) Nothing where every cause is significant.
std::optional<std::string> IdleCause(const CalibrationResult& result);

/// Those of these causes that neither an export nor `compensate` applies, because they depend on
/// more than positions and loads.
std::vector<std::string> NeverApplied(const std::vector<std::string>& causes);

/// What a controller must compensate for the stated errors to hold: "compensation of elasticity and
/// j.gear". `springs`: whether elasticity is a part of it.
std::string CompensationInWords(bool springs, const std::vector<std::string>& causes);

/// A warning: these causes were taken of a robot that the project holds rigid, and elastic joints
/// would plainly predict better.
std::string DescribeForbiddenSprings(const std::vector<std::string>& causes);

/// A warning for whoever uses a calibration with these causes, which names those that are not
/// applied; empty where all are. `at_run_time`: in a robot at run time, which applies what depends
/// on motion and loads.
std::string NotApplied(const std::vector<std::string>& causes, bool at_run_time);

}  // namespace elastocal
