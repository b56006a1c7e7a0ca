// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/bounds.hpp"

#include <cmath>
#include <map>
#include <stdexcept>

#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

/// "markers.clusters[2].positions_mm[0][1]" -> "markers.clusters[].positions_mm[][]".
std::string WithoutIndices(const std::string& key) {
  std::string text;
  bool in_brackets = false;
  for (const char c : key) {
    in_brackets = in_brackets && c != ']';
    if (!in_brackets) text += c;
    in_brackets = in_brackets || c == '[';
  }
  return text;
}

constexpr const char* kRoom = "a laboratory";
constexpr const char* kBody = "a robot's size";
constexpr const char* kTurns = "two turns";

std::vector<Bound> BoundsOfRobotAndRecording() {
  return {
      {"couplings[].of.*", "", -1e3, 1e3, "a gear"},
      {"couplings[].offset_deg", "deg", -720, 720, kTurns},
      {"couplings[].offset_mm", "mm", -1e4, 1e4, kBody},
      {"linkages[].assembled_deg[]", "deg", -720, 720, kTurns},
      {"linkages[].rods[].centre_mm[]", "mm", -1e4, 1e4, kBody},
      {"linkages[].rods[].axis[]", "", -1e6, 1e6, "a direction, of any length"},
      {"linkages[].rods[].pin_mm[]", "mm", -1e4, 1e4, kBody},
      {"linkages[].rods[].anchor_mm[]", "mm", -1e4, 1e4, kBody},
      {"linkages[].rods[].length_mm", "mm", 1, 1e4, kBody},
      {"linkages[].rods[].uncertain.length_mm", "mm", 1e-6, 1e3, "below any noise; a limb"},
      {"linkages[].rods[].uncertain.zero_deg", "deg", 1e-6, 90,
       "an encoder's step; a quarter turn"},
      {"linkages[].rods[].uncertain.radius_mm", "mm", 1e-6, 1e3, "below any noise; a limb"},
      {"linkages[].rods[].uncertain.anchor_mm", "mm", 1e-6, 1e3, "below any noise; a limb"},
      {"linkages[].rods[].uncertain.centre_mm", "mm", 1e-6, 1e3, "below any noise; a limb"},
      {"linkages[].rods[].uncertain.anchor_mm[]", "mm", 0, 1e3,
       "0: it is exact, else from 1e-6; a limb"},
      {"linkages[].rods[].uncertain.centre_mm[]", "mm", 0, 1e3,
       "0: it is exact, else from 1e-6; a limb"},
      {"markers.clusters[].positions_mm[][]", "mm", -1e4, 1e4, kBody},
      {"markers.single[].position_mm[]", "mm", -1e4, 1e4, kBody},
      {"recording.not_recorded_deg.*", "deg", -720, 720, kTurns},
      {"recording.not_recorded_mm.*", "mm", -1e4, 1e4, kBody},
      {"recording.up[]", "", -1e6, 1e6, "a direction, of any length"},
      {"recording.reference_lengths[].length_mm", "mm", 10, 1e5, "a wand; a hall"},
      {"recording.reference_lengths[].sd_mm", "mm", 1e-4, 100, "a gauge; a tape"},
      {"contact.feet[].position_mm[]", "mm", -1e4, 1e4, kBody},
      {"contact.plates[].point_mm[]", "mm", -1e4, 1e4, kBody},
      {"contact.plates[].normal[]", "", -1e6, 1e6, "a direction, of any length"},
      {"contact.plates[].table.centre_mm[]", "mm", -1e4, 1e4, kBody},
      {"contact.plates[].table.size_mm[]", "mm", 1, 1e4, kBody},
      {"contact.sessions.counts.quantum", "", 1e-15, 1e6, "one step of an encoder"},
      {"contact.sessions.counts.modulo", "", 2, 1e9, "steps of an encoder"},
      {"instruments.poses[].xyz_mm[]", "mm", -1e4, 1e4, kBody},
      {"instruments.poses[].rpy_deg[]", "deg", -720, 720, kTurns},
      {"instruments.poses[].mounting_sd_mm", "mm", 1e-3, 1e4, kBody},
      {"instruments.poses[].mounting_sd_deg", "deg", 1e-3, 180, "half a turn"},
      {"instruments.poses[].covariance[][]", "", -100, 100, "10 m or rad, squared"},
      {"instruments.positions[].point_mm[]", "mm", -1e4, 1e4, kBody},
      {"instruments.positions[].mounting_sd_mm", "mm", 1e-3, 1e4, kBody},
      {"instruments.inertial_units[].rpy_deg[]", "deg", -720, 720, kTurns},
      {"instruments.inertial_units[].mounting_sd_deg", "deg", 1e-3, 180, "half a turn"},
      {"instruments.inertial_units[].bias_sd_m_per_s2", "m/s^2", 1e-6, 1, "a tenth of gravity"},
      {"instruments.cameras[].xyz_mm[]", "mm", -1e5, 1e5, "a hall"},
      {"instruments.cameras[].rpy_deg[]", "deg", -720, 720, kTurns},
      {"instruments.cameras[].mounting_sd_mm", "mm", 1e-3, 1e4, kBody},
      {"instruments.cameras[].mounting_sd_deg", "deg", 1e-3, 180, "half a turn"},
      {"instruments.cameras[].focal_px[]", "px", 1, 1e6, "lenses have 100 to 10000"},
      {"instruments.cameras[].centre_px[]", "px", -1e5, 1e5, "an image"},
      {"instruments.cameras[].distortion[]", "", -100, 100, "lenses have below 1"},
      {"instruments.cameras[].focal_sd_share", "", 1e-6, 1, "as long as the focal length"},
      {"instruments.tags[].xyz_mm[]", "mm", -1e5, 1e5, "a hall"},
      {"instruments.tags[].rpy_deg[]", "deg", -720, 720, kTurns},
      {"instruments.tags[].size_mm", "mm", 1, 1e4, kBody},
      {"instruments.tags[].mounting_sd_mm", "mm", 1e-3, 1e4, kBody},
      {"instruments.tags[].mounting_sd_deg", "deg", 1e-3, 180, "half a turn"},
      {"instruments.planes[].normal[]", "", -1e6, 1e6, "a direction, of any length"},
      {"instruments.distances[].point_mm[]", "mm", -1e4, 1e4, kBody},
      {"instruments.distances[].mounting_sd_mm", "mm", 1e-3, 1e4, kBody},
      {"instruments.wires[].point_mm[]", "mm", -1e4, 1e4, kBody},
      {"instruments.wires[].anchor_mm[]", "mm", -1e5, 1e5, "a hall"},
      {"instruments.wires[].anchor_sd_mm", "mm", 1e-3, 1e4, kBody},
      {"instruments.wires[].zero_sd_mm", "mm", 1e-3, 1e4, kBody},
      {"instruments.wires[].mounting_sd_mm", "mm", 1e-3, 1e4, kBody},
      {"placement.parallel_tolerance_deg", "deg", 1e-6, 44.9, "beyond, axes are not near parallel"},
      {"measurement.cutoff_hz", "Hz", 0.01, 1e3, "robots move at 0.1 to 10 Hz"},
      {"measurement.filter_order", "", 1, 10, "numerical stability of the filter"},
      {"measurement.longest_gap_s", "s", 0, 60, "beyond, nothing is known of the marker"},
      {"measurement.expected_lag_s", "s", -1e10, 1e10, "clocks that count from 1970"},
      {"measurement.longest_lag_s", "s", 1e-3, 3600, "the search takes longer with it"},
      {"measurement.largest_lag_sd_ms", "ms", 1e-3, 1e4, "a robot moves within a second"},
      {"measurement.largest_rest_lag_sd_ms", "ms", 1e-3, 1e5, "a rest is seconds long"},
      {"measurement.rest_speed_mm_per_s", "mm/s", 1e-3, 1e4, "cameras' noise; a fast robot"},
      {"measurement.hold_s", "s", 0.01, 600, "a frame; a trial"},
      {"measurement.samples_per_rest", "", 1, 1e5, "the frames of a rest"},
      {"measurement.sine_rate_hz", "Hz", 0.01, 1e3, "the cameras' rate"},
      {"identifiability.postures", "", 1, 1e4, "memory grows with it"},
      {"identifiability.tolerance", "", 1e-14, 0.1, "rounding; beyond, all is dependent"},
      {"calibration.marker_sd_mm", "mm", 0, 100, "0: it is estimated"},
      {"calibration.plausible_marker_sd_mm", "mm", 1e-3, 1e3, "cameras' noise", true},
      {"calibration.outlier_probability", "", 1e-12, 0.5, "a share"},
      {"calibration.support_threshold", "", 1e-3, 1, "a share"},
      {"calibration.correlation_threshold", "", 1e-3, 1, "a share"},
      {"calibration.drift", "", 0, 1, "never; within a day all is as unknown as at first"},
      {"calibration.max_iterations", "", 1, 1e4, "minutes"},
      {"calibration.slip_mm", "mm", 1e-3, 1e3, "cameras' noise; a step", true},
      {"calibration.floor_tilt_deg", "deg", 1e-3, 10, "a machined plate; a ramp", true},
      {"calibration.floor_height_mm", "mm", 1e-3, 100, "a machined plate; a step", true},
      {"calibration.prior.deflection_mrad", "mrad", 1e-4, 1e3, "a rigid and a soft robot"},
      {"calibration.prior.deflection_mm", "mm", 1e-4, 100, "a rigid and a soft slide"},
  };
}

