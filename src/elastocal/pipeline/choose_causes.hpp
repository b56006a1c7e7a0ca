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

/// What a recording tells about causes of error beyond geometry and springs.
struct CauseReport {
  CauseSearch search;
  std::vector<Parameter> parameters;    ///< parameters to which CauseFinding::parameters refer
  std::vector<Correction> corrections;  ///< corrections to which these parameters refer
  int postures = 0;
  /// Errors are in m; if false, in standard deviations of the observations' noise.
  bool in_metres = true;
  double error_factor() const { return in_metres ? 1e3 : 1.0; }
  const char* error_unit() const { return in_metres ? "mm" : "sds"; }
  /// Pictures of the causes that were taken, and of the best others.
  std::vector<CausePicture> pictures;
};

/// Calibrates without extra causes (those of `given` are ignored, unless they belong to an earlier
/// calibration that is the prior), then tests each cause and searches for the best set. `places`
/// are measured positions of markers; those that contradict the recording are left out. Throws as
/// Calibrate.
CauseReport StudyCauses(const Project& given, const Measurements& measured,
                        std::optional<std::uint64_t> seed,
                        const std::vector<MarkerMeasurement>& places = {});

/// As StudyCauses, for tables of observations, beside what `model` contains; `fit` is the fit of
/// `model`.
CauseReport StudyObservedCauses(const Project& project, const ObservedRobot& model,
                                const Observations& observations, const ObservationFit& fit,
                                std::optional<std::uint64_t> seed);

/// Whether causes are chosen without a request for so many postures of a table: 15 to 300.
bool MayChooseCauses(int postures);

/// Sets the extra causes of the project's model as `calibration.extra` says: the named ones, none,
/// or those that lower the held-out error of a posture table of 15 to 300 postures and that a
/// calibration with all of them finds significant (IdleCause). Returns the study where one was
/// made.
std::optional<CauseReport> ChooseCauses(const Measurements& measured,
                                        std::optional<std::uint64_t> seed, Project& project);

/// As ChooseCauses, for tables of observations; `fit` is the fit of `model`. Returns the causes and
/// the study. The same tables give the same causes. Throws InputError for names in
/// `calibration.extra` that these tables cannot show.
struct ObservedCauses {
  std::vector<std::string> extra;
  std::optional<CauseReport> report;
};
ObservedCauses ChooseObservedCauses(const Project& project, const ObservedRobot& model,
                                    const Observations& observations, const ObservationFit& fit);

/// Extra causes of a stored calibration, by the names of its parameters, without those that hold
/// for its recording alone (drift).
std::vector<std::string> StoredCauses(const RobotTree& tree,
                                      const std::map<std::string, double>& joint_errors);

/// The least significant cause of a calibration, if zero lies within the two-standard-deviation
/// region of all its parameters together: another cause, or a spring, then explains what it was
/// chosen for. (Each parameter alone may be doubtful although the cause is plain.) Nothing where
/// every cause is significant.
std::optional<std::string> IdleCause(const CalibrationResult& result);

/// Those of the causes that neither an export nor `compensate` applies, because they depend on time
/// (drift, creep).
std::vector<std::string> NeverApplied(const std::vector<std::string>& causes);

/// What a controller must compensate for the stated errors to hold: "compensation of elasticity and
/// j.gear". `springs` says whether elasticity is part of it.
std::string CompensationInWords(bool springs, const std::vector<std::string>& causes);

/// Warning that these causes were taken for a robot that the project holds rigid, although elastic
/// joints would plainly predict better.
std::string DescribeForbiddenSprings(const std::vector<std::string>& causes);

/// Warning for users of a calibration with these causes, which names those that are not applied;
/// empty where all are. `at_run_time` is for a robot at run time, which also applies causes that
/// depend on motion and loads.
std::string NotApplied(const std::vector<std::string>& causes, bool at_run_time);

}  // namespace elastocal
