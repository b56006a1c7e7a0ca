#include "elastocal/io/calibration_file.hpp"

#include <cmath>

#include <yaml-cpp/yaml.h>

#include "elastocal/io/output_files.hpp"
#include "elastocal/io/text.hpp"
#include "elastocal/io/yaml_value.hpp"

namespace elastocal {
namespace {

constexpr const char* kFormat = "elastocal-calibration-1";

const char* UnitName(ParameterUnit unit) { return unit == ParameterUnit::kRadian ? "rad" : "m"; }

/// Pairs (kept parameter, coefficient) that a dropped parameter is regrouped into.
void EmitRegrouping(const CalibrationResult& result, const BaseParameters& base,
                    std::size_t dropped, YAML::Emitter& yaml) {
  yaml << YAML::Key << "regrouped_into" << YAML::Value << YAML::Flow << YAML::BeginMap;
  for (std::size_t i = 0; i < base.kept.size(); ++i) {
    const double coefficient =
        base.regrouping(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(dropped));
    if (std::abs(coefficient) < 1e-9) continue;
    yaml << YAML::Key << result.model.parameters[base.kept[i]].name << YAML::Value
         << FormatNumber(std::round(coefficient * 1e9) * 1e-9);
  }
  yaml << YAML::EndMap;
}

void EmitParameter(const CalibrationResult& result, const BaseParameters& base, int i,
                   YAML::Emitter& yaml) {
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
  for (std::size_t d = 0; d < base.dropped.size(); ++d) {
    if (base.dropped[d] == i) EmitRegrouping(result, base, d, yaml);
  }
  yaml << YAML::EndMap;
}

}  // namespace

std::string MakeCalibrationYaml(const CalibrationResult& result, const BaseParameters& base,
                                const std::string& recording, ZeroOffsets zero_offsets) {
  YAML::Emitter yaml;
  yaml << YAML::Comment(
      "Written by elastocal: deviations from the nominal URDF, radians and metres.");
  yaml << YAML::BeginMap;
  yaml << YAML::Key << "format" << YAML::Value << kFormat;
  yaml << YAML::Key << "robot" << YAML::Value << result.model.tree.name;
  yaml << YAML::Key << "recording" << YAML::Value << recording;
  yaml << YAML::Key << "model" << YAML::Value << ModelKindName(result.kind);
  yaml << YAML::Key << "zero_offsets" << YAML::Value
       << (zero_offsets == ZeroOffsets::kOrigin ? "origin" : "encoder")
       << YAML::Comment("where the calibrated URDF has the joints' zero offsets");
  yaml << YAML::Key << "termination" << YAML::Value << TerminationName(result.termination);
  yaml << YAML::Key << "marker_sd_mm" << YAML::Value << FormatNumber(1e3 * result.marker_sd);
  yaml << YAML::Key << "prior_scale" << YAML::Value << YAML::Flow << YAML::BeginMap;
  yaml << YAML::Key << "angles" << YAML::Value << FormatNumber(result.prior_scale.angles);
  yaml << YAML::Key << "lengths" << YAML::Value << FormatNumber(result.prior_scale.lengths);
  yaml << YAML::EndMap;
  yaml << YAML::Key << "interval_95_in_sd" << YAML::Value << FormatNumber(result.interval_factor);
  yaml << YAML::Key << "parameters" << YAML::Value << YAML::BeginSeq;
  for (int i = 0; i < result.model.parameter_count(); ++i) EmitParameter(result, base, i, yaml);
  yaml << YAML::EndSeq << YAML::EndMap;
  return std::string(yaml.c_str()) + "\n";
}

StoredCalibration ReadCalibration(const std::filesystem::path& file) {
  const YamlValue root = YamlValue::Parse(ReadFile(file), file.string());
  root.Get("format").Expect(root.Get("format").Text() == kFormat,
                            std::string("format ") + kFormat + ", which calibrate writes");
  StoredCalibration stored;
  stored.robot = root.Get("robot").Text();
  stored.recording = root.Get("recording").Text();
  for (const YamlValue& parameter : root.Get("parameters").Items()) {
    const std::string name = parameter.Get("name").Text();
    const double value = parameter.Get("value").Number();
    const bool external = name.starts_with("waist.T0.") || name.starts_with("marker.");
    if (!external) stored.joint_errors[name] = value;
  }
  return stored;
}

}  // namespace elastocal
