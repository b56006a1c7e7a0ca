// SPDX-License-Identifier: Apache-2.0
#include "elastocal/report/residual_figures.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "elastocal/report/encoding.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kBins = 50;
constexpr int kMostMoments = 400;
constexpr double kShownShare = 0.995;  // share of the distances of the worst model

using Mask = ObservationMask;

/// Distances of every model, with the observations that count, the same for all models.
struct Distances {
  const Recording& recording;
  const ByModel<Prediction>& predictions;
  Mask counts;
};

Distances Counted(const CalibrationView& view, const Recording& recording,
                  const ByModel<Prediction>& predictions, bool calibration) {
  Mask counts = Mask::Constant(recording.posture_count(), recording.marker_count(), true);
  if (calibration) counts = view.comparison.largest().used;
  for (const ModelKind kind : view.comparison.kinds) {
    counts = counts && predictions[static_cast<int>(kind)].distances.array().isFinite();
  }
  return {recording, predictions, counts};
}

Distances OfCalibration(const CalibrationView& view) {
  return Counted(view, view.recording, view.comparison.predictions, true);
}

Distances OfValidation(const CalibrationView& view) {
  return Counted(view, view.validation, view.held_out->predictions, false);
}

std::vector<double> Collect(const Distances& distances, ModelKind kind,
                            const std::set<int>& trials) {
  const Eigen::MatrixXd& values = distances.predictions[static_cast<int>(kind)].distances;
  std::vector<double> collected;
  for (int i = 0; i < values.rows(); ++i) {
    if (!trials.empty() && !trials.contains(distances.recording.trial[i])) continue;
    for (int m = 0; m < values.cols(); ++m) {
      if (distances.counts(i, m)) collected.push_back(values(i, m));
    }
  }
  return collected;
}

/// A bin width of one, two or five times a power of ten, with which kBins bins reach `end` or
/// nearly.
double NiceWidth(double end) {
  const double width = std::max(end, 1e-9) / kBins;
  const double decade = std::pow(10.0, std::floor(std::log10(width)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * decade >= width) return step * decade;
  }
  return 10.0 * decade;
}

Json Histogram(const std::string& name, const CalibrationView& view, const Distances& distances,
               const std::set<int>& trials) {
  double end = 0.0;
  std::vector<std::vector<double>> by_kind;
  for (const ModelKind kind : view.comparison.kinds) {
    by_kind.push_back(Collect(distances, kind, trials));
    std::vector<double>& values = by_kind.back();
    if (values.empty()) continue;
    const auto quantile =
        values.begin() +
        static_cast<std::ptrdiff_t>(kShownShare * (static_cast<double>(values.size()) - 1));
    std::nth_element(values.begin(), quantile, values.end());
    end = std::max(end, *quantile);
  }
  const double width = NiceWidth(end);
  const auto bins = std::max(1, static_cast<int>(std::ceil(end / width)));
  Json json = {{"name", name}, {"edges_mm", Json::array()}, {"counts", Json::object()}};
  for (int b = 0; b <= bins; ++b) json["edges_mm"].push_back(Rounded(1e3 * width * b));
  for (std::size_t k = 0; k < by_kind.size(); ++k) {
    std::vector<int> counts(static_cast<std::size_t>(bins));
    for (const double value : by_kind[k]) {
      ++counts[static_cast<std::size_t>(std::min(bins - 1, static_cast<int>(value / width)))];
    }
    json["counts"][ModelKindName(view.comparison.kinds[k])] = counts;
  }
  return json;
}

