// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/error_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace elastocal {
namespace {

/// Metrics over both sets of observations. Those of single markers are left out, because markers
/// may differ between trials.
ErrorMetrics Pooled(const ErrorMetrics& a, const ErrorMetrics& b) {
  const auto squares = [](const ErrorMetrics& metrics) {
    return metrics.observations > 0 ? metrics.observations * std::pow(metrics.rmse_3d, 2) : 0.0;
  };
  ErrorMetrics pooled;
  pooled.observations = a.observations + b.observations;
  pooled.rmse_3d = pooled.observations > 0
                       ? std::sqrt((squares(a) + squares(b)) / pooled.observations)
                       : std::numeric_limits<double>::quiet_NaN();
  pooled.rmse_coordinate = pooled.rmse_3d / std::sqrt(3.0);
  pooled.maximum = std::fmax(a.maximum, b.maximum);  // NaN where nothing was counted
  return pooled;
}

void AddTrial(const TrialErrors& trial, ErrorTableRow& row) {
  if (++row.trials == 1) {
    row.metrics = trial.metrics;
    for (auto& [kind, metrics] : row.metrics) metrics.marker_rmse_3d.resize(0);
    return;
  }
  std::erase_if(row.metrics, [&](const auto& one) { return !trial.metrics.contains(one.first); });
  for (auto& [kind, metrics] : row.metrics) metrics = Pooled(metrics, trial.metrics.at(kind));
}

template <typename Matches>
void AddTo(std::vector<ErrorTableRow>& rows, const TrialErrors& trial, Matches matches) {
  auto row = std::find_if(rows.begin(), rows.end(), matches);
  if (row == rows.end()) {
    row = rows.insert(rows.end(), {.group = trial.group, .kind = trial.kind, .metrics = {}});
  }
  AddTrial(trial, *row);
}

std::map<ModelKind, double> MeanOfRows(const std::vector<ErrorTableRow>& rows) {
  std::map<ModelKind, double> sum;
  int count = 0;
  for (const ErrorTableRow& row : rows) {
    if (row.metrics.empty() || row.metrics.begin()->second.observations == 0) continue;
    if (++count == 1) {
      for (const auto& [kind, metrics] : row.metrics) sum[kind] = 0.0;
    }
    std::erase_if(sum, [&](const auto& one) { return !row.metrics.contains(one.first); });
    for (auto& [kind, value] : sum) value += row.metrics.at(kind).rmse_3d;
  }
  for (auto& [kind, value] : sum) value /= count;
  return sum;
}

}  // namespace

TrialErrors ComputeTrialErrors(const TrialResiduals& residuals) {
  TrialErrors errors{.trial = residuals.trial,
                     .kind = residuals.kind,
                     .group = residuals.group,
                     .markers = residuals.markers,
                     .metrics = {}};
  if (residuals.distances.empty()) return errors;
  const Eigen::MatrixXd& first = residuals.distances.begin()->second;
  for (const int m : residuals.markers) {
    if (m < 0 || m >= first.cols()) throw std::invalid_argument("ComputeTrialErrors: no marker");
  }
  std::map<ModelKind, Eigen::MatrixXd> of_group;
  ObservationMask predicted = ObservationMask::Constant(
      first.rows(), static_cast<Eigen::Index>(residuals.markers.size()), true);
  for (const auto& [kind, distances] : residuals.distances) {
    if (distances.rows() != first.rows() || distances.cols() != first.cols()) {
      throw std::invalid_argument("ComputeTrialErrors: models of different sizes");
    }
    of_group[kind] = distances(Eigen::all, residuals.markers);
    predicted = predicted && of_group[kind].array().isFinite();
  }
  for (const auto& [kind, distances] : of_group) {
    errors.metrics[kind] = ComputeMetrics(distances, predicted);
  }
  return errors;
}

ErrorTable MakeErrorTable(std::vector<TrialErrors> trials) {
  ErrorTable table;
  table.trials = std::move(trials);
  for (const TrialErrors& trial : table.trials) {
    AddTo(table.groups, trial, [&](const ErrorTableRow& row) { return row.group == trial.group; });
    AddTo(table.rows, trial, [&](const ErrorTableRow& row) {
      return row.group == trial.group && row.kind == trial.kind;
    });
  }
  const auto position = [&](const ErrorTableRow& row) {
    const auto group = std::find_if(table.groups.begin(), table.groups.end(),
                                    [&](const auto& other) { return other.group == row.group; });
    return std::pair(group - table.groups.begin(), static_cast<int>(row.kind));
  };
  std::stable_sort(table.rows.begin(), table.rows.end(),
                   [&](const auto& a, const auto& b) { return position(a) < position(b); });
  table.mean_rmse_3d = MeanOfRows(table.rows);
  return table;
}

}  // namespace elastocal
