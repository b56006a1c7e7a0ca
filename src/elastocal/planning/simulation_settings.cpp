// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/simulation_settings.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "elastocal/files/output_files.hpp"
#include "elastocal/files/yaml_value.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr double kMillimetre = 1e-3;
constexpr double kStiffest = 1e9;  // N.m/rad: beyond, physics needs smaller steps

using Settings = std::vector<SimulationSetting>;

void AddTruth(TruthOptions& truth, Settings& list) {
  const std::string g = "True geometry (standard deviations)";
  list.insert(
      list.end(),
      {{g, "upper_offset_deg", &truth.upper_offset_sd, kRadiansPerDegree, 0, 45,
        "Joint zeros of head, arms and trunk"},
       {g, "leg_offset_deg", &truth.leg_offset_sd, kRadiansPerDegree, 0, 45,
        "Joint zeros of the legs"},
       {g, "length_mm", &truth.length_sd, kMillimetre, 0, 100,
        "Placement of every joint, along each direction"},
       {g, "angle_deg", &truth.angle_sd, kRadiansPerDegree, 0, 45,
        "Placement of every joint, about each axis"},
       {g, "upper_geometry_scale", &truth.upper_geometry_scale, 1, 0, 100,
        "Factor on all of these, of head, arms and trunk"},
       {g, "leg_geometry_scale", &truth.leg_geometry_scale, 1, 0, 100, "The same, of the legs"},
       {g, "series_share", &truth.series.share, 1, 0, 1,
        "Of the variance of every error of the robot, what all robots of a "
        "series have in common"},
       {g, "series_seed", &truth.series.seed, 1, 0, 1e9, "Seed of what they have in common"},
       {g, "marker_mm", &truth.marker_sd, kMillimetre, 0, 100,
        "Markers on their links, each coordinate"}});
  const std::string e = "True elasticity";
  list.insert(
      list.end(),
      {{e, "upper_stiffness_least", &truth.upper_stiffness_least, 1, 1, kStiffest,
        "Joint springs of head, arms and trunk, N.m/rad: from"},
       {e, "upper_stiffness_most", &truth.upper_stiffness_most, 1, 1, kStiffest, "to"},
       {e, "leg_stiffness_least", &truth.leg_stiffness_least, 1, 1, kStiffest,
        "Joint springs of the legs, N.m/rad: from"},
       {e, "leg_stiffness_most", &truth.leg_stiffness_most, 1, 1, kStiffest, "to"},
       {e, "upper_elasticity_scale", &truth.upper_elasticity_scale, 1, 0, 1000,
        "Factor on compliances of head, arms and trunk; 0: rigid"},
       {e, "leg_elasticity_scale", &truth.leg_elasticity_scale, 1, 0, 1000,
        "The same, of the legs"},
       {e, "pelvis_compliance", &truth.pelvis_compliance, 1, 0, 1,
        "Of the root link to the hips, m/N x 3 and rad/(N.m) x 3"},
       {e, "hip_link_compliance", &truth.hip_link_compliance, 1, 0, 1,
        "Of each link in a leg's first half"},
       {e, "shank_link_compliance", &truth.shank_link_compliance, 1, 0, 1, "In its second half"},
       {e, "link_compliance_spread_share", &truth.link_compliance_spread, 1, 0, 1,
        "By which each of these is drawn larger or smaller, as a share"}});
  const std::string o = "True inertia, friction and torque sensors";
  list.insert(list.end(),
              {{o, "mass_share", &truth.mass_sd, 1, 0, 1, "Masses of links, relative"},
               {o, "com_mm", &truth.com_sd, kMillimetre, 0, 1000, "Centres of mass"},
               {o, "friction_share", &truth.friction_share, 1, 0, 1,
                "Coulomb friction over a joint's largest effort"},
               {o, "torque_gain_share", &truth.torque_gain_sd, 1, 0, 1, "Gain of torque sensors"},
               {o, "torque_bias_nm", &truth.torque_bias_sd, 1, 0, 1000, "Bias of torque sensors"}});
}

