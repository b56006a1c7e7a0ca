// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/calibration_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "elastocal/files/output_files.hpp"
#include "elastocal/files/yaml_value.hpp"
#include "elastocal/io/fingerprint.hpp"
#include "elastocal/io/parameter_units.hpp"
#include "elastocal/io/sole_springs_file.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {
constexpr const char* kFormat = "elastocal-calibration-1";
constexpr const char* kWhatCalibrateWrites = "format elastocal-calibration-1 of calibrate's file";
constexpr std::int64_t kMostEstimates = 1000000;

void EmitParameter(const CalibrationResult& result, int i, YAML::Emitter& yaml) {
  const Parameter& parameter = result.model.parameters[i];
  yaml << YAML::Flow << YAML::BeginMap;
  yaml << YAML::Key << "name" << YAML::Value << parameter.name;
  yaml << YAML::Key << "unit" << YAML::Value << UnitName(parameter.unit);
  yaml << YAML::Key << "value" << YAML::Value << FormatNumber(result.delta[i]);
  if (std::isfinite(result.sd[i])) {
    yaml << YAML::Key << "sd" << YAML::Value << FormatNumber(result.sd[i]);
  }
  yaml << YAML::Key << "status" << YAML::Value << StatusName(result.status[i]);
  if (result.status[i] == ParameterStatus::kEstimated) {
    yaml << YAML::Key << "significant" << YAML::Value << Significant(result, i);
  }
  yaml << YAML::EndMap;
}

void EmitNumbers(const Eigen::Vector3d& numbers, YAML::Emitter& yaml) {
  yaml << YAML::Flow << YAML::BeginSeq;
  for (double number : numbers) yaml << FormatNumber(number);
  yaml << YAML::EndSeq;
}

void EmitWaist(const Transform& T_ref_waist, const Eigen::Vector3d& gravity, YAML::Emitter& yaml) {
  yaml << YAML::Key << "waist" << YAML::Value << YAML::Flow << YAML::BeginMap;
  yaml << YAML::Key << "xyz_m" << YAML::Value;
  EmitNumbers(T_ref_waist.translation(), yaml);
  yaml << YAML::Key << "rpy_rad" << YAML::Value;
  EmitNumbers(ToRpy(T_ref_waist.linear(), Eigen::Vector3d::Zero()), yaml);
  yaml << YAML::Key << "up" << YAML::Value;
  EmitNumbers(Eigen::Vector3d::Zero() - gravity.normalized(), yaml);  // no -0
  yaml << YAML::EndMap
       << YAML::Comment("in the frame of the recording; waist.T0 deviates from there");
}

void EmitMarkers(const ErrorModel& model, YAML::Emitter& yaml) {
  if (model.markers.empty()) return;
  yaml << YAML::Key << "markers" << YAML::Value
       << YAML::Comment("where the project has them on their links; marker.* deviates from there");
  yaml << YAML::BeginSeq;
  for (const Marker& marker : model.markers) {
    yaml << YAML::Flow << YAML::BeginMap;
    yaml << YAML::Key << "name" << YAML::Value << marker.name;
    yaml << YAML::Key << "link" << YAML::Value << model.tree.links[Size(marker.link)].name;
    yaml << YAML::Key << "xyz_m" << YAML::Value;
    EmitNumbers(marker.p_link_marker, yaml);
    yaml << YAML::EndMap;
  }
  yaml << YAML::EndSeq;
}

/// Writes waist and markers of the uncalibrated robot, fitted to the same recording.
void EmitUncalibrated(const CalibrationResult& result, YAML::Emitter& yaml) {
  yaml << YAML::Key << "uncalibrated" << YAML::Value << YAML::BeginMap;
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    const Parameter& parameter = result.model.parameters[i];
    if (!IsExternal(parameter.kind)) continue;
    yaml << YAML::Key << parameter.name << YAML::Value << FormatNumber(result.delta[i]);
  }
  yaml << YAML::EndMap;
}

