// SPDX-License-Identifier: Apache-2.0
#include "elastocal/report/calibration_view.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "elastocal/report/encoding.hpp"
#include "elastocal/report/error_table_json.hpp"
#include "elastocal/report/residual_figures.hpp"
#include "elastocal/report/scenes.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostFrames = 6000;  // of a signal: a minute at 100 Hz
constexpr std::size_t kMostSignals = 8;

Json Point(const Eigen::Vector3d& point) { return {point.x(), point.y(), point.z()}; }

Json RobotJson(const RobotView& view) {
  const RobotTree& tree = view.tree;
  Json json = {{"name", tree.name}, {"urdf", view.urdf}, {"coordinates", Json::array()}};
  for (const int joint : tree.coordinate_joint) {
    json["coordinates"].push_back(tree.joints[joint].name);
  }
  json["meshes"] = Json::object();
  for (const auto& [name, bytes] : view.meshes) json["meshes"][name] = Base64(bytes);
  return json;
}

Json MarkersJson(const CalibrationView& view) {
  const ErrorModel& model = view.comparison.largest().model;
  Json json = Json::array();
  for (const Marker& marker : model.markers) {
    Json item = {{"name", marker.name}, {"link", model.tree.links[marker.link].name}};
    for (const ClusterView& cluster : view.clusters) {
      const auto& names = cluster.markers;
      if (std::find(names.begin(), names.end(), marker.name) != names.end()) {
        item["cluster"] = cluster.name;
      }
    }
    json.push_back(std::move(item));
  }
  return json;
}

/// The first minute of a trial's signal.
Json SignalJson(const TrialSummary& trial) {
  const SignalExcerpt& signal = trial.signal;
  const std::size_t frames = std::min(kMostFrames, signal.filtered.size());
  const auto first = [&](const std::vector<double>& values) {
    return Base64Floats(
        std::vector<double>(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(frames)));
  };
  Json json = {{"trial", trial.trial.name},
               {"marker", signal.marker},
               {"axis", std::string(1, "xyz"[signal.axis])},
               {"rate_hz", trial.rate_hz},
               {"threshold_mm_per_s", Rounded(1e3 * trial.rests->threshold_m_per_s)},
               {"raw", first(signal.raw)},
               {"filtered", first(signal.filtered)},
               {"chosen", Json::array()},
               {"rests", Json::array()}};
  for (const int frame : signal.chosen) {
    if (static_cast<std::size_t>(frame) < frames) json["chosen"].push_back(frame);
  }
  for (const FrameInterval& run : trial.rests->runs) {
    if (static_cast<std::size_t>(run.begin) < frames) json["rests"].push_back({run.begin, run.end});
  }
  return json;
}

/// Trials for calibration come first, because the estimate rests on them.
Json SignalsJson(const std::vector<TrialSummary>& trials) {
  Json json = Json::array();
  for (const bool calibration : {true, false}) {
    for (const TrialSummary& trial : trials) {
      const bool of_calibration = trial.trial.kind == TrialKind::kCalibration;
      if (of_calibration != calibration || !trial.rests || trial.signal.filtered.empty()) continue;
      if (json.size() < kMostSignals) json.push_back(SignalJson(trial));
    }
  }
  return json;
}

/// Adds robot, chains, spheres and workspaces.
void AddRobot(const RobotView& view, Json& json) {
  json["robot"] = RobotJson(view);
  json["chains"] = Json::array();
  for (const ChainView& chain : view.chains) {
    json["chains"].push_back({{"name", chain.name}, {"joints", chain.joints}});
  }
  json["spheres"] = Json::array();
  json["workspaces"] = Json::array();
  for (const SphereView& sphere : view.spheres) {
    json["spheres"].push_back(
        {{"link", sphere.link}, {"centre_m", Point(sphere.centre)}, {"radius_m", sphere.radius}});
  }
  for (const WorkspaceView& workspace : view.workspaces) {
    json["workspaces"].push_back({{"chain", workspace.chain},
                                  {"link", workspace.link},
                                  {"min_m", Point(workspace.min)},
                                  {"max_m", Point(workspace.max)}});
  }
}

/// What the project says about the robot, for folders without measurements.
Json ProjectJson(const RobotView& view) {
  Json json = {{"rest", std::vector<double>(view.rest.begin(), view.rest.end())},
               {"markers", Json::array()},
               {"soles", Json::array()}};
  for (const Marker& marker : view.markers) {
    json["markers"].push_back({{"name", marker.name},
                               {"link", view.tree.links[marker.link].name},
                               {"position_m", Point(marker.p_link_marker)}});
  }
  for (const SoleView& sole : view.soles) {
    json["soles"].push_back({{"link", sole.link},
                             {"min_m", {sole.min.x(), sole.min.y()}},
                             {"max_m", {sole.max.x(), sole.max.y()}}});
  }
  return json;
}

}  // namespace

std::string MakeRobotDataJson(const RobotView& view) {
  Json json = {{"format", "elastocal-report-data-1"}};
  AddRobot(view, json);
  json["project"] = ProjectJson(view);
  return JsonLine(json) + "\n";
}

std::string MakeReportDataJson(const CalibrationView& view) {
  Json json = {{"format", "elastocal-report-data-1"}, {"models", Json::array()}};
  for (const ModelKind kind : view.comparison.kinds) json["models"].push_back(ModelKindName(kind));
  AddRobot(view.robot, json);
  json["markers"] = MarkersJson(view);
  json["clusters"] = MakeClusters(view);
  json["clusters_on"] = view.held_out != nullptr ? "on motions that took no part in the estimate"
                                                 : "on the calibration postures";
  json["scenes"] = MakeScenes(view);
  if (view.held_out != nullptr) json["error_table"] = MakeErrorTableJson(view.held_out->table);
  json["distributions"] = MakeDistributions(view);
  json["traces"] = MakeTraces(view);
  json["signals"] = SignalsJson(view.trials);
  return JsonLine(json) + "\n";
}

}  // namespace elastocal
