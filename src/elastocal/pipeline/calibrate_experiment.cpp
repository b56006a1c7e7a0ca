// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/calibrate_experiment.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "elastocal/calibration/gauge.hpp"
#include "elastocal/calibration/prediction.hpp"
#include "elastocal/files/output_files.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/find_contradictions.hpp"
#include "elastocal/mistakes/find_faults.hpp"
#include "elastocal/mistakes/plain_mistakes.hpp"
#include "elastocal/mistakes/read_accepting.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/mistakes/stated_corrections.hpp"
#include "elastocal/pipeline/calibrated_robot.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/choose_model.hpp"
#include "elastocal/pipeline/cross_validate.hpp"
#include "elastocal/pipeline/earlier_calibration.hpp"
#include "elastocal/pipeline/ends_of_limbs.hpp"
#include "elastocal/pipeline/known_places.hpp"
#include "elastocal/pipeline/known_soles.hpp"
#include "elastocal/pipeline/recording_warnings.hpp"
#include "elastocal/pipeline/still_joints.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/recorded/repeated_trials.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr int kElasticityFolds = 10;  // folds for the choice of elasticity

/// Excitation by the data, and by those of an earlier calibration. The waist of trials is free.
Excitation ExcitationOf(const CalibrationResult& result, const BaseParameters& base,
                        const Recording& recording, const EarlierEstimate& earlier) {
  const std::vector<int>& fitted = result.posterior.parameters;
  Eigen::MatrixXd information = result.posterior.data_information;
  const EarlierPart known = PartOf(earlier, result.model, fitted);
  if (!known.positions.empty()) {
    information(known.positions, known.positions) += known.Information();
  }
  const Eigen::LDLT<Eigen::MatrixXd> root(information);
  Eigen::MatrixXd U = root.matrixL();
  U = root.transpositionsP().transpose() * U;
  U *= root.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(U.cols(), result.model.parameter_count());
  factor(Eigen::all, fitted) = result.marker_sd * U.transpose();
  // Geometric parameters only: the excitation of a compliance depends on the loads.
  std::vector<int> geometric;
  for (int i : base.kept) {
    if (IsElastic(result.model.parameters[i].kind)) continue;
    if (std::binary_search(fitted.begin(), fitted.end(), i)) geometric.push_back(i);
  }
  return AssessExcitation(factor, geometric, recording.posture_count(), result.marker_sd);
}

/// Error of the waist by model, on trials for validation if there are any, else on those of the
/// estimate.
ByModel<double> WaistErrors(const ModelComparison& comparison, const Measurements& measured,
                            const CalibrationOptions& settings) {
  ByModel<double> errors;
  errors.fill(std::numeric_limits<double>::quiet_NaN());
  const bool held_out = measured.validation.posture_count() > 0;
  const Recording& recording = held_out ? measured.validation : measured.calibration;
  const auto& truth = held_out ? measured.validation_truth : measured.calibration_truth;
  const auto known = [](const std::optional<Transform>& waist) { return waist.has_value(); };
  if (std::none_of(truth.begin(), truth.end(), known)) return errors;
  for (ModelKind kind : comparison.kinds) {
    const CalibrationResult& result = comparison.results[static_cast<int>(kind)];
    const Prediction prediction =
        Predict(result.model, result.delta, recording, settings, nullptr, FootingBy::kFootMarkers);
    errors[static_cast<int>(kind)] = WaistError(prediction.placement, truth);
  }
  return errors;
}

/// Gives all models their gauge. The rigid model is displaced as the full one.
void GiveGauge(const CalibrationOptions& settings, ModelComparison& comparison) {
  const CalibrationResult& largest = comparison.largest();
  const Transform displacement = FindRootDisplacement(settings.gauge, largest.model, largest.delta);
  for (ModelKind kind : comparison.kinds) {
    if (kind < ModelKind::kGeometric) continue;
    ApplyGauge(settings.gauge, settings, comparison.results[static_cast<int>(kind)],
               kind == ModelKind::kRigid ? &displacement : nullptr);
  }
}

Progress OfStep(const StepProgress& progress, const std::string& step) {
  if (!progress) return {};
  return [progress, step](int done, int total) { progress(step, done, total); };
}

void Append(const std::vector<std::string>& more, std::vector<std::string>& warnings) {
  warnings.insert(warnings.end(), more.begin(), more.end());
}