/// Writes the errors in the calibrated URDF, if they are those of another model.
void EmitInUrdf(const CalibrationResult& result, YAML::Emitter& yaml) {
  yaml << YAML::Key << "urdf" << YAML::Value << YAML::BeginMap;
  yaml << YAML::Key << "model" << YAML::Value << ModelKindName(result.kind)
       << YAML::Comment("the calibrated URDF has the errors of this model");
  yaml << YAML::Key << "errors" << YAML::Value << YAML::BeginMap;
  for (int i = 0; i < result.model.parameter_count(); ++i) {
    const Parameter& parameter = result.model.parameters[i];
    if (IsExternal(parameter.kind) || IsElastic(parameter.kind)) continue;
    yaml << YAML::Key << parameter.name << YAML::Value << FormatNumber(result.delta[i]);
  }
  yaml << YAML::EndMap << YAML::EndMap;
}

constexpr ParameterStatus kStatuses[] = {ParameterStatus::kEstimated, ParameterStatus::kUnsupported,
                                         ParameterStatus::kHeld, ParameterStatus::kNotInModel};

ParameterStatus ReadStatus(const YamlValue& value) {
  const std::string text = value.Text();
  std::string known;
  for (const ParameterStatus status : kStatuses) {
    if (text == StatusName(status)) return status;
    known += (known.empty() ? "" : ", ") + std::string(StatusName(status));
  }
  value.Expect(false, "one of " + known);
  return ParameterStatus::kNotInModel;
}

/// The value of a parameter; an angle is at most half a turn.
double ReadError(const YamlValue& value, double most) {
  if (std::isinf(most)) return value.Number();
  return value.Number({.lower = -most, .upper = most, .with_lower = true, .with_upper = true});
}

ParameterEstimate ReadParameter(const YamlValue& item) {
  ParameterEstimate parameter;
  parameter.name = item.Get("name").Text();
  const YamlValue unit = item.Get("unit");
  parameter.unit = unit.Text();
  const auto [units, most] = UnitsOf(parameter.name);
  unit.Expect(std::find(units.begin(), units.end(), parameter.unit) != units.end(),
              fmt::format("{}, the unit of {}", fmt::join(units, " or "), Quote(parameter.name)));
  parameter.external =
      parameter.name.starts_with("waist.T0.") || parameter.name.starts_with("marker.");
  parameter.value = ReadError(item.Get("value"), most);
  parameter.status = ReadStatus(item.Get("status"));
  parameter.sd = std::numeric_limits<double>::quiet_NaN();
  if (parameter.status == ParameterStatus::kEstimated || item.Find("sd")) {
    parameter.sd = item.Get("sd").Number();
    item.Get("sd").Expect(parameter.sd > 0.0, "a number above 0");
  }
  return parameter;
}

/// The joint or chain that the name of a parameter begins with.
std::string OwnerOf(const std::string& parameter) {
  return parameter.substr(0, parameter.rfind('.'));
}

constexpr const char *kLeft = "rmse_3d_mm", *kHeldOutUrdf = "held_out_urdf_mm",
                     *kHeldOut = "held_out_mm";

/// An error of markers, m; 0 where the file is silent.
double ReadErrorMm(const YamlValue& root, const char* key) {
  const auto error = root.Find(key);
  if (!error) return 0.0;
  error->Expect(error->Number() >= 0.0, "a length");
  return 1e-3 * error->Number();
}

void WriteErrorMm(const char* key, double error, const char* comment, YAML::Emitter& yaml) {
  if (!(error > 0.0)) return;
  yaml << YAML::Key << key << YAML::Value << FormatNumber(1e3 * error) << YAML::Comment(comment);
}

Eigen::Vector3d ReadNumbers(const YamlValue& value) {
  const std::vector<YamlValue> items = value.Items();
  value.Expect(items.size() == 3, "three numbers");
  return {items[0].Number(), items[1].Number(), items[2].Number()};
}

}  // namespace

