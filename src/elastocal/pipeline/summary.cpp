// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/summary.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "elastocal/pipeline/cause_picture_json.hpp"
#include "elastocal/pipeline/choose_causes.hpp"
#include "elastocal/pipeline/diagnose.hpp"
#include "elastocal/pipeline/limbs_json.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

Json FigureByModel(const std::vector<ModelKind>& kinds, const ByModel<ErrorMetrics>& metrics,
                   double ErrorMetrics::*figure) {
  Json json;
  for (ModelKind kind : kinds) {
    json[ModelKindName(kind)] = Finite(1e3 * metrics[static_cast<int>(kind)].*figure);
  }
  return json;
}

Json Outliers(const CalibrationRun& run) {
  Json json = Json::array();
  for (const Outlier& outlier : run.comparison.largest().outliers) {
    Json item;
    item["posture"] = outlier.posture;
    if (!run.recording.line.empty()) item["line"] = run.recording.line[outlier.posture];
    item["marker"] = run.recording.marker_names[outlier.marker];
    item["residual_mm"] = 1e3 * outlier.residual;
    item["normalised"] = outlier.normalised;
    json.push_back(item);
  }
  return json;
}

Json Parameters(const CalibrationResult& result) {
  Json json = Json::array();
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    const Parameter& parameter = result.model.parameters[i];
    Json item;
    item["name"] = parameter.name;
    item["unit"] = UnitName(parameter.unit);
    item["value"] = result.delta[i];
    item["sd"] = Finite(result.sd[i]);
    item["status"] = StatusName(result.status[i]);
    item["significant"] = Significant(result, i);
    json.push_back(item);
  }
  return json;
}

Json Correlations(const CalibrationResult& result) {
  Json json = Json::array();
  for (const Correlation& pair : result.correlations) {
    json.push_back({{"first", result.model.parameters[pair.first].name},
                    {"second", result.model.parameters[pair.second].name},
                    {"coefficient", pair.coefficient}});
  }
  return json;
}

Json ExcitationJson(const CalibrationRun& run) {
  const Excitation& excitation = run.excitation;
  Json json;
  json["condition_all"] = Finite(excitation.condition_all);
  json["condition_base"] = Finite(excitation.condition_base);
  json["O1"] = excitation.indices.o1;
  json["O2"] = excitation.indices.o2;
  json["O3"] = excitation.indices.o3;
  json["O4"] = excitation.indices.o4;
  json["O5"] = excitation.indices.o5;
  const auto& parameters = run.comparison.largest().model.parameters;
  json["hardly_excited"] = Json::array();
  for (int i : HardlyExcited(parameters, excitation)) {
    json["hardly_excited"].push_back(parameters[i].name);
  }
  return json;
}

Json ClockJson(const TrialSummary& trial) {
  return {{"lag_s", Finite(trial.clock.lag_s)},
          {"drift_ppm", trial.clock.drift_estimated ? Finite(trial.clock.drift_ppm) : Json()},
          {"sd_s", Finite(trial.clock.sd_s)},
          {"reliable", trial.clock.state == ClockState::kReliable}};
}

Json CoverageJson(const CalibrationRun& run) {
  Json json = Json::array();
  for (const ChainCoverage& chain : run.coverage) {
    json.push_back({{"chain", chain.chain},
                    {"calibrated", chain.calibrated},
                    {"judged", chain.judged},
                    {"refused", chain.refused}});
  }
  return json;
}