/// RMSE of the markers of a cluster by model, mm; empty where none of them is in the recording.
Json ClusterRmse(const ClusterView& cluster, const CalibrationView& view,
                 const Distances& distances) {
  Json json = Json::object();
  const std::vector<std::string>& names = distances.recording.marker_names;
  for (const ModelKind kind : view.comparison.kinds) {
    const Eigen::MatrixXd& values = distances.predictions[static_cast<int>(kind)].distances;
    double squares = 0.0;
    int count = 0;
    for (int m = 0; m < values.cols(); ++m) {
      if (std::find(cluster.markers.begin(), cluster.markers.end(), names[m]) ==
          cluster.markers.end()) {
        continue;
      }
      for (int i = 0; i < values.rows(); ++i) {
        if (!distances.counts(i, m)) continue;
        squares += values(i, m) * values(i, m);
        ++count;
      }
    }
    if (count > 0) json[ModelKindName(kind)] = Rounded(1e3 * std::sqrt(squares / count));
  }
  return json;
}

/// Root mean square of a row over the observations that count, mm; null if there is none.
Json RowRms(const Eigen::MatrixXd& distances, const Mask& counts, int row) {
  double squares = 0.0;
  int count = 0;
  for (int m = 0; m < distances.cols(); ++m) {
    if (!counts(row, m)) continue;
    squares += distances(row, m) * distances(row, m);
    ++count;
  }
  return count > 0 ? Json(Rounded(1e3 * std::sqrt(squares / count), 4)) : Json(nullptr);
}

Json Trace(const CalibrationView& view, const Distances& distances, int trial) {
  const Recording& recording = distances.recording;
  std::vector<int> rows;
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (recording.trial[i] == trial) rows.push_back(i);
  }
  const std::size_t step = (rows.size() + kMostMoments - 1) / kMostMoments;
  Json json = {{"trial", recording.trials[trial].name},
               {"kind", recording.trials[trial].of_motion() ? "sine" : "postures"},
               {"time_s", Json::array()},
               {"rms_mm", Json::object()}};
  for (std::size_t k = 0; k < rows.size(); k += step) {
    json["time_s"].push_back(Rounded(recording.time_s[rows[k]], 7));
    for (const ModelKind kind : {ModelKind::kUncalibrated, view.comparison.largest_kind()}) {
      json["rms_mm"][ModelKindName(kind)].push_back(RowRms(
          distances.predictions[static_cast<int>(kind)].distances, distances.counts, rows[k]));
    }
  }
  return json;
}

}  // namespace

nlohmann::ordered_json MakeDistributions(const CalibrationView& view) {
  Json json = Json::array();
  json.push_back(Histogram("calibration postures", view, OfCalibration(view), {}));
  if (view.held_out == nullptr) return json;
  const Distances held_out = OfValidation(view);
  std::vector<std::string> groups;
  std::map<std::string, std::set<int>> trials;
  for (const TrialErrors& errors : view.held_out->table.trials) {
    for (std::size_t t = 0; t < view.validation.trials.size(); ++t) {
      if (view.validation.trials[t].name != errors.trial) continue;
      if (!trials.contains(errors.group)) groups.push_back(errors.group);
      trials[errors.group].insert(static_cast<int>(t));
    }
  }
  for (const std::string& group : groups) {
    if (groups.size() > 1) json.push_back(Histogram(group, view, held_out, trials[group]));
  }
  json.push_back(Histogram("all held out", view, held_out, {}));
  return json;
}

nlohmann::ordered_json MakeClusters(const CalibrationView& view) {
  const Distances distances = view.held_out != nullptr ? OfValidation(view) : OfCalibration(view);
  Json json = Json::array();
  for (const ClusterView& cluster : view.clusters) {
    json.push_back({{"name", cluster.name},
                    {"link", cluster.link},
                    {"rmse_3d_mm", ClusterRmse(cluster, view, distances)}});
  }
  return json;
}

nlohmann::ordered_json MakeTraces(const CalibrationView& view) {
  Json json = Json::array();
  if (view.held_out == nullptr || view.validation.time_s.size() == 0) return json;
  const Distances distances = OfValidation(view);
  for (std::size_t t = 0; t < view.validation.trials.size(); ++t) {
    Json trace = Trace(view, distances, static_cast<int>(t));
    if (!trace["time_s"].empty()) json.push_back(std::move(trace));
  }
  return json;
}

}  // namespace elastocal
