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
  list.insert(list.end(),
              {{g, "upper_offset_deg", &truth.upper_offset_sd, kRadiansPerDegree, 0, 45,
                "Joint zeros of head, arms and trunk"},
               {g, "leg_offset_deg", &truth.leg_offset_sd, kRadiansPerDegree, 0, 45,
                "Joint zeros of the legs"},
               {g, "length_mm", &truth.length_sd, kMillimetre, 0, 100,
                "Placement of every joint, along each direction"},
               {g, "angle_deg", &truth.angle_sd, kRadiansPerDegree, 0, 45,
                "Placement of every joint, about each axis"},
               {g, "upper_geometry_scale", &truth.upper_geometry_scale, 1, 0, 100,
                "Factor on the geometric errors of head, arms and trunk"},
               {g, "leg_geometry_scale", &truth.leg_geometry_scale, 1, 0, 100,
                "Factor on the geometric errors of the legs"},
               {g, "series_share", &truth.series.share, 1, 0, 1,
                "Share of the variance of each error that all robots of a series have in common"},
               {g, "series_seed", &truth.series.seed, 1, 0, 1e9,
                "Seed of the errors that a series has in common"},
               {g, "marker_mm", &truth.marker_sd, kMillimetre, 0, 100,
                "Places of markers on their links, each coordinate"}});
  const std::string e = "True elasticity";
  list.insert(list.end(),
              {{e, "upper_stiffness_least", &truth.upper_stiffness_least, 1, 1, kStiffest,
                "Smallest joint stiffness of head, arms and trunk, N.m/rad"},
               {e, "upper_stiffness_most", &truth.upper_stiffness_most, 1, 1, kStiffest,
                "Largest joint stiffness of head, arms and trunk, N.m/rad"},
               {e, "leg_stiffness_least", &truth.leg_stiffness_least, 1, 1, kStiffest,
                "Smallest joint stiffness of the legs, N.m/rad"},
               {e, "leg_stiffness_most", &truth.leg_stiffness_most, 1, 1, kStiffest,
                "Largest joint stiffness of the legs, N.m/rad"},
               {e, "slide_stiffness_least", &truth.slide_stiffness_least, 1, 1, kStiffest,
                "Smallest stiffness of prismatic joints along their axes, N/m"},
               {e, "slide_stiffness_most", &truth.slide_stiffness_most, 1, 1, kStiffest,
                "Largest stiffness of prismatic joints along their axes, N/m"},
               {e, "upper_elasticity_scale", &truth.upper_elasticity_scale, 1, 0, 1000,
                "Factor on compliances of head, arms and trunk; 0: rigid"},
               {e, "leg_elasticity_scale", &truth.leg_elasticity_scale, 1, 0, 1000,
                "Factor on compliances of the legs; 0: rigid"},
               {e, "pelvis_compliance", &truth.pelvis_compliance, 1, 0, 1,
                "Compliance from the root link to each hip, m/N x 3 and rad/(N.m) x 3"},
               {e, "hip_link_compliance", &truth.hip_link_compliance, 1, 0, 1,
                "Compliance of each link in the upper half of a leg, in the same units"},
               {e, "shank_link_compliance", &truth.shank_link_compliance, 1, 0, 1,
                "Compliance of each link in the lower half of a leg, in the same units"},
               {e, "link_compliance_spread_share", &truth.link_compliance_spread, 1, 0, 1,
                "Share by which the compliance of each link is drawn larger or smaller"}});
  const std::string o = "True inertia, friction and torque sensors";
  list.insert(list.end(), {{o, "mass_share", &truth.mass_sd, 1, 0, 1,
                            "Masses of links, standard deviation as a share"},
                           {o, "com_mm", &truth.com_sd, kMillimetre, 0, 1000,
                            "Centres of mass, standard deviation of each coordinate"},
                           {o, "friction_share", &truth.friction_share, 1, 0, 1,
                            "Coulomb friction as a share of a joint's largest effort"},
                           {o, "torque_gain_share", &truth.torque_gain_sd, 1, 0, 1,
                            "Gain of torque sensors, standard deviation"},
                           {o, "torque_bias_nm", &truth.torque_bias_sd, 1, 0, 1000,
                            "Bias of torque sensors, standard deviation"}});
}