/// Adds the trials, the clock of the first trial whose drift is known (else of the first), and the
/// samples of all trials for calibration.
void AddTrials(const CalibrationRun& run, Json& json) {
  int samples = 0;
  json["trials"] = Json::array();
  for (const TrialSummary& trial : run.trials) {
    const bool calibration = trial.trial.kind == TrialKind::kCalibration;
    if (calibration) samples += trial.samples;
    json["trials"].push_back({{"name", trial.trial.name},
                              {"chains", trial.trial.chains},
                              {"used", trial.refused.empty()},
                              {"postures", trial.postures},
                              {"samples", trial.samples},
                              {"clock", ClockJson(trial)},
                              {"findings", Findings(trial)}});
    if (trial.scale) {
      json["trials"].back()["camera_scale"] = {{"value", 1.0 + trial.scale->size},
                                               {"sd", trial.scale->sd}};
    }
    const bool better = !json.contains("clock") ||
                        (json["clock"]["drift_ppm"].is_null() && trial.clock.drift_estimated);
    if (calibration && trial.refused.empty() && better) json["clock"] = ClockJson(trial);
  }
  json["samples"] = samples;
}

/// Adds errors on the trials for validation.
void AddHeldOut(const CalibrationRun& run, Json& json) {
  if (!run.held_out) return;
  for (const ErrorTableRow& row : run.held_out->table.groups) {
    for (const auto& [kind, metrics] : row.metrics) {
      json["held_out"][row.group]["rmse_3d_mm"][ModelKindName(kind)] =
          Finite(1e3 * metrics.rmse_3d);
      json["held_out"][row.group]["max_mm"][ModelKindName(kind)] = Finite(1e3 * metrics.maximum);
    }
  }
  for (const auto& [kind, mean] : run.held_out->table.mean_rmse_3d) {
    json["held_out_rmse_3d_mm"][ModelKindName(kind)] = Finite(1e3 * mean);
  }
}

/// Adds errors of the waist, where a simulation's truth is beside the recording.
void AddWaistErrors(const CalibrationRun& run, Json& json) {
  for (ModelKind kind : run.comparison.kinds) {
    const double error = run.waist_error[static_cast<int>(kind)];
    if (std::isfinite(error)) json["waist_error_mm"][ModelKindName(kind)] = 1e3 * error;
  }
}

/// Adds the legs, and feet and clusters that moved although they should not.
void AddStance(const CalibrationRun& run, Json& json) {
  const CalibrationResult& result = run.comparison.largest();
  const Json legs = LegsJson(run);
  if (!legs.empty()) json["legs"] = legs;
  if (!run.soles.empty()) json["soles"] = SolesJson(run);
  json["loose_footings"] = Json::array();
  for (const LooseFooting& footing : result.loose_footings) {
    json["loose_footings"].push_back({{"posture", footing.posture},
                                      {"distance_mm", 1e3 * footing.distance},
                                      {"normalised", footing.normalised}});
  }
  json["slips"] = Json::array();
  for (const Slip& slip : result.slips) {
    json["slips"].push_back({{"posture", slip.posture}, {"distance_mm", 1e3 * slip.distance}});
  }
  json["knocks"] = Json::array();
  for (const Knock& knock : run.knocks) {
    json["knocks"].push_back({{"cluster", knock.cluster},
                              {"last_before", knock.last_before},
                              {"posture", knock.posture},
                              {"distance_mm", 1e3 * knock.distance}});
  }
}

/// What a user deploys, and its error on data that were not used for it.
Json DeploymentJson(const CalibrationRun& run) {
  const Deployment& deployment = run.deployment;
  const auto artefact = [&](double rmse, const std::optional<RmseInterval>& interval) {
    Json of{{"rmse_3d_mm", Finite(1e3 * rmse)},
            {"uncalibrated", Finite(1e3 * deployment.uncalibrated)}};
    if (interval) of["interval_95_mm"] = {1e3 * interval->low, 1e3 * interval->high};
    return of;
  };
  Json json;
  json["judged_on"] = deployment.judged_on;
  json["urdf"] = artefact(deployment.urdf, deployment.urdf_interval);
  json["urdf"]["model"] = ModelKindName(deployment.urdf_kind);
  json["compensated"] = artefact(deployment.compensated, deployment.compensated_interval);
  const std::vector<std::string> never = NeverApplied(run.extra);
  if (!never.empty()) json["compensated"]["not_exported"] = never;
  return json;
}

