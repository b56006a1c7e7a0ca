// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/parameter_names.hpp"

#include <utility>

namespace elastocal {

std::string JoinNames(const std::vector<Parameter>& parameters, const std::vector<int>& which) {
  std::vector<std::pair<std::string, std::string>> groups;
  for (int i : which) {
    const std::string& name = parameters[i].name;
    const std::size_t dot = name.rfind('.');
    const std::string owner = name.substr(0, dot);
    if (groups.empty() || groups.back().first != owner) groups.emplace_back(owner, "");
    std::string& constants = groups.back().second;
    constants += (constants.empty() ? "" : ",") + name.substr(dot + 1);
  }
  std::string text;
  for (const auto& [owner, constants] : groups) {
    text += (text.empty() ? "" : ", ") + owner + "." +
            (constants.find(',') == std::string::npos ? constants : "{" + constants + "}");
  }
  return text;
}

}  // namespace elastocal