std::vector<Bound> BoundsOfPriors() {
  std::vector<Bound> list;
  for (const char* angle : {"theta", "gamma", "alpha", "beta"}) {
    list.push_back({std::string("calibration.prior.") + angle + "_deg", "deg", 1e-6, 90,
                    "an encoder's step; a quarter turn", true});
  }
  for (const char* length : {"r", "d", "b"}) {
    list.push_back({std::string("calibration.prior.") + length + "_mm", "mm", 1e-6, 1e3,
                    "below any noise; a limb", true});
  }
  const std::vector<Bound> others = {
      {"calibration.prior.marker_mm", "mm", 1e-3, 1e5, "cameras' noise; a laboratory", true},
      {"calibration.prior.torsion_urad_per_Nm", "urad/N.m", 1e-6, 1e6, "rigid and soft", true},
      {"calibration.prior.bending_urad_per_Nm", "urad/N.m", 1e-6, 1e6, "rigid and soft", true},
      {"calibration.prior.base_force_um_per_N", "um/N", 1e-6, 1e6, "rigid and soft", true},
      {"calibration.prior.base_moment_urad_per_Nm", "urad/N.m", 1e-6, 1e6, "rigid and soft", true},
      {"calibration.prior.torque_bias_Nm", "N.m", 1e-6, 1e4, "a sensor's range", true},
  };
  list.insert(list.end(), others.begin(), others.end());
  return list;
}