Json ElasticityJson(const std::vector<ElasticityTrial>& tried) {
  Json json = Json::array();
  for (const ElasticityTrial& trial : tried) {
    json.push_back({{"kinds", trial.kinds},
                    {"rmse_3d_mm", Finite(1e3 * trial.rmse_3d)},
                    {"gain_mm", 1e3 * trial.gain},
                    {"gain_sd_mm", 1e3 * trial.gain_sd},
                    {"chosen", trial.chosen}});
  }
  return json;
}

/// Name of the first link of a body.
std::string LinkOfBody(const RobotTree& tree, int body) {
  const auto link = std::find_if(tree.links.begin(), tree.links.end(),
                                 [&](const Link& of) { return of.body == body; });
  return link == tree.links.end() ? "" : link->name;
}

Json ShortModels(const CalibrationRun& run) {
  Json json = Json::array();
  const CalibrationResult& result = run.comparison.largest();
  for (const ShortModel& body : result.short_models) {
    Json item;
    item["posture"] = body.posture;
    if (!run.recording.line.empty()) item["line"] = run.recording.line[body.posture];
    item["body"] = LinkOfBody(result.model.tree, body.body);
    item["residual_mm"] = 1e3 * body.distance;
    item["normalised"] = body.normalised;
    item["weight"] = body.weight;
    json.push_back(item);
  }
  return json;
}

/// Adds whether and for what the result may be used.
void AddOutcome(const CalibrationRun& run, Json& json) {
  const CalibrationResult& result = run.comparison.largest();
  json["status"] = RunStatus(run);
  json["message"] = result.message;
  json["settled"] = result.settled;
  json["deployed"] = DeploymentJson(run);
  json["objections"] = run.verdict.objections;
  json["chains"] = CoverageJson(run);
  json["remarks"] = run.verdict.remarks;
}

/// Adds what was measured, and how many parameters it can tell.
void AddProblem(const CalibrationRun& run, Json& json) {
  const CalibrationResult& result = run.comparison.largest();
  json["robot"] = result.model.tree.name;
  json["recording"] = run.recording.source;
  json["postures"] = run.recording.posture_count();
  json["markers"] = run.recording.marker_count();
  json["parameters_total"] = result.model.parameter_count();
  json["identifiable"] = run.base.geometric_count;
  json["identifiable_theory"] = run.base.theoretical_count;
  json["equations"] = result.equations;
}

Json PriorScaleJson(const CalibrationResult& result) {
  Json json;
  for (int g = 0; g < kPriorGroupCount; ++g) {
    const bool corrections = g == static_cast<int>(PriorGroup::kCorrections);
    if (corrections && result.model.elasticity.corrections.empty()) continue;
    json[PriorGroupName(static_cast<PriorGroup>(g))] = result.prior_scale.factor[g];
  }
  return json;
}

/// Noise of one group of postures. The waist has none where it does not move.
Json NoiseJson(const Noise& noise, std::size_t group, bool waist_moves) {
  Json json;
  for (int source = 0; source < kNoiseSourceCount; ++source) {
    const std::string name = NoiseSourceName(static_cast<NoiseSource>(source));
    if (name.starts_with("waist") && !waist_moves) continue;
    const bool angle = name.ends_with("rotation");
    json[name + (angle ? "_sd_mrad" : "_sd_mm")] =
        1e3 * noise.sd(static_cast<Eigen::Index>(group), source);
  }
  if (group < noise.motion.size()) {
    const MotionCorrelation& motion = noise.motion[group];
    json["motion_correlation"] = motion.bodies.lag_one;
    json["motion_samples_each"] = motion.bodies.samples_each;
    json["waist_motion_correlation"] = motion.waist.lag_one;
    json["waist_motion_samples_each"] = motion.waist.samples_each;
  }
  return json;
}

