// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/check_json.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

namespace elastocal {
namespace {

nlohmann::ordered_json SuspectJson(const JointSuspect& suspect) {
  nlohmann::ordered_json json;
  json["joint"] = suspect.joint;
  json["told"] = suspect.told();
  json["F"] = suspect.told() ? nlohmann::ordered_json(suspect.test.statistic)
                             : nlohmann::ordered_json(nullptr);
  json["p"] = suspect.test.p;
  json["p_adjusted"] = suspect.p_adjusted;
  json["probability"] = suspect.probability;
  json["smallest_seen"] = suspect.zero_told ? nlohmann::ordered_json(suspect.smallest_seen)
                                            : nlohmann::ordered_json(nullptr);
  json["changes"] = nlohmann::ordered_json::array();
  for (const ParameterChange& change : suspect.changes) {
    json["changes"].push_back({{"name", change.name},
                               {"unit", UnitName(change.unit)},
                               {"change", change.value},
                               {"sd", change.sd}});
  }
  return json;
}

}  // namespace

nlohmann::ordered_json MarkersJson(const std::vector<LinkMarkers>& links) {
  auto json = nlohmann::ordered_json::array();
  for (const LinkMarkers& link : links) {
    json.push_back({{"link", link.link},
                    {"markers", link.markers},
                    {"same", link.same},
                    {"p", link.p},
                    {"as_one_piece", link.as_one_piece}});
  }
  return json;
}

void AddJointCheck(const JointCheck& check, nlohmann::ordered_json& json) {
  json["moved"] = nlohmann::ordered_json::array();
  for (const JointSuspect& joint : check.moved) json["moved"].push_back(SuspectJson(joint));
  json["suspects"] = check.suspects;
  json["or_markers"] = check.or_markers;
  json["markers"] = MarkersJson(check.markers);
  json["earlier_sd_factor"] = std::sqrt(check.widened);
  json["not_told"] = check.not_told;
  json["joints"] = nlohmann::ordered_json::array();
  for (const JointSuspect& joint : check.joints) json["joints"].push_back(SuspectJson(joint));
}

}  // namespace elastocal