std::vector<Bound> BoundsOfDesignAndTrials() {
  return {
      {"collision.margin_mm", "mm", 0, 1e3, kBody},
      {"collision.spheres[].centre_mm[]", "mm", -1e4, 1e4, kBody},
      {"collision.spheres[].radius_mm", "mm", 0.1, 1e4, kBody},
      {"standing.soles[].lower_mm[]", "mm", -1e4, 1e4, kBody},
      {"standing.soles[].upper_mm[]", "mm", -1e4, 1e4, kBody},
      {"standing.soles[].ball_radius_mm", "mm", 0, 1e3, kBody},
      {"standing.stance_mm", "mm", 1, 1e4, kBody},
      {"design.rest_deg.*", "deg or mm", -1e4, 1e4, "joints' limits"},
      {"design.range_deg.*", "deg or mm", -1e4, 1e4, "joints' limits"},
      {"design.limit_margin", "", 0, 0.4, "beyond, nearly nothing of the range is left"},
      {"design.room_deg.*", "deg", 0, 45, "more is no room for a correction"},
      {"design.effort_share", "", 0, 1, "a share"},
      {"design.motion_effort_share", "", 0.01, 1, "a share"},
      {"design.dexterity_share", "", 0, 1, "a share of what the posture of rest has"},
      {"design.chains[].cone_deg", "deg", 0.1, 180, "half a turn"},
      {"design.chains[].floor_mm", "mm", -1e4, 1e4, kBody},
      {"design.chains[].box_mm.lower[]", "mm", -1e5, 1e5, kRoom},
      {"design.chains[].box_mm.upper[]", "mm", -1e5, 1e5, kRoom},
      {"design.cameras_mm[][]", "mm", -1e6, 1e6, kRoom},
      {"trials[].expected_lag_s", "s", -1e10, 1e10, "clocks that count from 1970"},
      {"Qualisys TSV X, Y, Z", "mm", -1e6, 1e6, kRoom},
      {"chains[].postures[].*", "rad or m", -1e3, 1e3, "joints' limits"},
  };
}

