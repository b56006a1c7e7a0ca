// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/identifiability/observability.hpp"
#include "elastocal/validation/deployment.hpp"
#include "elastocal/validation/error_table.hpp"
#include "elastocal/validation/model_comparison.hpp"

namespace elastocal {

/// Judgement whether a calibration can be trusted, in sentences on which a user can act.
struct Verdict {
  /// Reasons why the calibration should not be deployed: the model does not explain the recording,
  /// or the recording does not determine the model. Empty if there are none.
  std::vector<std::string> objections;
  /// Observations that the user should check before the calibration is deployed.
  std::vector<std::string> remarks;
};

/// Judges a calibration. Objections are: no convergence; noise above
/// CalibrationOptions::plausible_marker_sd; a prior of angles or lengths that would have to be
/// widened beyond MostWidening; an axis turned by more than a right angle; more than half of the
/// parameters hardly excited (HardlyExcited); more than a quarter of the observations outliers, or
/// too few left without them. `validation` may have no folds.
Verdict Judge(const ModelComparison& comparison, const CrossValidation& validation,
              const Excitation& excitation, const Recording& recording,
              const CalibrationOptions& options);

/// Removes what follows from mistakes in the recording that were named otherwise: the objections to
/// the fit that advise the user to look for mistakes (implausible noise, angles, lengths and
/// errors, too many outliers), and the remark which parameter is furthest from nominal.
void LeaveOutConsequences(Verdict& verdict);

/// Judges the URDF alone. Adds an objection if its error exceeds that of the uncalibrated robot by
/// more than 5 % on data that were not used for it, and a remark if it is no smaller: there is
/// nothing to correct. Errors that are not finite say nothing. Adds an objection if its error
/// exceeds twice the expected error of a robot that was never calibrated (ExpectedError, m): to be
/// better than an even worse robot is not enough.
void JudgeDeployment(const Deployment& deployment, double expected_error, Verdict& verdict);

/// Judges single postures in the fit. A posture is gross if the root mean square of its `distances`
/// exceeds five times `expected_error` (ExpectedError, m), which is no error of a robot. Adds an
/// objection if at least two postures and a fifth of those of a trial, or of a posture table, are
/// gross, and a remark if fewer are: a fit in which single postures count little looks good beside
/// them. `distances` are those of the fit as Predict gives them; only observations in `used` count.
void JudgePostures(const Eigen::MatrixXd& distances, const ObservationMask& used,
                   const Recording& recording, double expected_error, Verdict& verdict);

/// Judges the calibrated model `model` by held-out trials. Adds an objection for each group of
/// chains whose markers it predicts worse than the uncalibrated robot (by more than 5 %). Adds a
/// remark for each group that it predicts worse than a simpler model (by 1 %), or where the URDF
/// alone (`urdf`) is no better than the uncalibrated robot, and for each trial of which nothing
/// could be predicted.
void JudgeHeldOut(const ErrorTable& table, ModelKind model, ModelKind urdf, Verdict& verdict);

}  // namespace elastocal
