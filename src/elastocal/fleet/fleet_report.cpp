// SPDX-License-Identifier: Apache-2.0
#include "elastocal/fleet/fleet_report.hpp"

#include <cmath>
#include <limits>
#include <map>

#include <nlohmann/json.hpp>

#include "elastocal/files/output_files.hpp"
#include "elastocal/fleet/fleet_page.hpp"
#include "elastocal/io/calibration_file.hpp"
#include "elastocal/io/covariance_file.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/tables/json_text.hpp"
#include "elastocal/tables/table_writer.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kFewestForPrior = 3;
const double kUnknown = std::numeric_limits<double>::quiet_NaN();

double Millimetres(const Json& json, const char* artefact, const char* key) {
  const auto deployed = json.find("deployed");
  if (deployed == json.end() || !deployed->contains(artefact)) return kUnknown;
  const Json& of = deployed->at(artefact);
  return of.contains(key) && of[key].is_number() ? 1e-3 * of[key].get<double>() : kUnknown;
}

/// Root mean square of the 3-D position errors over all instruments that measure positions, m.
double PositionError(const Json& figures) {
  if (!figures.is_object() || !figures.contains("instruments")) return kUnknown;
  double squares = 0.0, count = 0.0;
  for (const Json& one : figures["instruments"]) {
    if (!one.contains("position_mm") || !one["position_mm"].is_number()) continue;
    const double of_coordinate = 1e-3 * one["position_mm"].get<double>();
    const double observations = one.value("observations", 0.0);
    squares += observations * 3.0 * of_coordinate * of_coordinate;
    count += observations;
  }
  return count > 0.0 ? std::sqrt(squares / count) : kUnknown;
}

/// Reads the errors of a session with contact or instruments: on held-out data, if there are any.
void ReadPositionErrors(const Json& contact, SessionOutcome& outcome) {
  const bool held_out = contact.contains("kfold") && contact["kfold"].is_object();
  const Json judged = contact.value(held_out ? "kfold" : "fit", Json());
  outcome.urdf = PositionError(judged);
  if (judged.is_object())
    outcome.uncalibrated = PositionError(judged.value("uncalibrated", Json()));
  if (!contact.contains("urdf_alone")) return;
  outcome.compensated = outcome.urdf;
  outcome.urdf = PositionError(contact["urdf_alone"]);
}

SessionOutcome ReadOutcome(const FleetTask& task, const TaskEnd& end, const fs::path& output) {
  SessionOutcome outcome{.task = &task,
                         .end = end,
                         .status = "not done",
                         .uncalibrated = kUnknown,
                         .urdf = kUnknown,
                         .compensated = kUnknown};
  std::error_code error;
  const fs::path file = output / task.name / "summary.json";
  if ((end.exit_code != 0 && end.exit_code != 4) || !fs::exists(file, error)) return outcome;
  const Json json = Json::parse(ReadFile(file), nullptr, false);
  if (!json.is_object()) return outcome;
  if (json.contains("status") && json["status"].is_string()) outcome.status = json["status"];
  if (json.contains("postures") && json["postures"].is_number_integer()) {
    outcome.postures = json["postures"];
  }
  outcome.urdf = Millimetres(json, "urdf", "rmse_3d_mm");
  outcome.uncalibrated = Millimetres(json, "urdf", "uncalibrated");
  outcome.compensated = Millimetres(json, "compensated", "rmse_3d_mm");
  if (json.contains("contact") && json["contact"].is_object()) {
    ReadPositionErrors(json["contact"], outcome);
  }
  return outcome;
}

/// Keeps the members with the most frequent `key`; the others are noted as `of_others`.
template <typename Key>
void KeepMost(Key key, const std::string& of_others, std::vector<FleetMember>& members,
              std::vector<std::string>& notes) {
  std::map<std::string, int> counts;
  for (const FleetMember& member : members) ++counts[key(member.estimate)];
  std::string most;
  int largest = 0;
  for (const auto& [value, count] : counts) {
    if (count <= largest) continue;
    most = value;
    largest = count;
  }
  std::erase_if(members, [&](const FleetMember& member) {
    if (key(member.estimate) == most) return false;
    notes.push_back(member.session + ": " + of_others + " than most, not in the family");
    return true;
  });
}

/// Keeps one nominal robot and one gauge, because otherwise errors are not the same quantities.
void KeepOneRobot(std::vector<FleetMember>& members, std::vector<std::string>& notes) {
  KeepMost([](const CalibrationEstimate& estimate) { return estimate.nominal; },
           "of another nominal robot", members, notes);
  KeepMost([](const CalibrationEstimate& estimate) { return estimate.gauge; },
           "with another gauge of the root link (calibration.gauge)", members, notes);
}

Json FindingJson(const std::string& parameter, const std::string& unit, double p) {
  return {{"parameter", parameter}, {"unit", unit}, {"p_adjusted", p}};
}