void AddSensors(SensorOptions& sensors, Settings& list) {
  const std::string c = "Cameras";
  list.insert(
      list.end(),
      {{c, "marker_noise_mm", &sensors.marker_noise_sd, kMillimetre, 0, 100,
        "Noise of a coordinate"},
       {c, "gaps_per_minute", &sensors.gaps_per_minute, 1, 0, 600, "Occlusions of a marker"},
       {c, "mean_gap_s", &sensors.mean_gap_s, 1, 0, 600, "Their mean length"},
       {c, "outlier_share", &sensors.outlier_share, 1, 0, 1, "Share of samples that are off"},
       {c, "largest_outlier_mm", &sensors.largest_outlier, kMillimetre, 0, 10000, "By up to"},
       {c, "swaps_per_minute", &sensors.swaps_per_minute, 1, 0, 600,
        "Labels swapped within a cluster"},
       {c, "mean_swap_s", &sensors.mean_swap_s, 1, 0, 600, "Their mean length"}});
  const std::string l = "Joint log";
  list.insert(
      list.end(),
      {{l, "log_rate_hz", &sensors.log_rate_hz, 1, 1, 1e3, "Samples a second"},
       {l, "least_lag_s", &sensors.least_lag_s, 1, -1e3, 1e3,
        "How far the robot's clock is behind the cameras': from"},
       {l, "largest_lag_s", &sensors.largest_lag_s, 1, -1e3, 1e3, "to"},
       {l, "drift_ppm", &sensors.drift_size_ppm, 1, 0, 1e5,
        "Drift of its clock, about, fast or slow"},
       {l, "encoder_bits", &sensors.encoder_bits, 1, 0, 40, "A turn; 0: not quantised"},
       {l, "torque_noise_nm", &sensors.torque_noise_sd, 1, 0, 1000, "Noise of torque sensors"}});
}

void AddInstruments(InstrumentOptions& of, Settings& list) {
  const std::string i = "Instruments and touches (projects with contact or instruments)";
  list.insert(
      list.end(),
      {{i, "length_noise_mm", &of.length_sd, kMillimetre, 0, 1000,
        "Noise of positions, heights and wires"},
       {i, "rotation_noise_deg", &of.rotation_sd, kRadiansPerDegree, 0, 45,
        "Of attitudes, about each axis"},
       {i, "acceleration_noise", &of.acceleration_sd, 1, 0, 10, "Of accelerometers, m/s^2"},
       {i, "pixel_noise", &of.pixel_sd, 1, 0, 100, "Of each corner in an image, px"},
       {i, "pixel_blur", &of.blur_sd, 1, 0, 100, "Of all corners of an image together, px"},
       {i, "touch_height_mm", &of.touch_height_sd, kMillimetre, 0, 100,
        "Unevenness of table and plate: height of a touch"},
       {i, "touch_tilt_deg", &of.touch_tilt_sd, kRadiansPerDegree, 0, 45,
        "The same: tilts of a touch"},
       {i, "table_height_mm", &of.table_height_sd, kMillimetre, 0, 1000,
        "How far a table is from where the project has it"},
       {i, "plate_edge_mm", &of.plate_edge, kMillimetre, 1, 1000, "Edge of square plates"},
       {i, "touch_force_n", &of.touch.force, 1, 1, 1000, "With which a plate is pressed on"}});
}

void AddCauses(VirtualExperimentOptions& options, Settings& list) {
  constexpr double kMilli = 1e-3;
  SensorOptions& sensors = options.sensors;
  TruthOptions& truth = options.truth;
  PhysicsOptions& physics = options.physics;
  const std::string c = "Causes beyond geometry and springs (none by default)";
  list.insert(
      list.end(),
      {{c, "cause_joint", &sensors.cause_joint, 1, 0, 0, "Joint that has them"},
       {c, "eccentricity_mrad", &sensors.eccentricity, kMilli, -100, 100,
        "Its encoder's disc is off centre: amplitude of sin q"},
       {c, "gear_error_share", &sensors.gear_error, 1, -0.1, 0.1, "Error of its gear's ratio"},
       {c, "backlash_mrad", &sensors.backlash, kMilli, -100, 100,
        "Half width of its play, by the sign of its load"},
       {c, "hysteresis_mrad", &sensors.hysteresis, kMilli, -100, 100,
        "Half width, by the direction of its last motion"},
       {c, "cameras_drift_mm_per_h", &sensors.cameras_drift, kMillimetre, -1000, 1000,
        "Of all markers along x, in each trial"},
       {c, "heavy_link", &truth.heavy_link, 1, 0, 0, "Link that weighs more than described"},
       {c, "heavy_share", &truth.heavy_share, 1, -0.9, 10, "By this share"},
       {c, "gravity_tilt_x_deg", &physics.gravity_tilt_x, kRadiansPerDegree, -20, 20,
        "What the robot stands on is not level: gravity turns about x"},
       {c, "gravity_tilt_y_deg", &physics.gravity_tilt_y, kRadiansPerDegree, -20, 20,
        "The same, about y"},
       {c, "creeping_marker", &truth.creeping_marker, 1, 0, 0,
        "Marker that creeps along x of its link, in each trial"},
       {c, "creep_mm_per_h", &truth.creep, kMillimetre, -1000, 1000, "So fast"}});
}

