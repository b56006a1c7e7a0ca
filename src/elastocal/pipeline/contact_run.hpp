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

/// Settings of CalibrateContacts.
struct ContactRunOptions {
  /// Folds of the cross-validation, 2 to the number of postures; 0: none. By default one for each
  /// posture, at most ten.
  std::optional<int> folds = {};
  int threads = 1;
  ZeroOffsets zero_offsets = ZeroOffsets::kOrigin;
  /// Mistakes that are corrected first (CorrectObservations)
  std::vector<std::string> accept = {};
  std::filesystem::path prior = {};  ///< path of an earlier calibration; empty: none
  double days = 1.0;                 ///< age of the earlier calibration
  Progress progress = {};
};

/// Start of an estimate from tables: the observations with the accepted mistakes corrected, and the
/// robot as the project or an earlier calibration describes it.
struct ContactStart {
  std::optional<EarlierContacts> earlier;
  Observations observations;
  ObservedRobot model;
  std::vector<std::string> warnings;
};

/// Reads the tables. Uses only `accept`, `prior` and `days` of the options. Throws as
/// CalibrateContacts.
ContactStart StartContacts(const Project& project,
                           const std::vector<std::filesystem::path>& recordings,
                           const ContactRunOptions& options);

/// An estimate with its errors in sample and held out.
struct ContactOutcome {
  ObservedEstimate estimate;
  std::vector<Eigen::VectorXd> left;  ///< residual of each observation in sample, SI
  ObservationFigures in_sample;
  ObservationCrossValidation held_out;  ///< folds 0: not done
};

/// Result of a calibration from touches and other instruments.
struct ContactRun {
  std::string recording;  ///< names of the files
  Observations observations;
  ObservedRobot model;
  ContactOutcome uncalibrated;  ///< fit of quantities beside the robot and of sessions only
  ContactOutcome calibrated;
  bool springs_chosen = false;     ///< all postures chose that joints of the model are elastic
  std::vector<std::string> extra;  ///< causes beyond geometry and springs that the model contains
  std::optional<CauseReport> causes;  ///< the study by which they were chosen, if there was one
  /// Where all postures chose causes: the errors (Judged) of the model without them.
  std::optional<ObservationFigures> without_causes;
  /// Where joints are elastic or there are such causes: a fit without them. The URDF has its
  /// geometry, because a URDF has no place for springs and causes.
  std::optional<ContactOutcome> geometric;
  std::optional<ObservedRobot> rigid_model;  ///< model of `geometric`
  /// Mistakes in the tables (FindObservedMistakes). They are sought where the errors of the nominal
  /// robot are larger than errors of robots. If there are any, no fold is left out, because there
  /// is nothing to validate.
  std::optional<std::vector<std::string>> mistakes;
  /// Objection to tables in which many touches were none, or many rows belong to other sessions
  /// than stated; usually empty.
  std::string wrong_rows;
  ClosureEvidence closure;
  /// Gain of the calibrated robot on held-out (else the same) postures, see GainInSds.
  double gain_in_sds = 0.0;
  CalibrationResult result;                  ///< the robot's parameters
  std::optional<CalibrationResult> in_urdf;  ///< parameters of `geometric`, which the URDF contains
  Verdict verdict;
  std::optional<CalibratedUrdf> urdf;  ///< empty where the verdict has objections
  ZeroOffsets zero_offsets = ZeroOffsets::kOrigin;
  std::vector<std::string> warnings;

  /// Errors on held-out postures if there are folds, else in sample.
  static const ObservationFigures& Judged(const ContactOutcome& outcome) {
    return outcome.held_out.folds > 0 ? outcome.held_out.figures : outcome.in_sample;
  }
  bool touches_only() const { return model.setup.plates.size() == model.setup.instruments.size(); }
  bool deployable() const { return verdict.objections.empty(); }
};

/// The robot of the project, for tables of observations. Throws InputError for patterns (hold,
/// common) that match nothing in any model of the robot, and as MakeObservedRobot.
ObservedRobot MakeRobotOfProject(const Project& project, const ObservationTables& tables);

/// Calibrates a robot that touches tables or is measured by instruments while it stands on its feet
/// or its root link is held still (see EstimateObserved). `recordings` are tables of observations.
/// The same input gives bit-identical results. Throws InputError for tables that cannot be read
/// (ReadObservationTables), for folds that they do not allow, and for an earlier calibration that
/// does not apply (MakeRobotAfterEarlier).
ContactRun CalibrateContacts(const Project& project,
                             const std::vector<std::filesystem::path>& recordings,
                             const ContactRunOptions& options);

/// "converged", "not converged", or "implausible" where the fit converged to a result that cannot
/// be trusted.
std::string RunStatus(const ContactRun& run);

/// Residual of an observation, given in SI, as text: "position 1.2 0.3 -4 mm".
std::string LeftInWords(const Instrument& instrument, const Eigen::VectorXd& left);

/// Names the observations that are left out and their residuals: "left.csv:7: ...", one sentence
/// each.
std::vector<std::string> DescribeOutliers(const ObservedRobot& model,
                                          const Observations& observations,
                                          const ObservedEstimate& estimate);

/// summary.json (docs/formats.md).
std::string MakeContactSummary(const ContactRun& run);

/// The files of a calibration by name, as by MakeCalibrationFiles.
std::map<std::string, std::string> MakeContactFiles(const Project& project, ContactRun& run);

}  // namespace elastocal
