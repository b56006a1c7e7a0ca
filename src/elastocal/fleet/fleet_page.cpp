// SPDX-License-Identifier: Apache-2.0
#include "elastocal/fleet/fleet_page.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "elastocal/report/page.hpp"
#include "elastocal/report/version.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

Json KnownMillimetres(double metres) {
  return std::isfinite(metres) ? Json(1e3 * metres) : Json(nullptr);
}

Json SessionJson(const SessionOutcome& session) {
  const FleetTask& task = *session.task;
  return {{"name", task.name},
          {"robot", task.robot},
          {"batch", task.batch},
          {"day", task.day ? Json(*task.day) : Json(nullptr)},
          {"exit_code", session.end.exit_code},
          {"status", session.status},
          {"postures", session.postures},
          {"uncalibrated_mm", KnownMillimetres(session.uncalibrated)},
          {"urdf_mm", KnownMillimetres(session.urdf)},
          {"compensated_mm", KnownMillimetres(session.compensated)},
          {"seconds", session.end.seconds}};
}

}  // namespace

std::string MakeFleetPage(const FleetReport& report, const std::string& fleet_json) {
  if (PageTemplate().empty()) return "";
  Json json = {{"format", "elastocal-fleet-1"},    {"version", ProgramVersion()},
               {"fleet", Json::parse(fleet_json)}, {"prior", !report.prior.parameters.empty()},
               {"sessions", Json::array()},        {"family", Json::array()}};
  for (const SessionOutcome& session : report.sessions) {
    json["sessions"].push_back(SessionJson(session));
  }
  for (const FamilyParameter& one : report.family.parameters) {
    json["family"].push_back({{"parameter", one.name},
                              {"unit", one.unit},
                              {"mean", one.mean},
                              {"sd", one.sd},
                              {"robots", one.robots}});
  }
  return MakePage(PageTemplate(), JsonLine(json));
}

}  // namespace elastocal
