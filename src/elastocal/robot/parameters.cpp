#include "elastocal/robot/parameters.hpp"

#include <array>
#include <set>
#include <string_view>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

std::vector<std::string> Names(const std::vector<Parameter>& parameters) {
  std::vector<std::string> names;
  for (const Parameter& parameter : parameters) names.push_back(parameter.name);
  return names;
}

bool Matches(std::string_view pattern, std::string_view name) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return pattern == name;
  if (name.substr(0, star) != pattern.substr(0, star)) return false;
  for (std::size_t i = star; i <= name.size(); ++i) {
    if (Matches(pattern.substr(star + 1), name.substr(i))) return true;
  }
  return false;
}

}  // namespace

const char* KindName(ParameterKind kind) {
  static constexpr std::array<const char*, kParameterKindCount> kNames = {
      "theta", "r", "d", "b", "alpha", "beta", "gamma", "T0", "marker"};
  return kNames[static_cast<int>(kind)];
}

bool IsExternal(ParameterKind kind) {
  return kind == ParameterKind::kBase || kind == ParameterKind::kMarker;
}

int FindParameter(const std::vector<Parameter>& parameters, const std::string& name) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].name == name) return static_cast<int>(i);
  }
  throw InputError("no parameter '" + name + "'" + DidYouMean(name, Names(parameters)));
}

std::vector<int> MatchParameters(const std::vector<Parameter>& parameters,
                                 const std::vector<std::string>& patterns) {
  std::set<int> matched;
  for (const std::string& pattern : patterns) {
    bool any = false;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      if (!Matches(pattern, parameters[i].name)) continue;
      matched.insert(static_cast<int>(i));
      any = true;
    }
    if (!any) {
      throw InputError("'" + pattern + "' matches no parameter" +
                       DidYouMean(pattern, Names(parameters)));
    }
  }
  return {matched.begin(), matched.end()};
}

}  // namespace elastocal