/// State of a calibration, on which its steps work.
struct Work {
  const Project& given;
  const std::vector<std::filesystem::path>& recordings;
  const ExperimentOptions& options;
  Project project;           ///< `given` with the chosen elasticity and causes
  Measurements measured;     ///< with separate markers before and after a knock
  Measurements as_recorded;  ///< as read
  RecordedModel robot;
  CalibrationRun run;
  bool sound = true;  ///< nothing is plainly wrong with the recording

  const CalibrationOptions& settings() const { return project.calibration; }
  const Recording& recording() const { return measured.calibration; }
};

/// Compares the contents of files, not their names.
void WarnOfSameRecording(Work& work) {
  const std::filesystem::path calibration = FindCalibrationFiles(work.options.prior).calibration;
  if (!IsOwnRecording(calibration, InputFiles(work.given, work.recordings))) return;
  work.run.warnings.push_back(CountsTwice(calibration.string()));
}

/// Decides what is estimated. Elasticity and causes are chosen by the data or (not in the paper)
/// taken from an earlier calibration, which is then also the prior. A recording that is plainly
/// wrong decides nothing.
void ChooseWhatIsEstimated(Work& work) {
  const ExperimentOptions& options = work.options;
  Project& project = work.project;
  CalibrationRun& run = work.run;
  if (!run.faults.empty()) {
    project.elasticity.extra.clear();
  } else if (options.prior.empty()) {
    ModelChoice choice =
        ChooseModel(work.measured, options.seed, kElasticityFolds, options.threads, project);
    run.elasticity = std::move(choice.elasticity);
    run.causes = std::move(choice.causes);
    if (choice.misses_springs) {
      run.warnings.push_back(DescribeForbiddenSprings(project.elasticity.extra));
    }
    if (work.recording().trials.empty() && !HasMasses(project.tree)) {
      run.warnings.emplace_back(
          "the robot description has no masses: it is not known whether joints give way under "
          "loads");
    }
  } else {
    Append(StartFromEarlier(options.prior, options.days, work.measured, options.seed, project),
           run.warnings);
    WarnOfSameRecording(work);
  }
  run.extra = project.elasticity.extra;
}

/// The springs and causes that other data than the recorded ones would choose.
ElasticityChoice ChoiceFor(const Measurements& measured, const Work& work) {
  Project project = work.given;
  const ExperimentOptions& options = work.options;
  ChooseModel(measured, options.seed, kElasticityFolds, options.threads, project,
              AskForSprings::kNo);
  return project.elasticity;
}

/// Warns of what is too uncertain for an objection, or too small.
void WarnOfWhatWasRecorded(Work& work) {
  CalibrationRun& run = work.run;
  run.common_scale = EstimateCommonScale(run.comparison.largest(), work.settings());
  if (!run.faults.empty()) return;  // they are worse
  Append(RecordingWarnings(work.project, run.comparison.largest(), work.recording(),
                           work.as_recorded.trials, run.common_scale),
         run.warnings);
}

/// Computes errors on held-out postures. Each fold chooses anew what the data chose.
void CrossValidateRun(int folds, Work& work) {
  const ExperimentOptions& options = work.options;
  CalibrationRun& run = work.run;
  ExperimentData data{work.project,
                      work.as_recorded.calibration,
                      options.seed,
                      {},
                      run.causes.has_value() && !run.extra.empty()};
  if (!run.elasticity.empty()) {
    data.open_elasticity = work.project.elasticity;
    data.open_elasticity->torsion = work.given.elasticity.torsion;
    data.open_elasticity->bending = work.given.elasticity.bending;
  }
  try {
    run.cross_validation = CrossValidateExperiment(data, work.robot, run.comparison,
                                                   {.folds = folds,
                                                    .unit = options.fold_unit,
                                                    .seed = options.seed.value_or(1),
                                                    .threads = options.threads},
                                                   OfStep(options.progress, "cross-validation"));
    run.decided_once = DecidedOnce(data, folds);
  } catch (const InputError& error) {  // a fold has fewer equations than unknowns
    if (options.folds) throw;
    run.warnings.push_back(std::string("not cross-validated: ") + error.what());
  }
  if (options.prior.empty() || run.cross_validation.folds == 0) return;
  const auto kind = static_cast<std::size_t>(run.comparison.largest_kind());
  const std::string worse =
      DescribeWorseUpdate(options.prior, work.robot, work.recording(), work.settings(),
                          run.cross_validation.distances[kind]);
  if (!worse.empty()) run.warnings.push_back(worse);
}