void AddSensors(SensorOptions& sensors, Settings& list) {
  const std::string c = "Cameras";
  list.insert(
      list.end(),
      {{c, "marker_noise_mm", &sensors.marker_noise_sd, kMillimetre, 0, 100,
        "Noise of a coordinate of a marker"},
       {c, "gaps_per_minute", &sensors.gaps_per_minute, 1, 0, 600, "Occlusions of a marker"},
       {c, "mean_gap_s", &sensors.mean_gap_s, 1, 0, 600, "Mean length of an occlusion"},
       {c, "outlier_share", &sensors.outlier_share, 1, 0, 1,
        "Share of marker samples that are outliers"},
       {c, "largest_outlier_mm", &sensors.largest_outlier, kMillimetre, 0, 10000,
        "Largest displacement of an outlier"},
       {c, "swaps_per_minute", &sensors.swaps_per_minute, 1, 0, 600,
        "Exchanges of labels within a cluster"},
       {c, "mean_swap_s", &sensors.mean_swap_s, 1, 0, 600,
        "Mean length of an exchange of labels"}});
  const std::string l = "Joint log";
  list.insert(list.end(), {{l, "log_rate_hz", &sensors.log_rate_hz, 1, 1, 1e3, "Samples a second"},
                           {l, "least_lag_s", &sensors.least_lag_s, 1, -1e3, 1e3,
                            "Least time by which the robot's clock is behind the cameras'"},
                           {l, "largest_lag_s", &sensors.largest_lag_s, 1, -1e3, 1e3,
                            "Largest time by which the robot's clock is behind the cameras'"},
                           {l, "drift_ppm", &sensors.drift_size_ppm, 1, 0, 1e5,
                            "Size of the drift of the robot's clock, which is fast or slow"},
                           {l, "encoder_bits", &sensors.encoder_bits, 1, 0, 40,
                            "Bits of an encoder for a turn; 0: not quantised"},
                           {l, "torque_noise_nm", &sensors.torque_noise_sd, 1, 0, 1000,
                            "Noise of torque sensors"}});
}

void AddInstruments(InstrumentOptions& of, Settings& list) {
  const std::string i = "Instruments and touches (projects with contact or instruments)";
  list.insert(
      list.end(),
      {{i, "length_noise_mm", &of.length_sd, kMillimetre, 0, 1000,
        "Noise of positions, heights and wires"},
       {i, "rotation_noise_deg", &of.rotation_sd, kRadiansPerDegree, 0, 45,
        "Noise of attitudes, about each axis"},
       {i, "acceleration_noise", &of.acceleration_sd, 1, 0, 10, "Noise of accelerometers, m/s^2"},
       {i, "pixel_noise", &of.pixel_sd, 1, 0, 100, "Noise of each corner in an image, px"},
       {i, "pixel_blur", &of.blur_sd, 1, 0, 100,
        "Noise that all corners of an image have in common, px"},
       {i, "touch_height_mm", &of.touch_height_sd, kMillimetre, 0, 100,
        "Unevenness of table and plate: noise of the height of a touch"},
       {i, "touch_tilt_deg", &of.touch_tilt_sd, kRadiansPerDegree, 0, 45,
        "Unevenness of table and plate: noise of the tilts of a touch"},
       {i, "table_height_mm", &of.table_height_sd, kMillimetre, 0, 1000,
        "How far a table is from where the project has it"},
       {i, "plate_edge_mm", &of.plate_edge, kMillimetre, 1, 1000, "Edge of square plates"},
       {i, "touch_force_n", &of.touch.force, 1, 1, 1000,
        "Force that presses a plate on its table"}});
}

void AddCauses(VirtualExperimentOptions& options, Settings& list) {
  constexpr double kMilli = 1e-3;
  SensorOptions& sensors = options.sensors;
  TruthOptions& truth = options.truth;
  PhysicsOptions& physics = options.physics;
  const std::string c = "Causes beyond geometry and springs (none by default)";
  list.insert(
      list.end(),
      {{c, "cause_joint", &sensors.cause_joint, 1, 0, 0,
        "Joint that has the following four causes"},
       {c, "eccentricity_mrad", &sensors.eccentricity, kMilli, -100, 100,
        "Encoder's disc off centre: amplitude of sin q"},
       {c, "gear_error_share", &sensors.gear_error, 1, -0.1, 0.1, "Error of the gear's ratio"},
       {c, "backlash_mrad", &sensors.backlash, kMilli, -100, 100,
        "Half width of the play that the sign of the load crosses"},
       {c, "hysteresis_mrad", &sensors.hysteresis, kMilli, -100, 100,
        "Half width of the play that the direction of the last motion crosses"},
       {c, "cameras_drift_mm_per_h", &sensors.cameras_drift, kMillimetre, -1000, 1000,
        "Drift of all markers along x, in each trial"},
       {c, "heavy_link", &truth.heavy_link, 1, 0, 0, "Link that weighs more than described"},
       {c, "heavy_share", &truth.heavy_share, 1, -0.9, 10,
        "Share by which --heavy-link is heavier"},
       {c, "gravity_tilt_x_deg", &physics.gravity_tilt_x, kRadiansPerDegree, -20, 20,
        "The ground is not level: gravity is turned about x"},
       {c, "gravity_tilt_y_deg", &physics.gravity_tilt_y, kRadiansPerDegree, -20, 20,
        "The ground is not level: gravity is turned about y"},
       {c, "creeping_marker", &truth.creeping_marker, 1, 0, 0,
        "Marker that creeps along x of its link, in each trial"},
       {c, "creep_mm_per_h", &truth.creep, kMillimetre, -1000, 1000,
        "Speed of --creeping-marker"}});
}