/// Adds the noise and what else weights the observations.
void AddStatistics(const CalibrationRun& run, Json& json) {
  const CalibrationResult& result = run.comparison.largest();
  json["marker_sd_mm"] = 1e3 * result.marker_sd;
  json["prior_scale"] = PriorScaleJson(result);
  for (std::size_t g = 0; g < static_cast<std::size_t>(result.noise.group_count()); ++g) {
    json["noise"].push_back(NoiseJson(result.noise, g, !run.trials.empty()));
  }
  json["cluster_factor"] = result.posterior.cluster_factor;
  json["gauge"] = GaugeText(result.gauge);
  if (run.common_scale) {
    json["common_scale"] = {{"size", run.common_scale->size},
                            {"sd", run.common_scale->sd},
                            {"degrees_of_freedom", run.common_scale->degrees_of_freedom},
                            {"of_one_length", run.common_scale->of_one_length}};
  }
  json["effective_parameters"] = result.posterior.effective_parameters;
}

/// Adds errors in the fit and by folds.
void AddErrors(const CalibrationRun& run, Json& json) {
  const auto figure = [&](const ByModel<ErrorMetrics>& metrics, double ErrorMetrics::*of) {
    return FigureByModel(run.comparison.kinds, metrics, of);
  };
  const ByModel<ErrorMetrics>& fit = run.comparison.metrics;
  json["rmse_3d_mm"] = figure(fit, &ErrorMetrics::rmse_3d);
  json["rmse_coordinate_mm"] = figure(fit, &ErrorMetrics::rmse_coordinate);
  json["max_mm"] = figure(fit, &ErrorMetrics::maximum);
  json["rmse_3d_mm_with_outliers"] = figure(run.comparison.metrics_all, &ErrorMetrics::rmse_3d);
  const CrossValidation& folds = run.cross_validation;
  if (folds.folds == 0) return;
  json["kfold"] = {{"folds", folds.folds},
                   {"rmse_3d_mm", figure(folds.metrics, &ErrorMetrics::rmse_3d)},
                   {"rmse_coordinate_mm", figure(folds.metrics, &ErrorMetrics::rmse_coordinate)},
                   {"max_mm", figure(folds.metrics, &ErrorMetrics::maximum)},
                   {"rmse_3d_mm_without_outliers",
                    figure(folds.metrics_without_outliers, &ErrorMetrics::rmse_3d)},
                   {"unconverged", folds.unconverged},
                   {"not_predicted", folds.not_predicted},
                   {"decided_once", run.decided_once}};
}

/// Adds springs and causes that were chosen or searched for.
void AddChoices(const CalibrationRun& run, Json& json) {
  json["elasticity_tried"] = ElasticityJson(run.elasticity);
  if (!run.extra.empty()) json["extra"] = run.extra;
  if (run.causes) {
    json["diagnosis"] = DescribeDiagnosis(*run.causes);
    json["diagnosis_pictures"] = CausePicturesJson(*run.causes);
  }
}

void AddSolution(const CalibrationResult& result, Json& json) {
  json["iterations"] = result.iterations;
  json["initial_cost"] = result.initial_cost;
  json["final_cost"] = result.final_cost;
  json["solve_seconds"] = result.solve_seconds;
}

}  // namespace

std::string MakeSummaryJson(const CalibrationRun& run) {
  const CalibrationResult& result = run.comparison.largest();
  Json json;
  AddOutcome(run, json);
  AddProblem(run, json);
  AddStatistics(run, json);
  AddErrors(run, json);
  json["frames"] = FramesJson(run);
  json["nominal_places"] = NominalPlacesJson(result);
  if (!run.trials.empty()) {
    AddTrials(run, json);
    AddHeldOut(run, json);
    AddWaistErrors(run, json);
    AddStance(run, json);
  }
  json["outliers"] = Outliers(run);
  json["short_models"] = ShortModels(run);
  AddChoices(run, json);
  json["excitation"] = ExcitationJson(run);
  AddSolution(result, json);
  json["warnings"] = run.warnings;
  json["correlations"] = Correlations(result);
  json["parameters"] = Parameters(result);
  return JsonText(json);
}

}  // namespace elastocal