/// Computes errors on trials for validation. Labels that are exchanged there for a while are left
/// out; other contradictions are faults. Trials on a leg that the estimate does not know contradict
/// nothing (UnknownStance).
void JudgeOnOtherTrials(Work& work) {
  CalibrationRun& run = work.run;
  const RepeatedTrials repeated = FindRepeatedTrials(work.measured);
  Append(repeated.estimated_twice, run.warnings);
  Append(repeated.judged_by_estimated, run.faults);
  Recording& validation = work.measured.validation;
  if (validation.posture_count() == 0) return;
  std::string left_out;
  do {
    if (!left_out.empty()) run.warnings.push_back(left_out);
    run.held_out = JudgeOnTrials(run.comparison, validation, work.settings());
    left_out = LeaveOutBriefExchange(work.project, work.recording(), run.comparison,
                                     run.held_out->table, validation);
  } while (!left_out.empty());
  if (!run.faults.empty()) return;
  const Recording known = WithKnownStance(work.project, work.measured);
  if (known.posture_count() == 0) return;
  const bool all = known.posture_count() == validation.posture_count();
  run.faults = FindContradictions(
      work.project, work.robot, work.recording(), known, run.comparison,
      all ? run.held_out->table : JudgeOnTrials(run.comparison, known, work.settings()).table);
}

/// Judges whether the result can be trusted, as a rigid URDF and with its elasticity.
void JudgeRun(Work& work) {
  CalibrationRun& run = work.run;
  const Recording& recording = work.recording();
  run.deployment = ChooseDeployment(run.comparison, run.cross_validation,
                                    run.held_out ? &run.held_out->table : nullptr);
  run.verdict =
      Judge(run.comparison, run.cross_validation, run.excitation, recording, work.settings());
  const double expected_error = ExpectedError(work.robot.model, recording, work.settings().prior);
  JudgeDeployment(run.deployment, expected_error, run.verdict);
  if (run.faults.empty()) {  // else these say why
    const CalibrationResult& fit = run.comparison.largest();
    JudgePostures(Predict(fit.model, fit.delta, recording, work.settings()).distances, fit.used,
                  recording, expected_error, run.verdict);
  }
  if (run.held_out) {
    JudgeHeldOut(run.held_out->table, run.comparison.largest_kind(), run.deployment.urdf_kind,
                 run.verdict);
  }
  // Consequences of a named fault are no further objections.
  if (!run.faults.empty()) LeaveOutConsequences(run.verdict);
  if (!work.sound) run.verdict.objections.clear();
  run.verdict.objections.insert(run.verdict.objections.begin(), run.faults.begin(),
                                run.faults.end());
  Append(UnconfirmedCorrections(work.options.accept, work.project, work.as_recorded),
         run.verdict.objections);
  ObservationMask predicted;
  if (run.held_out) predicted = Predicted(*run.held_out, run.comparison.largest_kind());
  run.coverage = FindCoverage(work.project, work.measured, run.held_out ? &predicted : nullptr);
  const bool whole = std::ranges::all_of(
      run.coverage, [](const auto& of) { return of.calibrated || of.refused.empty(); });
  if (whole) {  // else the chain's objection says so
    Append(UnknownStance(work.project, work.measured), run.verdict.objections);
  }
  JudgeCoverage(run.coverage, run.verdict);
  Append(work.measured.warnings, run.warnings);
  for (const std::string& what : run.undone) run.warnings.push_back(DescribeUndone(what));
  Append(run.verdict.remarks, run.warnings);
  if (!run.extra.empty()) run.warnings.push_back(NotApplied(run.extra, false));
}

/// Section 5.1, the measurements y^. Markers and the robot's log pass the same low-pass filter, get
/// one clock, and are reduced to the samples at which the markers are stable, the same samples for
/// all markers of a posture, so that all weigh the same. The trials of all chains are joined.
///
/// Not in the paper: plain mistakes are named, and nothing is chosen or judged by them.
void ReadWhatWasMeasured(Work& work) {
  AcceptedMeasurements read = ReadAccepting(work.project, work.recordings, work.options.accept);
  work.measured = std::move(read.measured);
  work.run.undone = std::move(read.undone);
  work.run.faults = FindPlainMistakes(work.project, work.recording());
  work.sound = work.run.faults.empty();
}

