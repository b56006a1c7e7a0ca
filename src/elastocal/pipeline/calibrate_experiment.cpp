// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/calibrate_experiment.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "elastocal/calibration/coarse_positions.hpp"
#include "elastocal/calibration/gauge.hpp"
#include "elastocal/calibration/prediction.hpp"
#include "elastocal/files/output_files.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/pipeline/choose_model.hpp"
#include "elastocal/pipeline/cross_validate.hpp"
#include "elastocal/pipeline/earlier_calibration.hpp"
#include "elastocal/pipeline/find_contradictions.hpp"
#include "elastocal/pipeline/find_faults.hpp"
#include "elastocal/pipeline/plain_mistakes.hpp"
#include "elastocal/pipeline/recorded_model.hpp"
#include "elastocal/pipeline/recording_mistakes.hpp"
#include "elastocal/pipeline/repeated_trials.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr int kElasticityFolds = 10;  // of the choice of elasticity

/// By what the data, and those of an earlier calibration, tell before the prior, the waist being
/// free in trials.
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
  // Of the geometry: whether a compliance was excited, its loads say (see unsupported parameters).
  std::vector<int> geometric;
  for (int i : base.kept) {
    if (IsElastic(result.model.parameters[i].kind)) continue;
    if (std::binary_search(fitted.begin(), fitted.end(), i)) geometric.push_back(i);
  }
  return AssessExcitation(factor, geometric, recording.posture_count(), result.marker_sd);
}

/// The error of the waist by model, on trials for validation where there are any, else on those of
/// the estimate.
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

/// Where the root link's frame is; the rigid model is displaced as the full one.
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

/// Ten for a table of postures, unless it is very large; of few postures one each.
int UsualFolds(const Recording& recording) {
  if (!recording.trials.empty() || recording.posture_count() > 2000) return 0;
  const int folds = FoldsFor(recording, 10);
  return folds < 2 ? 0 : folds;
}

/// Joints that move markers and stood still in all postures, in a sentence; empty if there are
/// none.
std::string StillJoints(const ErrorModel& model, const Recording& recording) {
  constexpr double kStill = 1e-3;  // rad or m
  std::set<int> moving;
  for (const int k : model.active_joints) {
    for (const Drive& drive : DrivesOf(model.tree.joints[Size(k)])) moving.insert(drive.coordinate);
  }
  const auto& unknown = recording.joints_not_recorded;
  std::vector<std::string> still;
  for (const int c : moving) {
    const std::string& name = model.tree.joints[Size(model.tree.coordinate_joint[Size(c)])].name;
    const double range = recording.q.col(c).maxCoeff() - recording.q.col(c).minCoeff();
    if (range < kStill && std::count(unknown.begin(), unknown.end(), name) == 0) {
      still.push_back(name);
    }
  }
  if (still.empty() || recording.posture_count() < 2) return "";
  return fmt::format(
      "{} stood still in all postures: what its motion would show is not known, and no error given "
      "here holds where it moves",
      fmt::join(still, ", "));
}

void Append(const std::vector<std::string>& more, std::vector<std::string>& warnings) {
  warnings.insert(warnings.end(), more.begin(), more.end());
}

}  // namespace

