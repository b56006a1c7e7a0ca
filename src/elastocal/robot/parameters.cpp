// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/parameters.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

std::vector<std::string> Names(const std::vector<Parameter>& parameters) {
  std::vector<std::string> names;
  for (const Parameter& parameter : parameters) names.push_back(parameter.name);
  return names;
}

/// Whether `name` matches `pattern`, in which `*` stands for any run of characters.
bool Matches(std::string_view pattern, std::string_view name) {
  const std::size_t first = pattern.find('*');
  if (first == std::string_view::npos) return pattern == name;
  const std::size_t last = pattern.rfind('*');
  const std::string_view head = pattern.substr(0, first);
  const std::string_view tail = pattern.substr(last + 1);
  if (name.size() < head.size() + tail.size()) return false;
  if (!name.starts_with(head) || !name.ends_with(tail)) return false;

  // Text between two stars is matched where it occurs first, which leaves most for the rest.
  std::string_view rest = name.substr(head.size(), name.size() - head.size() - tail.size());
  for (std::size_t at = first + 1; at <= last; at = pattern.find('*', at) + 1) {
    const std::string_view piece = pattern.substr(at, pattern.find('*', at) - at);
    const std::size_t found = rest.find(piece);
    if (found == std::string_view::npos) return false;
    rest.remove_prefix(found + piece.size());
  }
  return true;
}

}  // namespace

const char* KindName(ParameterKind kind) {
  static constexpr std::array<const char*, kParameterKindCount> kNames = {
      "theta",       "r",           "d",          "b",       "alpha",     "beta",
      "gamma",       "T0",          "marker",     "torsion", "bending",   "base_force",
      "base_moment", "torque_bias", "correction", "rod",     "motor_zero"};
  return kNames[static_cast<int>(kind)];
}

const char* UnitName(ParameterUnit unit) {
  static constexpr std::array<const char*, kParameterUnitCount> kNames = {
      "rad", "m",   "rad/(N.m)", "m/N",  "N.m",   "N",    "1",
      "1/N", "m/h", "kg",        "kg.m", "m/rad", "rad/m"};
  return kNames[static_cast<int>(unit)];
}

bool IsAngle(ParameterKind kind) {
  return kind == ParameterKind::kTheta || kind == ParameterKind::kAlpha ||
         kind == ParameterKind::kBeta || kind == ParameterKind::kGamma ||
         kind == ParameterKind::kMotorZero;
}

bool IsExternal(ParameterKind kind) {
  return kind == ParameterKind::kWaistPose || kind == ParameterKind::kMarker;
}

bool IsCompliance(ParameterKind kind) {
  return kind == ParameterKind::kTorsion || kind == ParameterKind::kBending ||
         kind == ParameterKind::kLegForce || kind == ParameterKind::kLegMoment;
}

bool IsElastic(ParameterKind kind) {
  return IsCompliance(kind) || kind == ParameterKind::kTorqueBias ||
         kind == ParameterKind::kCorrection;
}

int FindParameter(const std::vector<Parameter>& parameters, const std::string& name) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].name == name) return static_cast<int>(i);
  }
  throw InputError("no parameter '" + name + "'" + DidYouMean(name, Names(parameters)));
}

std::vector<int> MatchParameters(const std::vector<Parameter>& parameters,
                                 const std::vector<std::string>& patterns) {
  std::vector<int> matched;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto matches = [&](const std::string& pattern) {
      return Matches(pattern, parameters[i].name);
    };
    if (std::any_of(patterns.begin(), patterns.end(), matches)) {
      matched.push_back(static_cast<int>(i));
    }
  }
  return matched;
}

void CheckPatterns(const std::vector<Parameter>& parameters,
                   const std::vector<std::string>& patterns) {
  for (const std::string& pattern : patterns) {
    if (!MatchParameters(parameters, {pattern}).empty()) continue;
    throw InputError("'" + pattern + "' matches no parameter" +
                     DidYouMean(pattern, Names(parameters)));
  }
}

}  // namespace elastocal