std::string MakeCalibrationYaml(const CalibrationResult& result, const std::string& recording,
                                ZeroOffsets zero_offsets, const BesideCalibration& beside) {
  YAML::Emitter yaml;
  yaml << YAML::Comment("Written by elastocal: deviations from the nominal URDF, in SI units.");
  yaml << YAML::BeginMap;
  yaml << YAML::Key << "format" << YAML::Value << kFormat;
  yaml << YAML::Key << "robot" << YAML::Value << result.model.tree.name;
  yaml << YAML::Key << "nominal" << YAML::Value << YAML::DoubleQuoted
       << NominalFingerprint(result.model)
       << YAML::Comment("fingerprint of the robot that these are deviations from");
  yaml << YAML::Key << "recording" << YAML::Value << recording;
  yaml << YAML::Key << "model" << YAML::Value << ModelKindName(result.kind);
  yaml << YAML::Key << "zero_offsets" << YAML::Value
       << (zero_offsets == ZeroOffsets::kOrigin ? "origin" : "encoder")
       << YAML::Comment("where the calibrated URDF has the joints' zero offsets");
  yaml << YAML::Key << "gauge" << YAML::Value << GaugeText(result.gauge)
       << YAML::Comment("who says where the root link's frame is");
  yaml << YAML::Key << "termination" << YAML::Value << TerminationName(result.termination);
  yaml << YAML::Key << "marker_sd_mm" << YAML::Value << FormatNumber(1e3 * result.marker_sd);
  yaml << YAML::Key << "cluster_factor" << YAML::Value
       << FormatNumber(result.posterior.cluster_factor);
  WriteErrorMm(kLeft, beside.rmse_3d, "what is left of its own markers", yaml);
  WriteErrorMm(kHeldOutUrdf, beside.held_out.urdf, "of markers left out, by the URDF", yaml);
  WriteErrorMm(kHeldOut, beside.held_out.compensated, "by these parameters", yaml);
  yaml << YAML::Key << "prior_scale" << YAML::Value << YAML::Flow << YAML::BeginMap;
  for (int g = 0; g < kPriorGroupCount; ++g) {
    const bool corrections = g == static_cast<int>(PriorGroup::kCorrections);
    if (corrections && result.model.elasticity.corrections.empty()) continue;
    yaml << YAML::Key << PriorGroupName(static_cast<PriorGroup>(g)) << YAML::Value
         << FormatNumber(result.prior_scale.factor[g]);
  }
  yaml << YAML::EndMap;
  yaml << YAML::Key << "interval_95_in_sd" << YAML::Value << FormatNumber(result.interval_factor);
  if (result.placement.empty()) EmitWaist(result.model.T_ref_waist, beside.gravity, yaml);
  if (const auto held = FindHeldRoot(result.placement, beside.gravity)) EmitHeldRoot(*held, yaml);
  EmitMarkers(result.model, yaml);
  if (beside.uncalibrated != nullptr) EmitUncalibrated(*beside.uncalibrated, yaml);
  if (beside.in_urdf != nullptr) EmitInUrdf(*beside.in_urdf, yaml);
  EmitSoleSprings(beside.soles, yaml);
  yaml << YAML::Key << "parameter_count" << YAML::Value << result.model.parameter_count()
       << YAML::Comment("a file that was cut has fewer");
  yaml << YAML::Key << "parameters" << YAML::Value << YAML::BeginSeq;
  for (int i = 0; i < result.model.parameter_count(); ++i) EmitParameter(result, i, yaml);
  yaml << YAML::EndSeq << YAML::EndMap;
  return std::string(yaml.c_str()) + "\n";
}

