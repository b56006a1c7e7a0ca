// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/description/calibrated_urdf.hpp"
#include "elastocal/io/observation_table.hpp"
#include "elastocal/math/progress.hpp"
#include "elastocal/observation/observation_figures.hpp"
#include "elastocal/observation/standing_robot.hpp"
#include "elastocal/pipeline/choose_causes.hpp"
#include "elastocal/pipeline/contact_earlier.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/validation/verdict.hpp"

namespace elastocal {

struct ContactRunOptions {
  /// Folds of the cross-validation, 2 to the number of postures; 0: none. By default one a posture,
  /// up to ten.
  std::optional<int> folds = {};
  int threads = 1;
  ZeroOffsets zero_offsets = ZeroOffsets::kOrigin;
  std::vector<std::string> accept = {};  ///< mistakes that are corrected (CorrectObservations)
  std::filesystem::path prior = {};      ///< an earlier calibration; empty: none
  double days = 1.0;                     ///< since then
  Progress progress = {};
};

/// What an estimate from tables begins with: the observations with the accepted mistakes corrected,
/// and the robot as the project or an earlier calibration describes it.
struct ContactStart {
  std::optional<EarlierContacts> earlier;
  Observations observations;
  ObservedRobot model;
  std::vector<std::string> warnings;
};

/// Reads the tables; of the options `accept`, `prior` and `days` count. Throws as CalibrateContacts
/// does.
ContactStart StartContacts(const Project& project,
                           const std::vector<std::filesystem::path>& recordings,
                           const ContactRunOptions& options);

/// An estimate with its errors in and out of sample.
struct ContactOutcome {
  ObservedEstimate estimate;
  ObservationFigures in_sample;
  ObservationCrossValidation held_out;  ///< folds 0: none
};

/// A calibration from touches and other instruments.
struct ContactRun {
  std::string recording;  ///< the files, for people
  Observations observations;
  ObservedRobot model;
  ContactOutcome uncalibrated;  ///< quantities beside the robot and sessions only
  ContactOutcome calibrated;
  std::vector<std::string> extra;     ///< causes beyond geometry and springs that the model has
  std::optional<CauseReport> causes;  ///< how they were chosen, where they were
  /// Where joints are elastic or there are such causes: the robot without. The URDF has its
  /// geometry, because a URDF has no place for them.
  std::optional<ContactOutcome> geometric;
  std::optional<ObservedRobot> rigid_model;  ///< that of `geometric`
  /// Mistakes in the tables, which are sought where the nominal robot is off by more than robots
  /// are (FindObservedMistakes). With one, nothing is left out: there is nothing to validate.
  std::optional<std::vector<std::string>> mistakes;
  /// Objection to tables many of whose touches were none, or with rows of other sessions than they
  /// say; usually empty.
  std::string wrong_rows;
  ClosureEvidence closure;
  double gain_in_sds = 0.0;  ///< of calibrated on held-out (or the same) postures, see GainInSds
  CalibrationResult result;  ///< the parameters of the robot
  std::optional<CalibrationResult> in_urdf;  ///< those of `geometric`, which the URDF has
  Verdict verdict;
  std::optional<CalibratedUrdf> urdf;  ///< nothing where the verdict has objections
  ZeroOffsets zero_offsets = ZeroOffsets::kOrigin;
  std::vector<std::string> warnings;

  /// On postures that were left out, where there are folds, else on those of the fit.
  static const ObservationFigures& Judged(const ContactOutcome& outcome) {
    return outcome.held_out.folds > 0 ? outcome.held_out.figures : outcome.in_sample;
  }
  bool touches_only() const { return model.setup.plates.size() == model.setup.instruments.size(); }
  bool deployable() const { return verdict.objections.empty(); }
};

/// The robot as the project describes it, for tables of observations. Throws InputError for what
/// MakeObservedRobot refuses.
ObservedRobot MakeRobotOfProject(const Project& project, const ObservationTables& tables);

/// Calibrates a robot that touches tables or is measured by instruments while it stands on its feet
/// or its root link is held still: see EstimateObserved. `recordings`: tables of observations. The
/// same input gives the same bits. Throws InputError for tables that cannot be read
/// (ReadObservationTables), folds that they do not allow, and an earlier calibration that does not
/// apply (MakeRobotAfterEarlier).
ContactRun CalibrateContacts(const Project& project,
                             const std::vector<std::filesystem::path>& recordings,
                             const ContactRunOptions& options);

/// "converged", "not converged", or "implausible" where it settled on what cannot be trusted.
std::string RunStatus(const ContactRun& run);

/// What is left of an observation, SI, for people: "position 1.2 0.3 -4 mm".
std::string LeftInWords(const Instrument& instrument, const Eigen::VectorXd& left);

/// What the observations that are left out, and how far they are off, are called: "left.csv:7:
/// ...", one sentence each.
std::vector<std::string> DescribeOutliers(const ObservedRobot& model,
                                          const Observations& observations,
                                          const ObservedEstimate& estimate);

/// summary.json (docs/formats.md).
std::string MakeContactSummary(const ContactRun& run);

/// The files of a calibration by name, as MakeCalibrationFiles has them.
std::map<std::string, std::string> MakeContactFiles(const Project& project, ContactRun& run);

}  // namespace elastocal
