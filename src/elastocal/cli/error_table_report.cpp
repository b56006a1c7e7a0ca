// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/error_table_report.hpp"

#include <cmath>
#include <set>

#include <fmt/format.h>

#include "elastocal/cli/figures.hpp"
#include "elastocal/cli/text_table.hpp"
#include "elastocal/report/error_table_json.hpp"

namespace elastocal::cli {
namespace {

/// Name of a model in the paper; for the model that the paper lacks, what it estimates.
const char* PaperName(ModelKind kind) {
  switch (kind) {
    case ModelKind::kUncalibrated:
      return "NCM";
    case ModelKind::kOffsetsOnly:
      return "offsets";
    case ModelKind::kGeometric:
      return "GCM";
    case ModelKind::kRigid:
      return "FCM rigid";
    case ModelKind::kFull:
      return "FCM";
  }
  return "";
}

/// The models of a table in the paper's order: the one with most parameters first.
std::vector<ModelKind> KindsOf(const ErrorTable& table) {
  std::set<ModelKind> kinds;
  for (const ErrorTableRow& row : table.rows) {
    for (const auto& entry : row.metrics) kinds.insert(entry.first);
  }
  return {kinds.rbegin(), kinds.rend()};
}

std::vector<std::string> Row(const ErrorTableRow& row, const std::string& name,
                             const std::vector<ModelKind>& kinds) {
  std::vector<std::string> cells = {row.group, name, std::to_string(row.trials)};
  std::vector<std::string> largest;
  int observations = 0;
  for (const ModelKind kind : kinds) {
    const auto metrics = row.metrics.find(kind);
    const bool known = metrics != row.metrics.end() && metrics->second.observations > 0;
    cells.push_back(known ? Millimetres(metrics->second.rmse_3d, 2) : "-");
    largest.push_back(known ? Millimetres(metrics->second.maximum, 2) : "-");
    if (known) observations = metrics->second.observations;
  }
  cells.insert(cells.end(), largest.begin(), largest.end());
  cells.push_back(std::to_string(observations));
  return cells;
}

}  // namespace

std::string DescribeErrorTable(const ErrorTable& table) {
  const std::vector<ModelKind> kinds = KindsOf(table);
  std::vector<std::string> header = {"chain", "case", "trials"};
  for (const ModelKind kind : kinds) header.push_back(std::string(PaperName(kind)) + " RMSE mm");
  for (const ModelKind kind : kinds) header.push_back(std::string(PaperName(kind)) + " max mm");
  header.emplace_back("sightings");
  TextTable text(header);
  for (const ErrorTableRow& row : table.rows) text.Add(Row(row, ErrorTableCase(row.kind), kinds));
  for (const ErrorTableRow& row : table.groups) text.Add(Row(row, "all", kinds));
  std::vector<std::string> mean = {"mean of the cases", "", ""};
  for (const ModelKind kind : kinds) {
    const auto value = table.mean_rmse_3d.find(kind);
    mean.push_back(value == table.mean_rmse_3d.end() ? "-" : Millimetres(value->second, 2));
  }
  text.Add(mean);
  return text.Render() +
         "  RMSE of distances (3-D); FCM full model, GCM geometric, NCM not calibrated;\n"
         "  SW sinusoidal motions, RP random postures, RM repeatability motion\n";
}

}  // namespace elastocal::cli