std::string MakeCalibrationYaml(const CalibrationEstimate& estimate) {
  YAML::Emitter yaml;
  yaml << YAML::Comment("Written by elastocal: deviations from the nominal URDF, in SI units.");
  yaml << YAML::BeginMap;
  yaml << YAML::Key << "format" << YAML::Value << kFormat;
  yaml << YAML::Key << "robot" << YAML::Value << estimate.robot;
  yaml << YAML::Key << "nominal" << YAML::Value << YAML::DoubleQuoted << estimate.nominal;
  yaml << YAML::Key << "recording" << YAML::Value << estimate.recording;
  yaml << YAML::Key << "model" << YAML::Value << estimate.model;
  yaml << YAML::Key << "gauge" << YAML::Value << estimate.gauge;
  yaml << YAML::Key << "interval_95_in_sd" << YAML::Value << FormatNumber(estimate.interval_factor);
  yaml << YAML::Key << "parameter_count" << YAML::Value << estimate.parameters.size();
  yaml << YAML::Key << "parameters" << YAML::Value << YAML::BeginSeq;
  for (const ParameterEstimate& one : estimate.parameters) {
    yaml << YAML::Flow << YAML::BeginMap;
    yaml << YAML::Key << "name" << YAML::Value << one.name;
    yaml << YAML::Key << "unit" << YAML::Value << one.unit;
    yaml << YAML::Key << "value" << YAML::Value << FormatNumber(one.value);
    if (std::isfinite(one.sd)) yaml << YAML::Key << "sd" << YAML::Value << FormatNumber(one.sd);
    yaml << YAML::Key << "status" << YAML::Value << StatusName(one.status) << YAML::EndMap;
  }
  yaml << YAML::EndSeq << YAML::EndMap;
  return std::string(yaml.c_str()) + "\n";
}

CalibrationEstimate ReadEstimate(const std::filesystem::path& file) {
  return ParseEstimate(ReadFile(file), file.string());
}

CalibrationEstimate ParseEstimate(const std::string& text, const std::string& source) {
  const YamlValue root = YamlValue::Parse(text, source);
  const YamlValue format = root.Find("format").value_or(root);
  format.Expect(format.IsScalar() && format.Text() == kFormat, kWhatCalibrateWrites);
  CalibrationEstimate estimate;
  estimate.source = source;
  estimate.robot = root.Get("robot").Text();
  estimate.nominal = root.Get("nominal").Text();
  estimate.recording = root.Get("recording").Text();
  const YamlValue list = root.Get("parameters");
  std::set<std::string> names;
  for (const YamlValue& item : list.Items()) {
    estimate.parameters.push_back(ReadParameter(item));
    item.Get("name").Expect(names.insert(estimate.parameters.back().name).second,
                            "every parameter once");
  }
  if (names.empty()) list.Fail("found no parameter; those of a calibration were expected");
  if (const auto count = root.Find("parameter_count")) {
    const auto found = static_cast<std::int64_t>(names.size());
    if (count->Integer(1, kMostEstimates) != found) {
      list.Fail("found " + std::to_string(found) + " parameters; " +
                std::to_string(count->Integer(1, kMostEstimates)) +
                " were expected (parameter_count): the file was cut or changed");
    }
  }
  estimate.model = root.Get("model").Text();
  if (const auto gauge = root.Find("gauge")) estimate.gauge = gauge->Text();
  if (const auto markers = root.Find("markers")) {
    std::set<std::string> seen;
    for (const YamlValue& item : markers->Items()) {
      item.Get("name").Expect(seen.insert(item.Get("name").Text()).second, "every marker once");
      estimate.markers.push_back(
          {item.Get("name").Text(), item.Get("link").Text(), ReadNumbers(item.Get("xyz_m"))});
    }
  }
  const YamlValue factor = root.Get("interval_95_in_sd");
  estimate.interval_factor = factor.Number();
  factor.Expect(estimate.interval_factor >= 1.95 && estimate.interval_factor <= 12.8,
                "1.96 (normal distribution) to 12.7 (one degree of freedom)");
  return estimate;
}