void AddPlay(PhysicsOptions& physics, MotionOptions& motion, Settings& list) {
  const std::string p = "Physics";
  list.insert(list.end(), {{p, "time_step_s", &physics.time_step_s, 1, 1e-5, 0.01,
                            "Of MuJoCo; a hundredth of a second is a whole number of them"},
                           {p, "servo_stiffness", &physics.servo_stiffness, 1, 1, 1e9,
                            "How far the encoders give way, N.m/rad"},
                           {p, "floor_friction", &physics.floor_friction, 1, 0, 10,
                            "Of a robot that stands free"}});
  const std::string m = "Motions";
  list.insert(
      list.end(),
      {{m, "head_postures", &motion.head_postures, 1, 1, 10000, "Of short chains"},
       {m, "arm_postures", &motion.arm_postures, 1, 1, 10000, "Of arms"},
       {m, "leg_postures", &motion.leg_postures, 1, 1, 10000, "Of each leg"},
       {m, "random_postures", &motion.random_postures, 1, 1, 10000, "Of each validation trial"},
       {m, "repetitions", &motion.repetitions, 1, 1, 10000, "Of the repeatability motion"},
       {m, "move_s", &motion.move_s, 1, 0.1, 1000, "From one posture to the next"},
       {m, "rest_s", &motion.rest_s, 1, 0.05, 1000, "In a posture"},
       {m, "lead_in_s", &motion.lead_in_s, 1, 0, 1000, "At rest before the first motion"},
       {m, "counterweight_share", &motion.counterweight, 1, 0, 1,
        "How far the upper body moves to load the supporting leg"}});
}

void AddFaults(Faults& faults, Settings& list) {
  const std::string g = "Faults (none by default)";
  list.insert(
      list.end(),
      {{g, "missing_share", &faults.missing_share, 1, 0, 1, "Share of marker samples missing"},
       {g, "lost_marker", &faults.lost_marker, 1, 0, 0, "Not seen in the second half of a trial"},
       {g, "swapped_marker_a", &faults.swapped_marker_a, 1, 0, 0, "Its label and that of"},
       {g, "swapped_marker_b", &faults.swapped_marker_b, 1, 0, 0,
        "are swapped from a third of --fault-trial on"},
       {g, "swap_s", &faults.swap_s, 1, 0, 1e5, "for so long"},
       {g, "knocked_cluster", &faults.knocked_cluster, 1, 0, 0,
        "Pushed in the middle of --fault-trial, and stays so"},
       {g, "knock_mm", &faults.knock, kMillimetre, 0, 1000, "by"},
       {g, "dead_torque_sensor", &faults.dead_torque_sensor, 1, 0, 0, "Joint whose sensor reads 0"},
       {g, "saturated_torque_sensor", &faults.saturated_torque_sensor, 1, 0, 0,
        "Joint whose sensor reads no more than"},
       {g, "saturation_nm", &faults.saturation, 1, 0, 1e6, "this, to either side"},
       {g, "lag_s", &faults.lag_s, 1, -1e3, 1e3, "Of the robot's clock in all trials"},
       {g, "log_cut_s", &faults.log_cut_s, 1, 0, 1e5, "The log of --fault-trial ends too early by"},
       {g, "slipped_posture", &faults.slipped_posture, 1, 0, 10000,
        "Posture of --fault-trial, from 1, in which the foot has slipped"},
       {g, "slip_mm", &faults.slip, kMillimetre, 0, 1000, "by"},
       {g, "fault_trial", &faults.trial, 1, 0, 0, "Where; every trial if not given"}});
}

double ParseIn(const SimulationSetting& setting, const std::string& text,
               const std::string& place) {
  const auto number = ParseNumber(text);
  if (!number || *number < setting.least || *number > setting.most) {
    throw InputError(place + "found " + Quote(text) + "; a number from " +
                     FormatNumber(setting.least) + " to " + FormatNumber(setting.most) +
                     " was expected");
  }
  return *number;
}

/// Assigns text to each type of option.
struct Assign {
  const SimulationSetting& setting;
  const std::string& text;
  const std::string& place;

  void operator()(double* value) const { *value = setting.unit * ParseIn(setting, text, place); }
  void operator()(std::optional<double>* value) const {
    *value = setting.unit * ParseIn(setting, text, place);
  }
  void operator()(int* value) const {
    const double number = ParseIn(setting, text, place);
    if (number != std::floor(number)) {
      throw InputError(place + "found " + Quote(text) + "; a whole number was expected");
    }
    *value = static_cast<int>(number);
  }
  void operator()(std::string* value) const { *value = text; }
  void operator()(Vector6d* value) const {
    std::string blanks = text;
    std::replace(blanks.begin(), blanks.end(), ',', ' ');
    std::istringstream words(blanks);
    std::vector<double> numbers;
    for (std::string word; words >> word;) numbers.push_back(ParseIn(setting, word, place));
    if (numbers.size() != 6) {
      throw InputError(place + "found " + std::to_string(numbers.size()) +
                       " numbers; six were expected");
    }
    *value = Eigen::Map<const Vector6d>(numbers.data());
  }
};

