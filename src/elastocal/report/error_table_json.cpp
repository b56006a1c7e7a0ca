// SPDX-License-Identifier: Apache-2.0
#include "elastocal/report/error_table_json.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no infinity or NaN: null.
Json InMillimetres(double metres) {
  return std::isfinite(metres) ? Json(1e3 * metres) : Json(nullptr);
}

Json MetricsJson(const std::map<ModelKind, ErrorMetrics>& all) {
  Json json;
  for (const auto& [kind, metrics] : all) {
    const bool known = metrics.observations > 0;
    json["observations"] = metrics.observations;
    json["rmse_3d_mm"][ModelKindName(kind)] = InMillimetres(metrics.rmse_3d);
    json["rmse_coordinate_mm"][ModelKindName(kind)] = InMillimetres(metrics.rmse_coordinate);
    json["max_mm"][ModelKindName(kind)] = known ? InMillimetres(metrics.maximum) : Json(nullptr);
  }
  return json;
}

Json RowJson(const ErrorTableRow& row) {
  Json json{{"chain", row.group}, {"trials", row.trials}};
  json.update(MetricsJson(row.metrics));
  return json;
}

}  // namespace

const char* ErrorTableCase(TrialKind kind) {
  switch (kind) {
    case TrialKind::kSine:
      return "SW";
    case TrialKind::kRandom:
      return "RP";
    case TrialKind::kRepeatability:
      return "RM";
    default:
      return "calibration";
  }
}

nlohmann::ordered_json MakeErrorTableJson(const ErrorTable& table) {
  Json json;
  json["rows"] = Json::array();
  for (const ErrorTableRow& row : table.rows) {
    Json item = RowJson(row);
    item["case"] = ErrorTableCase(row.kind);
    json["rows"].push_back(item);
  }
  json["chains"] = Json::array();
  for (const ErrorTableRow& row : table.groups) json["chains"].push_back(RowJson(row));
  json["trials"] = Json::array();
  for (const TrialErrors& trial : table.trials) {
    Json item{{"trial", trial.trial}, {"chain", trial.group}, {"case", ErrorTableCase(trial.kind)}};
    item.update(MetricsJson(trial.metrics));
    json["trials"].push_back(item);
  }
  json["mean_rmse_3d_mm"] = Json::object();
  for (const auto& [kind, value] : table.mean_rmse_3d) {
    json["mean_rmse_3d_mm"][ModelKindName(kind)] = InMillimetres(value);
  }
  return json;
}

}  // namespace elastocal