StoredCalibration ReadCalibration(const std::filesystem::path& file) {
  const std::string text = ReadFile(file);
  const CalibrationEstimate estimate = ParseEstimate(text, file.string());
  const YamlValue root = YamlValue::Parse(text, file.string());
  StoredCalibration stored;
  stored.source = file.string();
  stored.fingerprint = CalibrationFingerprint(text);
  for (const YamlValue& item : root.Get("parameters").Items()) {
    stored.lines[item.Get("name").Text()] = item.line();
  }
  stored.robot = estimate.robot;
  stored.nominal = estimate.nominal;
  stored.recording = estimate.recording;
  stored.rmse_3d = ReadErrorMm(root, kLeft);
  stored.held_out = {ReadErrorMm(root, kHeldOutUrdf), ReadErrorMm(root, kHeldOut)};
  stored.soles = ReadSoleSprings(root);
  if (const auto factor = root.Find("cluster_factor")) {
    factor->Expect(factor->Number() >= 0.0, "a ratio of variances");
    stored.scatter_sd =
        1e-3 * root.Get("marker_sd_mm").Number() * std::sqrt(std::max(1.0, factor->Number()));
  }
  for (const ParameterEstimate& parameter : estimate.parameters) {
    (parameter.external ? stored.externals : stored.joint_errors)[parameter.name] = parameter.value;
  }
  if (const auto waist = root.Find("waist")) {
    stored.T_ref_waist =
        FromXyzRpy(ReadNumbers(waist->Get("xyz_m")), ReadNumbers(waist->Get("rpy_rad")));
    if (const auto up = waist->Find("up")) {
      const Eigen::Vector3d direction = ReadNumbers(*up);
      up->Expect(direction.norm() > 0.0, "a direction");
      stored.gravity = -kGravity.norm() * direction.normalized();
    }
  }
  stored.held_root = ReadHeldRoot(root);
  if (const auto uncalibrated = root.Find("uncalibrated")) {
    for (const auto& [name, value] : uncalibrated->Entries()) {
      stored.uncalibrated_externals[name] = value.Number();
    }
  }
  if (const auto urdf = root.Find("urdf")) {
    const YamlValue errors = urdf->Get("errors");
    for (const auto& [name, value] : errors.Entries()) {
      value.Expect(stored.joint_errors.contains(name), "a parameter that the list below has");
      stored.urdf_errors[name] = ReadError(value, UnitsOf(name).most);
    }
  }
  return stored;
}

StoredCalibration AsInUrdf(StoredCalibration stored) {
  if (stored.urdf_errors.empty()) return stored;
  for (auto& [name, value] : stored.joint_errors) {
    const auto found = stored.urdf_errors.find(name);
    value = found == stored.urdf_errors.end() ? 0.0 : found->second;
  }
  return stored;
}

void CheckParameters(const StoredCalibration& stored, const ErrorModel& model,
                     const std::vector<std::string>& chains) {
  std::set<std::string> owners(chains.begin(), chains.end());
  owners.insert({"waist", "gravity"});  // they have corrections
  for (const Link& link : model.tree.links) owners.insert(link.name);
  for (const Joint& joint : model.tree.joints) owners.insert(joint.name);
  for (const Linkage& linkage : model.tree.linkages) {
    for (const Rod& rod : linkage.rods) owners.insert(rod.motor);
  }
  std::set<std::string> calibrated;
  for (const auto& [name, value] : stored.joint_errors) {
    const std::string owner = OwnerOf(name);
    if (!owners.contains(owner)) {
      throw InputError(Place(stored.source, stored.lines.at(name)) + "parameter " + Quote(name) +
                       ": the robot has no joint or chain " + Quote(owner) +
                       DidYouMean(owner.substr(0, 60), owners));
    }
    calibrated.insert(owner);
  }
  for (const Parameter& parameter : model.parameters) {
    if (IsExternal(parameter.kind) || IsElastic(parameter.kind)) continue;
    const std::string owner = OwnerOf(parameter.name);
    if (!calibrated.contains(owner) || stored.joint_errors.contains(parameter.name)) continue;
    throw InputError(stored.source + ": no parameter " + Quote(parameter.name) +
                     ", although the file has others of this joint: it was cut or changed");
  }
}

}  // namespace elastocal