/// Section 2, the model y(delta). Markers are seen from the waist (eq. 2 and 3), on joints and legs
/// that deflect under their loads (eq. 5 and 6); delta is eq. 7. A QR decomposition of the
/// regressor (eq. 4) over random postures tells which parameters can be identified (section 2.1).
void MakeModel(Work& work) {
  work.as_recorded = work.measured;
  work.robot = MakeRecordedModel(work.project, work.options.seed, work.measured);
  CheckGauge(work.settings().gauge, work.robot.model, work.robot.base);
  const std::string still = StillJoints(work.robot.model, work.recording());
  if (!still.empty()) work.run.warnings.push_back(still);
}

/// Section 5, eq. 14. One least-squares problem over all samples: find the delta that minimises
/// |y^ - y(delta)|^2 while the pose F(q_i, delta) of the supporting foot stays constant. Each
/// residual is divided by its standard deviation, which is estimated from the residuals. A prior
/// about the nominal robot replaces parameters held by hand.
///
/// Section 6.1.4. Simpler models (not calibrated, geometric) on the same data.
void Estimate(Work& work) {
  const RecordedModel& robot = work.robot;
  // Not in the paper: measured positions of markers are prior knowledge.
  const std::vector<MarkerMeasurement> places =
      OpenMarkerPlaces(work.options.marker_places, work.project, work.as_recorded.calibration,
                       robot.knocks, work.run.warnings);
  CalibrationResult calibrated = CalibrateWithPlaces(places, robot, work.recording(),
                                                     work.project.calibration, work.run.warnings);
  work.run.comparison =
      CompareModels(std::move(calibrated), robot.model, work.recording(), robot.base,
                    work.settings(), OfStep(work.options.progress, "fit"));
}

/// Writes delta into the robot description.
void MakeUrdf(Work& work) {
  CalibrationRun& run = work.run;
  run.zero_offsets = work.options.zero_offsets;
  if (!run.deployable()) return;
  run.urdf = MakeCalibratedUrdf(ReadFile(work.project.urdf), work.project.urdf.string(),
                                run.comparison.results[static_cast<int>(run.deployment.urdf_kind)],
                                run.zero_offsets);
  Append(run.urdf->warnings, run.warnings);
}

CalibrationRun Finished(Work work) {
  CalibrationRun& run = work.run;
  run.recording = std::move(work.measured.calibration);
  run.validation = std::move(work.measured.validation);
  run.trials = std::move(work.measured.trials);
  run.base = std::move(work.robot.base);
  run.knocks = std::move(work.robot.knocks);
  return std::move(run);
}

}  // namespace

CalibrationRun CalibrateExperiment(const Project& given,
                                   const std::vector<std::filesystem::path>& recordings,
                                   const ExperimentOptions& options) {
  Work work{given, recordings, options, given, {}, {}, {}, {}};
  CalibrationRun& run = work.run;

  ReadWhatWasMeasured(work);
  ChooseWhatIsEstimated(work);
  MakeModel(work);
  Estimate(work);

  // Not in the paper: finds mistakes of the recording from the residuals.
  if (work.sound) {
    run.faults = FindFaults(work.project, options.seed, work.as_recorded, work.robot,
                            work.recording(), run.comparison, !run.elasticity.empty(),
                            [&](const auto& measured) { return ChoiceFor(measured, work); });
  }
  WarnOfWhatWasRecorded(work);

  // Eq. 12: how well the recorded postures tell the parameters apart.
  run.excitation = ExcitationOf(run.comparison.largest(), work.robot.base, work.recording(),
                                work.settings().earlier);

  // Section 6.1.4, Table 2: errors on postures and on motions that took no part in the estimate.
  const int folds =
      work.sound ? options.folds.value_or(UsualFolds(work.robot.model, work.recording())) : 0;
  if (folds > 0) CrossValidateRun(folds, work);
  JudgeOnOtherTrials(work);
  JudgeRun(work);

  // Not in the paper: chooses the frame of the waist on the robot, which no measurement tells.
  GiveGauge(work.settings(), run.comparison);
  run.frames = AssessFrames(run.comparison.largest(), work.recording(), EndsOfLimbs(work.project));
  run.soles = KnownSoles(work.project, run.comparison.largest(), work.measured, options.prior);
  run.waist_error = WaistErrors(run.comparison, work.measured, work.settings());
  MakeUrdf(work);
  return Finished(std::move(work));
}

std::string RunStatus(const CalibrationRun& run) {
  const Termination termination = run.comparison.largest().termination;
  const bool implausible = termination == Termination::kConverged && !run.deployable();
  return implausible ? "implausible" : TerminationName(termination);
}

}  // namespace elastocal