std::string FleetJson(const FleetReport& report) {
  Json json;
  json["sessions"] = report.sessions.size();
  int failed = 0;
  for (const SessionOutcome& session : report.sessions)
    failed += session.end.exit_code != 0 ? 1 : 0;
  json["not_deployable"] = failed;
  json["robots"] = report.robots;
  const double median = report.family.median_error;
  json["median_urdf_rmse_3d_mm"] = std::isfinite(median) ? Json(1e3 * median) : Json(nullptr);
  json["workshop"] = report.family.workshop;
  json["out_of_family"] = Json::array();
  for (const OutOfFamily& one : report.family.out_of_family) {
    Json found = FindingJson(one.parameter, one.unit, one.p_adjusted);
    found.update(
        {{"robot", one.robot}, {"value", one.value}, {"family", one.family}, {"sd", one.sd}});
    json["out_of_family"].push_back(std::move(found));
  }
  json["batches"] = Json::array();
  for (const BatchDifference& one : report.family.batches) {
    Json found = FindingJson(one.parameter, one.unit, one.p_adjusted);
    found.update({{"batch", one.batch}, {"difference", one.difference}, {"sd", one.sd}});
    json["batches"].push_back(std::move(found));
  }
  json["drifts"] = Json::array();
  for (const ParameterDrift& one : report.family.drifts) {
    Json found = FindingJson(one.parameter, one.unit, one.p_adjusted);
    found.update({{"robot", one.robot}, {"per_day", one.per_day}, {"sd", one.sd}});
    for (const SessionValue& session : one.sessions) {
      found["sessions"].push_back(
          {{"day", session.day}, {"value", session.value}, {"sd", session.sd}});
    }
    json["drifts"].push_back(std::move(found));
  }
  json["notes"] = report.notes;
  return JsonText(json);
}

std::string SessionsTable(const FleetReport& report) {
  TableWriter table;
  for (const char* name : {"session", "robot", "batch", "day", "exit_code", "status", "postures",
                           "uncalibrated_mm", "urdf_mm", "compensated_mm", "seconds"}) {
    table.Add(name);
  }
  table.EndRow();
  for (const SessionOutcome& one : report.sessions) {
    table.Add(one.task->name);
    table.Add(one.task->robot);
    table.Add(one.task->batch);
    table.Add(one.task->day.value_or(kUnknown));
    table.Add(std::to_string(one.end.exit_code));
    table.Add(one.status);
    table.Add(std::to_string(one.postures));
    table.AddFixed(1e3 * one.uncalibrated, 4);
    table.AddFixed(1e3 * one.urdf, 4);
    table.AddFixed(1e3 * one.compensated, 4);
    table.AddFixed(one.end.seconds, 2);
    table.EndRow();
  }
  return table.text();
}

std::string FamilyTable(const FleetReport& report) {
  TableWriter table;
  for (const char* name : {"parameter", "unit", "mean", "sd", "robots"}) table.Add(name);
  table.EndRow();
  for (const FamilyParameter& one : report.family.parameters) {
    table.Add(one.name);
    table.Add(one.unit);
    table.Add(one.mean);
    table.Add(one.sd);
    table.Add(std::to_string(one.robots));
    table.EndRow();
  }
  return table.text();
}

}  // namespace

FleetReport MakeFleetReport(const std::vector<FleetTask>& tasks, const std::vector<TaskEnd>& ends,
                            const fs::path& output, double level) {
  FleetReport report;
  std::vector<FleetMember> members;
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    report.sessions.push_back(ReadOutcome(tasks[t], ends[t], output));
    if (ends[t].exit_code != 0) continue;
    try {
      FleetMember member{
          .session = tasks[t].name,
          .robot = tasks[t].robot,
          .batch = tasks[t].batch,
          .day = tasks[t].day,
          .urdf_error = report.sessions.back().urdf,
          .estimate = ReadCalibrationFiles(FindCalibrationFiles(output / tasks[t].name))};
      members.push_back(std::move(member));
    } catch (const InputError& error) {
      report.notes.emplace_back(error.what());
    }
  }
  KeepOneRobot(members, report.notes);
  report.family = StudyFamily(members, level);
  const std::vector<FleetMember> robots = LastSessions(members);
  report.robots = static_cast<int>(robots.size());
  if (robots.size() >= kFewestForPrior) report.prior = FleetPrior(robots);
  return report;
}

std::vector<fs::path> FleetFileNames() {
  return {
      "fleet.json",          "fleet.html", "sessions.csv", "family.csv", "prior/calibration.yaml",
      "prior/covariance.csv"};
}

std::vector<std::string> MakeFleetFiles(const FleetReport& report) {
  const std::string json = FleetJson(report);
  std::vector<std::string> files = {json, MakeFleetPage(report, json), SessionsTable(report),
                                    FamilyTable(report)};
  if (report.prior.parameters.empty()) {
    files.insert(files.end(), 2, "");
  } else {
    files.push_back(MakeCalibrationYaml(report.prior));
    files.push_back(MakeCovarianceCsv(report.prior.covariance_names, report.prior.covariance));
  }
  return files;
}

}  // namespace elastocal
