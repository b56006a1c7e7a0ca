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

/// Called while a long step runs: its name, and how many of its parts are done.
using StepProgress = std::function<void(const std::string& step, int done, int total)>;

struct ExperimentOptions {
  /// Folds of the cross-validation, 2 to the number of postures; 0: none. By default ten for a
  /// table of 10 to 2000 postures, and none for trials.
  std::optional<int> folds = {};
  FoldUnit fold_unit = FoldUnit::kPosture;  ///< what a fold leaves out together
  int threads = 1;                          ///< on which folds are estimated
  /// Where the joints' zero offsets go in the calibrated URDF.
  ZeroOffsets zero_offsets = ZeroOffsets::kOrigin;
  /// Seed of the random postures that tell what is identifiable (instead of the project's) and of
  /// the deal of postures to folds (instead of 1).
  std::optional<std::uint64_t> seed = {};
  /// Mistakes of the recording that are undone before anything is estimated (AcceptMistakes).
  std::vector<std::string> accept = {};
  /// An earlier calibration of the robot (the folder that calibrate wrote to, or its
  /// calibration.yaml), `days` ago: its estimates and covariance are the prior, and its choice of
  /// elasticity and causes stays.
  std::filesystem::path prior = {};
  double days = 1.0;
  /// Where markers are on their links, as measured (ReadMarkerPlaces); empty: nobody knows. Places
  /// that contradict the data are left out.
  std::filesystem::path marker_places = {};
  StepProgress progress = {};
};

/// All that is known after a calibration.
struct CalibrationRun {
  Recording recording;         ///< that the parameters were estimated from
  BaseParameters base;         ///< which of them can be identified
  ModelComparison comparison;  ///< the estimates: `comparison.largest()` is the calibration
  std::optional<CommonScale> common_scale;  ///< of all lengths, where they tell it
  Excitation excitation;  ///< how well the recorded postures tell the parameters apart
  /// Faults of the recording as a whole (RecordingFault), in words; objections of the verdict.
  std::vector<std::string> faults;
  std::vector<std::string> undone;          ///< mistakes that were undone on request, in words
  std::vector<ChainCoverage> coverage;      ///< what was recorded of each chain
  std::vector<ElasticityTrial> elasticity;  ///< tried, where the project leaves it open
  /// Causes beyond geometry and springs that were estimated, and what the search for them found.
  std::vector<std::string> extra;
  std::optional<CauseReport> causes;
  CrossValidation cross_validation;       ///< folds 0: none
  std::vector<std::string> decided_once;  ///< what its folds did not decide anew (DecidedOnce)
  std::vector<TrialSummary> trials;       ///< of recording folders: what was used of each trial
  std::vector<Knock> knocks;              ///< clusters that were knocked, and are taken as two
  Recording validation;              ///< trials that took no part in the estimate; may be empty
  std::optional<HeldOut> held_out;   ///< errors on them, where there are any
  ByModel<double> waist_error = {};  ///< m, see WaistError; NaN where the truth is unknown
  Deployment deployment;             ///< what a user takes home, and its error
  /// Of the feet, by all trials; where these tell nothing, as an earlier calibration has them.
  std::vector<SoleSpring> soles;
  std::vector<FramePrecision> frames;  ///< of the ends of limbs, which no error of markers shows
  Verdict verdict;
  /// The robot description with the estimates in it; nothing where the verdict has objections.
  std::optional<CalibratedUrdf> urdf;
  ZeroOffsets zero_offsets = ZeroOffsets::kOrigin;  ///< as asked for
  std::vector<std::string> warnings;                ///< what a user should know of, a sentence each

  /// Whether the calibration can be trusted.
  bool deployable() const { return verdict.objections.empty(); }
};

/// Calibrates a robot: reads what was recorded of it and estimates its geometric and elastic errors
/// (paper, sections 2 and 5), compares the calibrated with simpler models, tests it on data that it
/// was not estimated from (section 6.1.4), and judges whether it can be deployed.
///
///   const Project project = ReadProject("project.yaml");
///   const CalibrationRun run = CalibrateExperiment(project, {"recording.csv"});
///   if (run.deployable()) std::cout << run.urdf->text;
///
/// `recordings`: one posture table, or one or more recording folders; see ReadMeasurements. The
/// same input and seed give the same bits.
///
/// Throws InputError for recordings that cannot be read or do not suffice, and for folds that the
/// postures do not allow. A calibration that did not converge or is not to be trusted is no
/// exception: see `verdict`.
CalibrationRun CalibrateExperiment(const Project& given,
                                   const std::vector<std::filesystem::path>& recordings,
                                   const ExperimentOptions& options = {});

/// "converged", "not converged", "failed", or "implausible" where the verdict has objections though
/// the fit has converged.
std::string RunStatus(const CalibrationRun& run);

}  // namespace elastocal
