// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <nlohmann/json.hpp>

#include "elastocal/planning/compensate_motion.hpp"
#include "elastocal/tables/json_text.hpp"

namespace elastocal {
namespace {

nlohmann::ordered_json MotionExtremeJson(const MotionExtreme& extreme) {
  return {{"value", extreme.value}, {"time_s", extreme.time_s}, {"where", extreme.where}};
}

}  // namespace

std::string MakeCompensationJson(const CompensatedMotion& result) {
  nlohmann::ordered_json json;
  json["status"] = result.broken.empty() ? "fine" : "refused";
  json["correction"] = MotionExtremeJson(result.correction);
  json["residual_mm"] = 1e3 * result.residual_m;
  json["residual_deg"] = result.residual_rad * 180.0 / M_PI;
  json["left"] = nlohmann::ordered_json::array();
  for (const LeftAtLimb& one : result.left) {
    json["left"].push_back({{"limb", one.limb},
                            {"most_mm", 1e3 * one.most.value},
                            {"time_s", one.most.time_s},
                            {"most_deg", one.most_turned.value * 180.0 / M_PI},
                            {"samples", one.samples},
                            {"yields", one.yields},
                            {"degree_mm", DegreeAsMillimetres(one.arm_m)}});
  }
  json["expected"] = nlohmann::ordered_json::array();
  for (const ExpectedAtLimb& one : result.expected) {
    json["expected"].push_back({{"limb", one.limb},
                                {"rms_mm", 1e3 * one.position},
                                {"rms_deg", one.attitude * 180.0 / M_PI}});
  }
  json["to_joint_limit"] = MotionExtremeJson(result.position);
  json["velocity_share"] = MotionExtremeJson(result.velocity);
  if (result.has_clearance) json["clearance_m"] = MotionExtremeJson(result.clearance);
  if (result.has_zmp) {
    json["planned_zmp_m"] = MotionExtremeJson(result.planned_zmp);
    json["zmp_m"] = MotionExtremeJson(result.zmp);
  }
  json["at_rest"] = result.at_rest;
  json["broken"] = result.broken;
  json["warnings"] = result.warnings;
  return JsonText(json);
}

}  // namespace elastocal
