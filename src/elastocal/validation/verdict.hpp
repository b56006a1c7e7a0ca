// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/identifiability/observability.hpp"
#include "elastocal/validation/deployment.hpp"
#include "elastocal/validation/error_table.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// Whether a calibration can be trusted, in sentences on which a user can act.
struct Verdict {
  /// Reasons why the calibration should not be deployed: the model does not explain the recording,
  /// or the recording does not determine the model. Empty if there are none.
  std::vector<std::string> objections;
  /// What to look at before the calibration is deployed.
  std::vector<std::string> remarks;
};

/// Judges a calibration. Objections are: no convergence; noise above
/// CalibrationOptions::plausible_marker_sd; a prior that would have to be widened beyond
/// MostWidening; an axis turned by more than a right angle; dependent columns; more than a quarter
/// of the observations outliers. `validation` may have no folds.
Verdict Judge(const ModelComparison& comparison, const CrossValidation& validation,
              const Excitation& excitation, const Recording& recording,
              const CalibrationOptions& options);

/// Where mistakes of the recording are named, takes out the objections to the fit that ask the user
/// to look for some (implausible noise, angles, lengths and errors, too many outliers), and the
/// remark which parameter is furthest from nominal.
void LeaveOutConsequences(Verdict& verdict);

/// Adds an objection where the URDF alone is worse than the uncalibrated robot (by 5 % or more, on
/// data not used for it), and a remark where it is about as good: there is nothing to correct. Also
/// an objection where it errs by more than twice what a robot is expected to err that was never
/// calibrated (ExpectedError, m): better than a worse one is not good.
void JudgeDeployment(const Deployment& deployment, double expected_error, Verdict& verdict);

/// Adds an objection where a fifth of the postures of a trial, or of a table, and two at least, are
/// further off in the fit than any robot is (five times `expected_error`, ExpectedError, m), and a
/// warning as a remark where it is fewer: a fit in which single postures count little looks good
/// beside them. `distances` of the fit as Predict has them, over the observations `used`.
void JudgePostures(const Eigen::MatrixXd& distances, const ObservationMask& used,
                   const Recording& recording, double expected_error, Verdict& verdict);

/// Adds the judgement by held-out trials on the calibrated model `model`: an objection for each
/// group of chains whose markers it predicts worse than the uncalibrated robot does (by 5 %), and a
/// remark for each group that it predicts worse than a simpler model does, or where the URDF alone
/// (`urdf`) is no better than the uncalibrated robot.
void JudgeHeldOut(const ErrorTable& table, ModelKind model, ModelKind urdf, Verdict& verdict);

}  // namespace elastocal
