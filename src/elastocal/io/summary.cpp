#include "elastocal/io/summary.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "elastocal/io/text.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no infinity or NaN: null.
Json Finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

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
  for (const Outlier& outlier : run.comparison.best().outliers) {
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
  const auto& parameters = run.comparison.best().model.parameters;
  json["hardly_excited"] = Json::array();
  for (int i : HardlyExcited(parameters, run.base.kept, excitation)) {
    json["hardly_excited"].push_back(parameters[i].name);
  }
  return json;
}

}  // namespace

std::string DescribeObservation(const Recording& recording, int posture, int marker) {
  std::string text = "posture " + std::to_string(posture + 1);
  if (!recording.line.empty()) text += " (line " + std::to_string(recording.line[posture]) + ")";
  return text + ", marker " + recording.marker_names[marker];
}

std::string RunStatus(const CalibrationRun& run) {
  const Termination termination = run.comparison.best().termination;
  const bool implausible =
      termination == Termination::kConverged && !run.verdict.objections.empty();
  return implausible ? "implausible" : TerminationName(termination);
}

std::string MakeCovarianceCsv(const CalibrationResult& result) {
  const std::vector<int>& parameters = result.posterior.parameters;
  std::string text = "parameter";
  for (int i : parameters) text += "," + result.model.parameters[i].name;
  text += "\n";
  for (std::size_t row = 0; row < parameters.size(); ++row) {
    text += result.model.parameters[parameters[row]].name;
    for (std::size_t column = 0; column < parameters.size(); ++column) {
      text += "," + FormatNumber(result.posterior.covariance(static_cast<Eigen::Index>(row),
                                                             static_cast<Eigen::Index>(column)));
    }
    text += "\n";
  }
  return text;
}

std::string MakeSummaryJson(const CalibrationRun& run) {
  const CalibrationResult& result = run.comparison.best();
  Json json;
  json["status"] = RunStatus(run);
  json["message"] = result.message;
  json["settled"] = result.settled;
  json["objections"] = run.verdict.objections;
  json["remarks"] = run.verdict.remarks;
  json["robot"] = result.model.tree.name;
  json["recording"] = run.recording.source;
  json["postures"] = run.recording.posture_count();
  json["markers"] = run.recording.marker_count();
  json["parameters_total"] = result.model.parameter_count();
  json["identifiable"] = run.base.geometric_count;
  json["identifiable_theory"] = run.base.theoretical_count;
  json["equations"] = result.equations;
  json["marker_sd_mm"] = 1e3 * result.marker_sd;
  json["prior_scale"] = {{"angles", result.prior_scale.angles},
                         {"lengths", result.prior_scale.lengths}};
  json["effective_parameters"] = result.posterior.effective_parameters;
  json["rmse_3d_mm"] =
      FigureByModel(run.comparison.kinds, run.comparison.metrics, &ErrorMetrics::rmse_3d);
  json["rmse_coordinate_mm"] =
      FigureByModel(run.comparison.kinds, run.comparison.metrics, &ErrorMetrics::rmse_coordinate);
  json["max_mm"] =
      FigureByModel(run.comparison.kinds, run.comparison.metrics, &ErrorMetrics::maximum);
  json["rmse_3d_mm_with_outliers"] =
      FigureByModel(run.comparison.kinds, run.comparison.metrics_all, &ErrorMetrics::rmse_3d);
  if (run.cross_validation.folds > 0) {
    const ByModel<ErrorMetrics>& metrics = run.cross_validation.metrics;
    json["kfold"]["folds"] = run.cross_validation.folds;
    json["kfold"]["rmse_3d_mm"] =
        FigureByModel(run.comparison.kinds, metrics, &ErrorMetrics::rmse_3d);
    json["kfold"]["rmse_coordinate_mm"] =
        FigureByModel(run.comparison.kinds, metrics, &ErrorMetrics::rmse_coordinate);
    json["kfold"]["max_mm"] = FigureByModel(run.comparison.kinds, metrics, &ErrorMetrics::maximum);
    json["kfold"]["unconverged"] = run.cross_validation.unconverged;
    json["kfold"]["not_predicted"] = run.cross_validation.not_predicted;
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