CalibrationRun CalibrateExperiment(const Project& given,
                                   const std::vector<std::filesystem::path>& recordings,
                                   const ExperimentOptions& options) {
  Project project = given;
  const CalibrationOptions& settings = project.calibration;
  CalibrationRun run;

  // Section 5.1, the measurements y^. Markers and the robot's log pass the same low-pass filter,
  // get one clock, and are reduced to the samples at which the markers are stable: for every marker
  // of a posture the same ones, so that none weighs more. The trials of all chains are joined.
  Measurements measured = ReadMeasurements(project, recordings);
  run.undone = AcceptMistakes(project, options.accept, measured);

  // Not in the paper: what is plainly wrong is named, and nothing is chosen or judged by it.
  run.faults = FindPlainMistakes(project, measured.calibration);
  const bool sound = run.faults.empty();

  if (!sound) {
    project.elasticity.extra.clear();
  } else if (options.prior.empty()) {
    ModelChoice choice =
        ChooseModel(measured, options.seed, kElasticityFolds, options.threads, project);
    run.elasticity = std::move(choice.elasticity);
    run.causes = std::move(choice.causes);
    if (choice.misses_springs) {
      run.warnings.push_back(DescribeForbiddenSprings(project.elasticity.extra));
    }
    if (measured.calibration.trials.empty() && !HasMasses(project.tree)) {
      run.warnings.emplace_back(
          "the robot description has no masses: it is not known whether joints give way under "
          "loads");
    }
  } else {
    // Not in the paper: an earlier calibration tells both, and is the prior of the estimates.
    Append(StartFromEarlier(options.prior, options.days, measured, options.seed, project),
           run.warnings);
  }
  run.extra = project.elasticity.extra;

  // Section 2, the model y(delta). Markers seen from the waist (eq. 2 and 3), on joints and legs
  // that give way under their loads (eq. 5 and 6): delta is eq. 7. A QR decomposition of the
  // regressor (eq. 4) over random postures tells which of it can be identified (section 2.1).
  const Measurements as_recorded = measured;
  RecordedModel robot = MakeRecordedModel(project, options.seed, measured);
  const Recording& recording = measured.calibration;
  CheckGauge(settings.gauge, robot.model, robot.base);
  const std::string still = StillJoints(robot.model, recording);
  if (!still.empty()) run.warnings.push_back(still);

  // Section 5, eq. 14. One least-squares problem over all samples: find the delta that minimises
  // |y^ - y(delta)|^2 while the pose F(q_i, delta) of the supporting foot stays what it was. Each
  // residual is weighed by its standard deviation, which follows from the residuals, and a prior
  // around the nominal robot takes the place of parameters held by hand.
  CalibrationResult calibrated =
      Calibrate(robot.model, recording, robot.base, ModelKinds(robot.model).back(), settings);

  // Section 6.1.4. Simpler models (not calibrated, geometric) on the same data.
  run.comparison = CompareModels(std::move(calibrated), robot.model, recording, robot.base,
                                 settings, OfStep(options.progress, "fit"));

  if (sound) {
    run.faults = FindFaults(project, options.seed, as_recorded, robot, recording, run.comparison);
  }

  if (run.faults.empty()) {
    for (const CoarsePositions& one :
         FindCoarsePositions(run.comparison.largest(), recording, settings, as_recorded.trials)) {
      run.warnings.push_back(Describe(one, project.tree));
    }
    if (const auto loose = FindScatteredPositions(run.comparison.largest(), recording, settings)) {
      run.warnings.push_back(Describe(*loose, project.tree));
    }
  }
  run.common_scale = EstimateCommonScale(run.comparison.largest(), settings);
  if (run.faults.empty() && run.common_scale && IsDoubtful(*run.common_scale) &&
      !ScaleIsKnown(as_recorded.trials)) {
    run.warnings.push_back(DescribeDoubt(*run.common_scale));
  }

  // Eq. 12: how well the recorded postures tell the parameters apart.
  run.excitation = ExcitationOf(run.comparison.largest(), robot.base, recording, settings.earlier);

  // Section 6.1.4, Table 2: errors on postures and on motions that took no part in the estimate.
  const int folds = sound ? options.folds.value_or(UsualFolds(recording)) : 0;
  if (folds > 0) {
    ExperimentData data{project, as_recorded.calibration, options.seed, {}};
    if (!run.elasticity.empty()) {
      data.open_elasticity = project.elasticity;
      data.open_elasticity->torsion = given.elasticity.torsion;
      data.open_elasticity->bending = given.elasticity.bending;
    }
    try {
      run.cross_validation = CrossValidateExperiment(data, robot, run.comparison,
                                                     {.folds = folds,
                                                      .unit = options.fold_unit,
                                                      .seed = options.seed.value_or(1),
                                                      .threads = options.threads},
                                                     OfStep(options.progress, "cross-validation"));
      run.decided_once = DecidedOnce(data, run.causes.has_value() && !run.extra.empty());
    } catch (const InputError& error) {  // a fold has fewer equations than unknowns
      if (options.folds) throw;
      run.warnings.push_back(std::string("not cross-validated: ") + error.what());
    }
  }
  if (!options.prior.empty() && run.cross_validation.folds > 0) {
    const auto kind = static_cast<std::size_t>(run.comparison.largest_kind());
    const std::string worse = DescribeWorseUpdate(options.prior, robot, recording, settings,
                                                  run.cross_validation.metrics[kind].rmse_3d);
    if (!worse.empty()) run.warnings.push_back(worse);
  }
  const RepeatedTrials repeated = FindRepeatedTrials(measured);
  Append(repeated.estimated_twice, run.warnings);
  Append(repeated.judged_by_estimated, run.faults);
  if (measured.validation.posture_count() > 0) {
    const auto judge = [&] {
      run.held_out = JudgeOnTrials(run.comparison, measured.validation, settings);
    };
    judge();
    std::string left_out;
    while (!(left_out = LeaveOutBriefExchange(project, recording, run.comparison,
                                              run.held_out->table, measured.validation))
                .empty()) {
      run.warnings.push_back(left_out);
      judge();
    }
    if (run.faults.empty()) {
      run.faults = FindContradictions(project, robot, recording, measured.validation,
                                      run.comparison, run.held_out->table);
    }
  }
  // Whether all this can be trusted, as a rigid URDF and with its elasticity; if so, the robot
  // description with delta in it.
  run.deployment = ChooseDeployment(run.comparison, run.cross_validation,
                                    run.held_out ? &run.held_out->table : nullptr);
  run.verdict = Judge(run.comparison, run.cross_validation, run.excitation, recording, settings);
  const double expected_error = ExpectedError(robot.model, recording, settings.prior);
  JudgeDeployment(run.deployment, expected_error, run.verdict);
  if (run.faults.empty()) {  // else these say why
    const CalibrationResult& fit = run.comparison.largest();
    JudgePostures(Predict(fit.model, fit.delta, recording, settings).distances, fit.used, recording,
                  expected_error, run.verdict);
  }
  if (run.held_out) {
    JudgeHeldOut(run.held_out->table, run.comparison.largest_kind(), run.deployment.urdf_kind,
                 run.verdict);
  }
  // Not in the paper: no measurement tells where the waist's frame is on the robot.
  GiveGauge(settings, run.comparison);
  run.waist_error = WaistErrors(run.comparison, measured, settings);
  run.verdict.objections.insert(run.verdict.objections.begin(), run.faults.begin(),
                                run.faults.end());
  run.coverage = FindCoverage(project, measured);
  const bool whole = std::all_of(run.coverage.begin(), run.coverage.end(), [](const auto& of) {
    return of.calibrated || of.refused.empty();
  });
  if (whole) {  // else the chain's objection says so
    Append(UnknownStance(project, measured), run.verdict.objections);
  }
  JudgeCoverage(run.coverage, run.verdict);
  Append(measured.warnings, run.warnings);
  for (const std::string& what : run.undone) run.warnings.push_back(DescribeUndone(what));
  Append(run.verdict.remarks, run.warnings);
  if (!run.extra.empty()) run.warnings.push_back(NotApplied(run.extra, false));
  run.zero_offsets = options.zero_offsets;
  if (run.deployable()) {
    run.urdf = MakeCalibratedUrdf(
        ReadFile(project.urdf), project.urdf.string(),
        run.comparison.results[static_cast<int>(run.deployment.urdf_kind)], options.zero_offsets);
    Append(run.urdf->warnings, run.warnings);
  }

  run.recording = std::move(measured.calibration);
  run.validation = std::move(measured.validation);
  run.trials = std::move(measured.trials);
  run.base = std::move(robot.base);
  run.knocks = std::move(robot.knocks);
  return run;
}

std::string RunStatus(const CalibrationRun& run) {
  const Termination termination = run.comparison.largest().termination;
  const bool implausible = termination == Termination::kConverged && !run.deployable();
  return implausible ? "implausible" : TerminationName(termination);
}

}  // namespace elastocal
