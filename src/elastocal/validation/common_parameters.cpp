// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/common_parameters.hpp"

#include <map>

namespace elastocal {
namespace {

std::map<std::string, int> IndexByName(const CalibrationEstimate& estimate) {
  std::map<std::string, int> index;
  for (std::size_t i = 0; i < estimate.parameters.size(); ++i) {
    index[estimate.parameters[i].name] = static_cast<int>(i);
  }
  return index;
}

std::string StatusIn(const CalibrationEstimate& estimate, const std::map<std::string, int>& index,
                     const std::string& name) {
  const auto at = index.find(name);
  if (at == index.end()) return "absent";
  return StatusName(estimate.parameters[at->second].status);
}

}  // namespace

std::string OwnerName(const std::string& parameter) {
  if (parameter.ends_with(".torque_bias")) return parameter;
  return parameter.substr(0, parameter.rfind('.'));
}

CommonParameters FindCommonParameters(const CalibrationEstimate& a, const CalibrationEstimate& b) {
  const std::map<std::string, int> index_a = IndexByName(a);
  const std::map<std::string, int> index_b = IndexByName(b);
  const std::string estimated = StatusName(ParameterStatus::kEstimated);
  CommonParameters result;
  const auto add_not_compared = [&](const std::string& name) {
    const std::string in_a = StatusIn(a, index_a, name);
    const std::string in_b = StatusIn(b, index_b, name);
    result.not_compared.push_back(
        {name, in_a == in_b ? in_a + " in both" : in_a + " in A, " + in_b + " in B"});
  };
  for (std::size_t i = 0; i < b.parameters.size(); ++i) {
    const ParameterEstimate& parameter = b.parameters[i];
    if (parameter.external) continue;
    if (parameter.status == ParameterStatus::kEstimated &&
        StatusIn(a, index_a, parameter.name) == estimated) {
      result.common.push_back({parameter.name, OwnerName(parameter.name), parameter.unit,
                               index_a.at(parameter.name), static_cast<int>(i)});
    } else {
      add_not_compared(parameter.name);
    }
  }
  for (const ParameterEstimate& parameter : a.parameters) {
    if (!parameter.external && !index_b.contains(parameter.name)) add_not_compared(parameter.name);
  }
  return result;
}

}  // namespace elastocal
