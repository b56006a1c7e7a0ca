// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/limbs_json.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "elastocal/calibration/leg_stiffness.hpp"
#include "elastocal/calibration/nominal_places.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

using Json = nlohmann::ordered_json;

Json LegJson(const LegStiffness& leg) {
  Json stiffness = Json::array();
  Json interval = Json::array();
  Json known = Json::array();
  for (int axis = 0; axis < 6; ++axis) {
    const double unit = axis < 3 ? 1e-3 : 1.0;
    stiffness.push_back(Finite(unit * leg.stiffness[axis]));
    interval.push_back({Finite(unit * leg.low[axis]), Finite(unit * leg.high[axis])});
    known.push_back(leg.known(axis));
  }
  Json posture;
  for (const auto& [joint, position] : leg.posture) posture[joint] = position;
  return {{"name", leg.leg},        {"posture_rad", posture},  {"load_share", leg.load_share},
          {"stiffness", stiffness}, {"interval_95", interval}, {"known", known}};
}

}  // namespace

Json Finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json FramesJson(const CalibrationRun& run) {
  const RobotTree& tree = run.comparison.largest().model.tree;
  Json frames = Json::array();
  for (const FramePrecision& frame : run.frames) {
    frames.push_back({{"link", tree.links[Size(frame.link)].name},
                      {"position_sd_mm", Finite(1e3 * frame.position_sd)},
                      {"attitude_sd_deg", Finite(frame.attitude_sd * 180.0 / M_PI)}});
  }
  return frames;
}

Json NominalPlacesJson(const CalibrationResult& result) {
  const NominalPlaces places = AssessNominalPlaces(result);
  if (!places.told()) return nullptr;
  return {{"sd_mm", 1e3 * places.sd},
          {"directions", places.directions},
          {"prior_mm", Finite(1e3 * places.prior_sd)}};
}

Json LegsJson(const CalibrationRun& run) {
  Json legs;
  for (const LegStiffness& leg : AssessLegs(run.comparison.largest(), run.recording)) {
    legs.push_back(LegJson(leg));
  }
  return legs;
}

Json SolesJson(const CalibrationRun& run) {
  Json soles = Json::array();
  for (const SoleSpring& sole : run.soles) {
    const double found = std::isfinite(sole.sd) ? sole.compliance : NAN;
    soles.push_back({{"leg", sole.leg},
                     {"changes", sole.changes},
                     {"compliance_um_per_n", Finite(1e6 * found)},
                     {"sd_um_per_n", Finite(1e6 * sole.sd)},
                     {"most_um_per_n", Finite(1e6 * sole.most())},
                     {"told", sole.told()}});
  }
  return soles;
}

}  // namespace elastocal
