// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/export_calibration.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "elastocal/description/calibrated_mjcf.hpp"
#include "elastocal/description/calibrated_urdf.hpp"
#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/description/urdf_writer.hpp"
#include "elastocal/io/linkage_file.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/runtime_robot.hpp"
#include "elastocal/runtime/c_header.hpp"
#include "elastocal/tables/read_file.hpp"

namespace elastocal {
namespace {

/// A name as XML and YAML take it, and C.
std::string CPrefix(const std::string& name) {
  std::string prefix;
  for (unsigned char c : name) {
    prefix += std::isalnum(c) != 0 ? static_cast<char>(std::tolower(c)) : '_';
  }
  if (prefix.empty() || std::isdigit(static_cast<unsigned char>(prefix[0])) != 0) {
    prefix = "robot_" + prefix;
  }
  return prefix;
}

/// What the header says of each joint and leg: its errors with unit and standard deviation.
std::map<std::string, std::vector<std::string>> ParameterComments(
    const CalibrationEstimate& estimate) {
  std::map<std::string, std::vector<std::string>> comments;
  for (const ParameterEstimate& parameter : estimate.parameters) {
    const std::size_t dot = parameter.name.rfind('.');
    comments[parameter.name.substr(0, dot)].push_back(
        fmt::format("{} = {:.6g} {}, sd {:.2g}", parameter.name.substr(dot + 1), parameter.value,
                    parameter.unit, parameter.sd));
  }
  return comments;
}

CalibrationResult ResultOf(const StoredRobot& robot) {
  CalibrationResult result;
  result.model = robot.model;
  result.delta = robot.errors;
  return result;
}

CalibratedUrdf UrdfOf(const CalibratedRobot& robot, const StoredCalibration& calibration,
                      ZeroOffsets zero_offsets) {
  const CalibrationResult result = ResultOf(RestoreRobot(robot.project, calibration));
  const std::string file = robot.project.urdf.string();
  return MakeCalibratedUrdf(ReadFile(robot.project.urdf), file, result, zero_offsets);
}

std::string MjcfOf(const CalibratedRobot& robot, const CalibratedUrdf& apart,
                   const std::filesystem::path& mjcf) {
  if (mjcf.empty()) throw InputError("format mjcf: the nominal model was expected (--mjcf FILE)");
  RobotTree calibrated = ParseUrdf(apart.text, robot.project.urdf.string() + " (calibrated)");
  return MakeCalibratedMjcf(ReadFile(mjcf), mjcf.string(), robot.project.tree, calibrated,
                            apart.encoder_offsets);
}

std::string PalYaml(const CalibratedUrdf& urdf, const std::string& heading) {
  std::string text = "# " + heading +
                     "\n# Metres and radians, to be added to the origin of the joint, and the zero "
                     "of its encoder:\n# position in the URDF = position of the encoder + offset\n";
  std::map<std::string, double> zeros = urdf.encoder_offsets;
  for (const auto& [joint, origin] : urdf.calibrated) zeros.emplace(joint, 0.0);
  for (const auto& [joint, zero] : zeros) {
    const auto calibrated = urdf.calibrated.find(joint);
    UrdfOrigin change{};
    if (calibrated != urdf.calibrated.end()) {
      const UrdfOrigin& nominal = urdf.nominal.at(joint);
      change.xyz = calibrated->second.xyz - nominal.xyz;
      change.rpy = calibrated->second.rpy - nominal.rpy;
    } else {
      change.xyz.setZero();
      change.rpy.setZero();
    }
    text += fmt::format(
        "{}: {{x: {:.17g}, y: {:.17g}, z: {:.17g}, roll: {:.17g}, pitch: {:.17g}, yaw: {:.17g}, "
        "offset: {:.17g}}}\n",
        joint, change.xyz.x(), change.xyz.y(), change.xyz.z(), change.rpy.x(), change.rpy.y(),
        change.rpy.z(), zero);
  }
  return text;
}

std::string XmlText(const std::string& text) {
  std::string safe;
  for (char c : text) {
    if (c == '<' || c == '>' || c == '&' || c == '"') {
      safe += fmt::format("&#{};", static_cast<int>(c));
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string Ros2Transmissions(const CalibratedUrdf& urdf, const std::string& heading) {
  std::string text = "<!-- " + XmlText(heading) +
                     "\n     Position of the joint = position of the actuator / reduction + offset "
                     "(rad or m). Belongs to the\n     URDF of export format urdf_encoder. -->\n";
  for (const auto& [joint, zero] : urdf.encoder_offsets) {
    text += fmt::format(
        "<transmission name=\"{0}_transmission\">\n"
        "  <plugin>transmission_interface/SimpleTransmission</plugin>\n"
        "  <joint name=\"{0}\" role=\"joint1\">\n    <offset>{1:.17g}</offset>\n  </joint>\n"
        "</transmission>\n",
        XmlText(joint), zero);
  }
  return text;
}

/// The calibration with joints that it hardly tells as they were.
StoredCalibration KeepSignificant(const CalibratedRobot& robot, const CalibrationEstimate& estimate,
                                  double least) {
  StoredCalibration kept = robot.calibration;
  if (!(least > 0.0)) return kept;
  std::map<std::string, double> largest;
  for (const ParameterEstimate& parameter : estimate.parameters) {
    double& most = largest[OwnerName(parameter.name)];
    if (parameter.sd > 0.0) most = std::max(most, std::abs(parameter.value) / parameter.sd);
  }
  for (auto& [name, value] : kept.joint_errors) {
    if (largest[OwnerName(name)] < least) value = 0.0;
  }
  return kept;
}

}  // namespace

std::vector<ExportFormat> ExportFormats() {
  return {{"c99", "a self-contained C99 header: forward, correct and command, with elasticity"},
          {"runtime", "the model that elastocal::Compensator reads, with elasticity"},
          {"urdf", "the URDF with calibrated joint origins"},
          {"urdf_encoder", "the same with the joints' zeros left to the encoders (see pal)"},
          {"urdf_rising", "that one, the zeros added to <calibration rising>"},
          {"linkages", "the calibrated rods of a robot with linkages, as a section of a project"},
          {"xacro", "what is added to the joint origins, as xacro properties"},
          {"pal", "seven numbers a joint: xyz, rpy and the zero of the encoder (YAML)"},
          {"ros2_control", "the zeros of the encoders as offsets of transmissions"},
          {"mjcf", "the model of --mjcf with calibrated bodies, the zeros as ref of its joints"}};
}

std::string ExportCalibration(const CalibratedRobot& robot, const ExportOptions& options) {
  const CalibrationEstimate estimate = ReadEstimate(robot.calibration.source);
  const StoredCalibration calibration =
      KeepSignificant(robot, estimate, options.least_significance);
  const std::string heading =
      fmt::format("{}, calibrated from {}. Made by elastocal {} of {}", robot.project.tree.name,
                  robot.calibration.recording, options.version, robot.calibration.source);
  const std::string& format = options.format;
  if (format == "c99") {
    const std::string prefix =
        options.prefix.empty() ? CPrefix(robot.project.tree.name) : options.prefix;
    if (prefix != CPrefix(prefix) && prefix.find_first_not_of("abcdefghijklmnopqrstuvwxyz"
                                                              "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                                              "0123456789_") != std::string::npos) {
      throw InputError("prefix '" + prefix + "': letters, digits and '_' were expected");
    }
    return MakeCHeader(MakeRuntimeModel(robot.project, calibration),
                       {prefix, heading, ParameterComments(estimate), {}});
  }
  if (format == "runtime") {
    std::ostringstream out;
    WriteRuntimeModel(MakeRuntimeModel(robot.project, calibration), out);
    return out.str();
  }
  if (format == "linkages") {
    if (robot.project.tree.linkages.empty()) {
      throw InputError("format linkages: the robot has no linkages");
    }
    return MakeLinkagesYaml(ResultOf(RestoreRobot(robot.project, calibration)));
  }
  if (format == "urdf") return UrdfOf(robot, calibration, ZeroOffsets::kOrigin).text;
  const CalibratedUrdf apart = UrdfOf(robot, calibration, ZeroOffsets::kEncoder);
  if (format == "urdf_encoder") return apart.text;
  if (format == "urdf_rising") {
    return ShiftReferencePositions(apart.text, robot.project.urdf.string(), apart.encoder_offsets);
  }
  if (format == "mjcf") return MjcfOf(robot, apart, options.mjcf);
  if (format == "xacro") return MakeXacroOffsets(apart);
  if (format == "pal") return PalYaml(apart, heading);
  if (format == "ros2_control") return Ros2Transmissions(apart, heading);
  std::vector<std::string> known;
  for (const ExportFormat& one : ExportFormats()) known.push_back(one.name);
  throw InputError("export format '" + format + "'" + DidYouMean(format, known));
}

}  // namespace elastocal