void AddPlay(PhysicsOptions& physics, MotionOptions& motion, Settings& list) {
  const std::string p = "Physics";
  list.insert(list.end(),
              {{p, "time_step_s", &physics.time_step_s, 1, 1e-5, 0.01,
                "Time step of MuJoCo, of which a hundredth of a second is a whole number"},
               {p, "servo_stiffness", &physics.servo_stiffness, 1, 1, 1e9,
                "Stiffness of a servo as its encoder sees it, N.m/rad"},
               {p, "floor_friction", &physics.floor_friction, 1, 0, 10,
                "Friction of the floor under a robot that stands free"}});
  const std::string m = "Motions";
  list.insert(
      list.end(),
      {{m, "head_postures", &motion.head_postures, 1, 1, 10000, "Postures of short chains"},
       {m, "arm_postures", &motion.arm_postures, 1, 1, 10000, "Postures of each arm"},
       {m, "leg_postures", &motion.leg_postures, 1, 1, 10000, "Postures of each leg"},
       {m, "random_postures", &motion.random_postures, 1, 1, 10000,
        "Postures of each validation trial with random ones"},
       {m, "repetitions", &motion.repetitions, 1, 1, 10000,
        "Repetitions in the repeatability motion"},
       {m, "move_s", &motion.move_s, 1, 0.1, 1000, "Time from one posture to the next"},
       {m, "rest_s", &motion.rest_s, 1, 0.05, 1000, "Time at rest in a posture"},
       {m, "lead_in_s", &motion.lead_in_s, 1, 0, 1000, "Time at rest before the first motion"},
       {m, "counterweight_share", &motion.counterweight, 1, 0, 1,
        "How far the upper body moves to load the supporting leg"}});
}

void AddFaults(Faults& faults, Settings& list) {
  const std::string g = "Faults (none by default)";
  list.insert(list.end(), {{g, "missing_share", &faults.missing_share, 1, 0, 1,
                            "Share of marker samples that are missing"},
                           {g, "lost_marker", &faults.lost_marker, 1, 0, 0,
                            "Marker that is not seen in the second half of a trial"},
                           {g, "swapped_marker_a", &faults.swapped_marker_a, 1, 0, 0,
                            "Marker whose label is exchanged from a third of --fault-trial on"},
                           {g, "swapped_marker_b", &faults.swapped_marker_b, 1, 0, 0,
                            "Marker with which --swapped-marker-a is exchanged"},
                           {g, "swap_s", &faults.swap_s, 1, 0, 1e5, "Length of that exchange"},
                           {g, "knocked_cluster", &faults.knocked_cluster, 1, 0, 0,
                            "Cluster that is displaced from the middle of --fault-trial on"},
                           {g, "knock_mm", &faults.knock, kMillimetre, 0, 1000,
                            "Displacement of --knocked-cluster"},
                           {g, "dead_torque_sensor", &faults.dead_torque_sensor, 1, 0, 0,
                            "Joint whose torque sensor reads 0"},
                           {g, "saturated_torque_sensor", &faults.saturated_torque_sensor, 1, 0, 0,
                            "Joint whose torque sensor saturates"},
                           {g, "saturation_nm", &faults.saturation, 1, 0, 1e6,
                            "Largest torque, to either side, that --saturated-torque-sensor reads"},
                           {g, "lag_s", &faults.lag_s, 1, -1e3, 1e3,
                            "Time by which the robot's clock is behind, the same in all trials"},
                           {g, "log_cut_s", &faults.log_cut_s, 1, 0, 1e5,
                            "Time by which the log of --fault-trial ends too early"},
                           {g, "slipped_posture", &faults.slipped_posture, 1, 0, 10000,
                            "Posture of --fault-trial, from 1, in which the foot has slipped"},
                           {g, "slip_mm", &faults.slip, kMillimetre, 0, 1000,
                            "Displacement of the foot in --slipped-posture"},
                           {g, "fault_trial", &faults.trial, 1, 0, 0,
                            "Trial that has the faults; every trial if not given"}});
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

/// Sets an option of each type from text.
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

/// Shows an option of each type.
struct Show {
  const SimulationSetting& setting;

  std::string operator()(const double* value) const {
    // Without rounding errors of the unit's conversion.
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
  check("slide_stiffness_least", truth.slide_stiffness_least, "slide_stiffness_most",
        truth.slide_stiffness_most);
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
