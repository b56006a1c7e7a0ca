#include "elastocal/io/summary.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;
using Metrics = std::array<ErrorMetrics, 3>;

/// JSON has no infinity or NaN: null.
Json Finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json ByModel(const Metrics& metrics, double ErrorMetrics::*figure) {
  Json json;
  for (ModelKind kind : kModelKinds) {
    json[ModelKindName(kind)] = Finite(1e3 * metrics[static_cast<int>(kind)].*figure);
  }
  return json;
}

Json Outliers(const CalibrationRun& run) {
  Json json = Json::array();
  for (const Outlier& outlier : run.comparison.geometric().outliers) {
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
    item["unit"] = parameter.unit == ParameterUnit::kRadian ? "rad" : "m";
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
  return json;
}

}  // namespace

std::string DescribeObservation(const Recording& recording, int posture, int marker) {
  std::string text = "posture " + std::to_string(posture + 1);
  if (!recording.line.empty()) text += " (line " + std::to_string(recording.line[posture]) + ")";
  return text + ", marker " + recording.marker_names[marker];
}

std::string MakeSummaryJson(const CalibrationRun& run) {
  const CalibrationResult& result = run.comparison.geometric();
  Json json;
  json["status"] = TerminationName(result.termination);
  json["message"] = result.message;
  json["robot"] = result.model.tree.name;
  json["recording"] = run.recording.source;
  json["postures"] = run.recording.posture_count();
  json["markers"] = run.recording.marker_count();
  json["parameters_total"] = result.model.parameter_count();
  json["identifiable"] = run.base.kept.size();
  json["identifiable_theory"] = run.base.theoretical_count;
  json["equations"] = result.equations;
  json["marker_sd_mm"] = 1e3 * result.marker_sd;
  json["prior_scale"] = {{"angles", result.prior_scale.angles},
                         {"lengths", result.prior_scale.lengths}};
  json["effective_parameters"] = result.posterior.effective_parameters;
  json["rmse_3d_mm"] = ByModel(run.comparison.metrics, &ErrorMetrics::rmse_3d);
  json["rmse_coordinate_mm"] = ByModel(run.comparison.metrics, &ErrorMetrics::rmse_coordinate);
  json["max_mm"] = ByModel(run.comparison.metrics, &ErrorMetrics::maximum);
  json["rmse_3d_mm_with_outliers"] = ByModel(run.comparison.metrics_all, &ErrorMetrics::rmse_3d);
  if (run.cross_validation.folds > 0) {
    const Metrics& metrics = run.cross_validation.metrics;
    json["kfold"]["folds"] = run.cross_validation.folds;
    json["kfold"]["rmse_3d_mm"] = ByModel(metrics, &ErrorMetrics::rmse_3d);
    json["kfold"]["rmse_coordinate_mm"] = ByModel(metrics, &ErrorMetrics::rmse_coordinate);
    json["kfold"]["max_mm"] = ByModel(metrics, &ErrorMetrics::maximum);
  }
  json["outliers"] = Outliers(run);
  json["excitation"] = ExcitationJson(run);
  json["iterations"] = result.iterations;
  json["initial_cost"] = result.initial_cost;
  json["final_cost"] = result.final_cost;
  json["solve_seconds"] = result.solve_seconds;
  json["warnings"] = run.warnings;
  json["correlations"] = Correlations(result);
  json["parameters"] = Parameters(result);
  return json.dump(2) + "\n";
}

}  // namespace elastocal
