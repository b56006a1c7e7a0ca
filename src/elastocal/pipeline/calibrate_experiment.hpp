// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/frame_precision.hpp"
#include "elastocal/calibration/sole_springs.hpp"
#include "elastocal/description/calibrated_urdf.hpp"
#include "elastocal/identifiability/observability.hpp"
#include "elastocal/pipeline/choose_causes.hpp"
#include "elastocal/pipeline/coverage.hpp"
#include "elastocal/recorded/choose_elasticity.hpp"
#include "elastocal/recorded/measurements.hpp"
#include "elastocal/screening/camera_scale.hpp"
#include "elastocal/screening/knocks.hpp"
#include "elastocal/screening/recording_faults.hpp"
#include "elastocal/validation/deployment.hpp"
#include "elastocal/validation/held_out.hpp"
#include "elastocal/validation/model_comparison.hpp"
#include "elastocal/validation/verdict.hpp"

namespace elastocal {

/// Called while a long step runs, with the name of the step and how many of its parts are done.
using StepProgress = std::function<void(const std::string& step, int done, int total)>;

/// Settings of CalibrateExperiment.
struct ExperimentOptions {
  /// Folds of the cross-validation, 2 to the number of postures; 0: none. By default ten for a
  /// posture table of 10 to 2000 postures, one each for fewer, and none for larger tables and
  /// trials.
  std::optional<int> folds = {};
  FoldUnit fold_unit = FoldUnit::kPosture;  ///< what a fold leaves out as a whole
  int threads = 1;                          ///< number of threads on which folds are estimated
  /// How the calibrated URDF expresses the joints' zero offsets.
  ZeroOffsets zero_offsets = ZeroOffsets::kOrigin;
  /// Seed of the random postures that tell what is identifiable (default: the project's) and of the
  /// division of postures into folds (default: 1).
  std::optional<std::uint64_t> seed = {};
  /// Mistakes of the recording that are corrected before anything is estimated (AcceptMistakes).
  std::vector<std::string> accept = {};
  /// An earlier calibration of the robot, `days` old: the folder that calibrate wrote to, or its
  /// calibration.yaml. Its estimates and covariance are the prior, and its choice of elasticity and
  /// causes is kept.
  std::filesystem::path prior = {};
  double days = 1.0;
  /// File of marker positions measured on their links (ReadMarkerPlaces); empty: none. Positions
  /// that contradict the data are left out.
  std::filesystem::path marker_places = {};
  StepProgress progress = {};
};

/// Result of CalibrateExperiment.
struct CalibrationRun {
  Recording recording;  ///< recording from which the parameters were estimated
  BaseParameters base;  ///< parameters that can be identified
  /// Estimates of all models; `comparison.largest()` is the calibration.
  ModelComparison comparison;
  std::optional<CommonScale> common_scale;  ///< common scale of all lengths, where they tell it
  Excitation excitation;  ///< how well the recorded postures excite the parameters
  /// Faults of the recording as a whole (RecordingFault), in words; they are objections of the
  /// verdict.
  std::vector<std::string> faults;
  std::vector<std::string> undone;      ///< mistakes that were corrected on request, in words
  std::vector<ChainCoverage> coverage;  ///< what was recorded of each chain
  /// Choices of elasticity that were tried, where the project leaves it open.
  std::vector<ElasticityTrial> elasticity;
  /// Causes beyond geometry and springs that were estimated, and the result of the search for them.
  std::vector<std::string> extra;
  std::optional<CauseReport> causes;
  CrossValidation cross_validation;  ///< folds 0: not done
  /// Choices that the folds did not make anew (DecidedOnce)
  std::vector<std::string> decided_once;
  std::vector<TrialSummary> trials;  ///< for recording folders: what was used of each trial
  std::vector<Knock> knocks;         ///< clusters that were knocked; each is treated as two
  /// Trials for validation, which took no part in the estimate; may be empty.
  Recording validation;
  std::optional<HeldOut> held_out;  ///< errors on them, if there are any
  /// Error of the waist, m, see WaistError; NaN where the truth is unknown.
  ByModel<double> waist_error = {};
  Deployment deployment;  ///< what the user deploys, with its error
  /// Compliance of the soles by all trials; where these do not tell it, that of an earlier
  /// calibration.
  std::vector<SoleSpring> soles;
  /// Expected errors of the ends of limbs, which no marker errors show.
  std::vector<FramePrecision> frames;
  Verdict verdict;
  /// The robot description with the estimates; empty where the verdict has objections.
  std::optional<CalibratedUrdf> urdf;
  ZeroOffsets zero_offsets = ZeroOffsets::kOrigin;  ///< as requested
  std::vector<std::string> warnings;                ///< what the user should know, a sentence each

  /// Whether the calibration can be trusted.
  bool deployable() const { return verdict.objections.empty(); }
};

/// Calibrates a robot. Reads what was recorded of it and estimates its geometric and elastic errors
/// (paper, sections 2 and 5), compares the calibrated model with simpler ones, tests it on data
/// from which it was not estimated (section 6.1.4), and judges whether it can be deployed.
///
///   const Project project = ReadProject("project.yaml");
///   const CalibrationRun run = CalibrateExperiment(project, {"recording.csv"});
///   if (run.deployable()) std::cout << run.urdf->text;
///
/// `recordings` is one posture table, or one or more recording folders; see ReadMeasurements. The
/// same input and seed give bit-identical results.
///
/// Throws InputError for recordings that cannot be read or do not suffice, and for folds that the
/// postures do not allow. A calibration that did not converge or cannot be trusted is no exception:
/// see `verdict`.
CalibrationRun CalibrateExperiment(const Project& given,
                                   const std::vector<std::filesystem::path>& recordings,
                                   const ExperimentOptions& options = {});

/// "converged", "not converged", "failed", or "implausible" where the verdict has objections though
/// the fit has converged.
std::string RunStatus(const CalibrationRun& run);

}  // namespace elastocal