std::vector<Bound> BoundsOfUrdf() {
  return {
      {"URDF mass.value", "kg", 0, 1e5, "the largest machines"},
      {"URDF inertia.ixx", "kg.m2", -1e6, 1e6, "the largest machines"},
      {"URDF inertia.iyy", "kg.m2", -1e6, 1e6, "the largest machines"},
      {"URDF inertia.izz", "kg.m2", -1e6, 1e6, "the largest machines"},
      {"URDF inertia.ixy", "kg.m2", -1e6, 1e6, "the largest machines"},
      {"URDF inertia.ixz", "kg.m2", -1e6, 1e6, "the largest machines"},
      {"URDF inertia.iyz", "kg.m2", -1e6, 1e6, "the largest machines"},
      {"URDF origin.xyz", "m", -100, 100, "the largest machines"},
      {"URDF origin.rpy", "rad", -1e5, 1e5, "beyond, rounding of turns is seen"},
      {"URDF axis.xyz", "", -1e6, 1e6, "a direction, of any length"},
      {"URDF limit.lower", "rad or m", -1e9, 1e9, "a joint without limits is continuous"},
      {"URDF limit.upper", "rad or m", -1e9, 1e9, "a joint without limits is continuous"},
      {"URDF limit.effort", "N.m or N", 0, 1e12, "it is a size"},
      {"URDF limit.velocity", "rad/s or m/s", 0, 1e12, "it is a size"},
      {"URDF box.size", "m", 0, 100, "the largest machines"},
      {"URDF cylinder.radius", "m", 0, 100, "the largest machines"},
      {"URDF cylinder.length", "m", 0, 100, "the largest machines"},
      {"URDF sphere.radius", "m", 0, 100, "the largest machines"},
      {"URDF mesh.scale", "", -1e6, 1e6, "units from nanometres on; negative: mirrored"},
      {"URDF mimic.multiplier", "", -1e3, 1e3, "a gear"},
      {"URDF mimic.offset", "rad or m", -1e3, 1e3, "joints' limits"},
  };
}