/// Shows each type of option.
struct Show {
  const SimulationSetting& setting;

  std::string operator()(const double* value) const {
    // Without the noise of the unit's conversion.
    std::ostringstream text;
    text.precision(4);
    text << *value / setting.unit;
    return text.str();
  }
  std::string operator()(const std::optional<double>*) const { return ""; }
  std::string operator()(const int* value) const { return std::to_string(*value); }
  std::string operator()(const std::string* value) const { return *value; }
  std::string operator()(const Vector6d* value) const {
    std::string text;
    for (const double number : *value) text += (text.empty() ? "" : ",") + FormatNumber(number);
    return text;
  }
};

}  // namespace

std::vector<SimulationSetting> SimulationSettings(VirtualExperimentOptions& options) {
  Settings list;
  AddTruth(options.truth, list);
  AddSensors(options.sensors, list);
  AddInstruments(options.instruments, list);
  AddCauses(options, list);
  AddPlay(options.physics, options.motion, list);
  AddFaults(options.faults, list);
  return list;
}

std::string SettingText(const SimulationSetting& setting) {
  return std::visit(Show{setting}, setting.target);
}

void ApplySetting(const SimulationSetting& setting, const std::string& text,
                  const std::string& place) {
  std::visit(Assign{setting, text, place}, setting.target);
}

void CheckRanges(const VirtualExperimentOptions& options) {
  const TruthOptions& truth = options.truth;
  const SensorOptions& sensors = options.sensors;
  const auto check = [](const std::string& least_key, double least, const std::string& most_key,
                        double most) {
    if (least <= most) return;
    throw InputError(least_key + " is " + FormatNumber(least) + ", above " + most_key + ", " +
                     FormatNumber(most) + "; a range begins with the smaller number");
  };
  check("upper_stiffness_least", truth.upper_stiffness_least, "upper_stiffness_most",
        truth.upper_stiffness_most);
  check("leg_stiffness_least", truth.leg_stiffness_least, "leg_stiffness_most",
        truth.leg_stiffness_most);
  check("least_lag_s", sensors.least_lag_s, "largest_lag_s", sensors.largest_lag_s);
}

void CheckTargets(const VirtualExperimentOptions& options) {
  const VirtualExperimentOptions none;
  const auto check = [](const std::string& key, double size, double usual, const std::string& of,
                        const std::string& target) {
    if (size == usual || !target.empty()) return;
    throw InputError(key + " without " + of + ": nothing says whose it is");
  };
  const SensorOptions& sensors = options.sensors;
  const std::string& joint = sensors.cause_joint;
  check("eccentricity_mrad", sensors.eccentricity, 0.0, "cause_joint", joint);
  check("gear_error_share", sensors.gear_error, 0.0, "cause_joint", joint);
  check("backlash_mrad", sensors.backlash, 0.0, "cause_joint", joint);
  check("hysteresis_mrad", sensors.hysteresis, 0.0, "cause_joint", joint);
  const TruthOptions& truth = options.truth;
  check("heavy_share", truth.heavy_share, none.truth.heavy_share, "heavy_link", truth.heavy_link);
  check("creep_mm_per_h", truth.creep, 0.0, "creeping_marker", truth.creeping_marker);
  const Faults& faults = options.faults;
  check("knock_mm", faults.knock, none.faults.knock, "knocked_cluster", faults.knocked_cluster);
  check("saturation_nm", faults.saturation, none.faults.saturation, "saturated_torque_sensor",
        faults.saturated_torque_sensor);
}

void ReadSimulationSettings(const std::filesystem::path& file, VirtualExperimentOptions& options) {
  const YamlValue root = YamlValue::Parse(ReadFile(file), file.string());
  const Settings settings = SimulationSettings(options);
  std::vector<std::string> known;
  for (const SimulationSetting& setting : settings) known.push_back(setting.key);
  root.ExpectKeys(known);
  for (const SimulationSetting& setting : settings) {
    const auto value = root.Find(setting.key);
    if (!value) continue;
    const std::string place = Place(file.string(), value->line()) + "key '" + setting.key + "': ";
    if (std::holds_alternative<Vector6d*>(setting.target)) {
      std::string text;
      for (const YamlValue& item : value->Items()) text += item.Text() + " ";
      ApplySetting(setting, text, place);
    } else {
      ApplySetting(setting, value->Text(), place);
    }
  }
}

}  // namespace elastocal
