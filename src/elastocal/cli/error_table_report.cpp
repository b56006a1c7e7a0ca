#include "elastocal/cli/error_table_report.hpp"

#include <cmath>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/cli/text_table.hpp"

namespace elastocal::cli {
namespace {

using Json = nlohmann::ordered_json;

/// As the paper calls the models; the one that it does not have by what it estimates.
const char* PaperName(ModelKind kind) {
  switch (kind) {
    case ModelKind::kUncalibrated:
      return "NCM";
    case ModelKind::kOffsetsOnly:
      return "offsets";
    case ModelKind::kGeometric:
      return "GCM";
    case ModelKind::kFull:
      return "FCM";
  }
  return "";
}

const char* CaseName(TrialKind kind) {
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

/// The models of a table, the one with most parameters first, as the paper has them.
std::vector<ModelKind> KindsOf(const ErrorTable& table) {
  std::set<ModelKind> kinds;
  for (const ErrorTableRow& row : table.rows) {
    for (const auto& entry : row.metrics) kinds.insert(entry.first);
  }
  return {kinds.rbegin(), kinds.rend()};
}

std::string Millimetres(double metres) {
  return std::isfinite(metres) ? fmt::format("{:.2f}", 1e3 * metres) : "-";
}

std::vector<std::string> Row(const ErrorTableRow& row, const std::string& name,
                             const std::vector<ModelKind>& kinds) {
  std::vector<std::string> cells = {row.group, name, std::to_string(row.trials)};
  std::vector<std::string> largest;
  int observations = 0;
  for (const ModelKind kind : kinds) {
    const auto metrics = row.metrics.find(kind);
    const bool known = metrics != row.metrics.end() && metrics->second.observations > 0;
    cells.push_back(known ? Millimetres(metrics->second.rmse_3d) : "-");
    largest.push_back(known ? Millimetres(metrics->second.maximum) : "-");
    if (known) observations = metrics->second.observations;
  }
  cells.insert(cells.end(), largest.begin(), largest.end());
  cells.push_back(std::to_string(observations));
  return cells;
}

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

std::string DescribeErrorTable(const ErrorTable& table) {
  const std::vector<ModelKind> kinds = KindsOf(table);
  std::vector<std::string> header = {"chain", "case", "trials"};
  for (const ModelKind kind : kinds) header.push_back(std::string(PaperName(kind)) + " RMSE mm");
  for (const ModelKind kind : kinds) header.push_back(std::string(PaperName(kind)) + " max mm");
  header.emplace_back("sightings");
  TextTable text(header);
  for (const ErrorTableRow& row : table.rows) text.Add(Row(row, CaseName(row.kind), kinds));
  for (const ErrorTableRow& row : table.groups) text.Add(Row(row, "all", kinds));
  std::vector<std::string> mean = {"mean of the cases", "", ""};
  for (const ModelKind kind : kinds) {
    const auto value = table.mean_rmse_3d.find(kind);
    mean.push_back(value == table.mean_rmse_3d.end() ? "-" : Millimetres(value->second));
  }
  text.Add(mean);
  return text.Render() +
         "  RMSE of distances (3-D); FCM full model, GCM geometric, NCM not calibrated;\n"
         "  SW sinusoidal motions, RP random postures, RM repeatability motion\n";
}

Json MakeErrorTableJson(const ErrorTable& table) {
  Json json;
  json["rows"] = Json::array();
  for (const ErrorTableRow& row : table.rows) {
    Json item = RowJson(row);
    item["case"] = CaseName(row.kind);
    json["rows"].push_back(item);
  }
  json["chains"] = Json::array();
  for (const ErrorTableRow& row : table.groups) json["chains"].push_back(RowJson(row));
  json["trials"] = Json::array();
  for (const TrialErrors& trial : table.trials) {
    Json item{{"trial", trial.trial}, {"chain", trial.group}, {"case", CaseName(trial.kind)}};
    item.update(MetricsJson(trial.metrics));
    json["trials"].push_back(item);
  }
  json["mean_rmse_3d_mm"] = Json::object();
  for (const auto& [kind, value] : table.mean_rmse_3d) {
    json["mean_rmse_3d_mm"][ModelKindName(kind)] = InMillimetres(value);
  }
  return json;
}

}  // namespace elastocal::cli