std::vector<Bound> BoundsOfCommands() {
  return {
      {"assess --marker-noise-mm", "mm", 1e-3, 100, "cameras' noise"},
      {"check --level", "", 1e-9, 0.5, "a share"},
      {"compare --level", "", 1e-9, 0.5, "a share"},
      {"check --days", "d", 0, 1e5, "the same day; a robot's life"},
      {"calibrate --days", "d", 0, 1e5, "the same day; a robot's life"},
      {"marker places x_mm, y_mm, z_mm", "mm", -1e4, 1e4, kBody},
      {"marker places sd_mm", "mm", 1e-3, 100, "a measuring machine; a guess"},
      {"simulate --marker-places-mm", "mm", 1e-3, 100, "a measuring machine; a guess"},
      {"design --plateau", "", 0, 1, "a share"},
      {"plan --move-s", "s", 0.1, 1e3, "a robot's dynamics; patience"},
      {"plan --rest-s", "s", 1, 1e3, "what a rest needs to be found; patience"},
      {"plan --zmp-margin-mm", "mm", 0, 1e3, "a foot"},
      {"plan --lift-mm", "mm", 1, 1e3, "a leg"},
      {"plan --inset-mm", "mm", 0.1, 1e3, "a foot"},
      {"plan --approach-mm", "mm", 1, 1e3, "an arm"},
      {"plan --torque-share", "", 0.01, 1, "a share"},
      {"plan --velocity-share", "", 0.01, 1, "a share"},
      {"plan --floor-friction", "", 0, 10, "rubber has 1"},
      {"plan --limit-margin-deg", "deg", 0, 45, "more is no room for a correction"},
      {"plan --leg-geometry-scale", "", 0, 100, "a factor on errors of millimetres"},
      {"compensate --most-left-mm", "mm", 0, 1e3, "an arm"},
      {"compensate --most-turned-deg", "deg", 0, 180, "any attitude"},
      {"compensate --ease-s", "s", 0, 10, "a correction that comes later than a motion ends"},
      {"compensate --most-bend-deg", "deg", 1e-3, 17, "rotations are taken for small ones"},
      {"compensate --most-bend-mm", "mm", 1e-3, 1e3, "a limb"},
      {"compensate --most-change-deg", "deg", 1e-3, 180, "half a turn"},
      {"export --torque-time-constant-s", "s", 0, 100, "slower than any motion"},
      {"export --period-s", "s", 1e-6, 10, "no controller; a robot at rest"},
  };
}

std::vector<Bound> MakeBounds() {
  std::vector<Bound> list;
  for (const auto& part : {BoundsOfRobotAndRecording(), BoundsOfPriors(), BoundsOfDesignAndTrials(),
                           BoundsOfUrdf(), BoundsOfCommands()}) {
    list.insert(list.end(), part.begin(), part.end());
  }
  return list;
}

}  // namespace

bool NumberRange::Contains(double number) const {
  return (number > lower || (with_lower && number == lower)) &&
         (number < upper || (with_upper && number == upper));
}

std::string NumberRange::InWords() const {
  const std::string least = FormatNumber(lower), most = FormatNumber(upper);
  const std::string infinite = or_infinity ? ", or .inf" : "";
  if (with_lower && with_upper && std::isfinite(upper)) {
    return "a number from " + least + " to " + most + infinite;
  }
  const std::string words = (with_lower ? "a number of at least " : "a number above ") + least;
  if (std::isinf(upper)) return words + (with_upper ? ", or .inf" : "");
  return words + (with_upper ? " and at most " : " and below ") + most + infinite;
}

const std::vector<Bound>& AllBounds() {
  static const std::vector<Bound> bounds = MakeBounds();
  return bounds;
}

const Bound* FindBound(const std::string& key) {
  static const std::map<std::string, const Bound*> index = [] {
    std::map<std::string, const Bound*> by_key;
    for (const Bound& bound : AllBounds()) by_key[bound.key] = &bound;
    return by_key;
  }();
  const std::string plain = WithoutIndices(key);
  if (const auto found = index.find(plain); found != index.end()) return found->second;
  // Names of joints may have dots, so that every beginning of the key is tried.
  for (std::size_t dot = plain.find('.'); dot != std::string::npos;
       dot = plain.find('.', dot + 1)) {
    const auto found = index.find(plain.substr(0, dot) + ".*");
    if (found != index.end()) return found->second;
  }
  return nullptr;
}

NumberRange BoundsOf(const std::string& key) {
  if (const Bound* bound = FindBound(key)) return bound->range();
  throw std::invalid_argument("there are no bounds of '" + key + "'");
}

std::string BoundsTable() {
  std::string table = "| key | unit | least | largest | because |\n|---|---|---|---|---|\n";
  for (const Bound& bound : AllBounds()) {
    table += "| `" + bound.key + "` | " + bound.unit + " | " + FormatNumber(bound.least) + " | " +
             FormatNumber(bound.largest) + (bound.or_infinity ? ", or `.inf`" : "") + " | " +
             bound.why + " |\n";
  }
  return table;
}

}  // namespace elastocal
