// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/session.hpp"

#include <cmath>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "elastocal/cli/warning_groups.hpp"
#include "elastocal/math/utf8.hpp"
#include "elastocal/pipeline/choose_causes.hpp"

namespace elastocal::cli {

void Print(bool quiet, const std::string& text) {
  if (quiet) return;
  EraseProgressLine();
  fmt::print("{}", Printable(text));
}

void PrintWarnings(const std::vector<std::string>& warnings, bool verbose) {
  for (const std::string& warning : verbose ? warnings : GroupWarnings(warnings)) {
    spdlog::warn("{}", warning);
  }
}

void WarnOfExtra(const CalibratedRobot& robot, bool at_run_time) {
  const std::string text =
      NotApplied(StoredCauses(robot.project.tree, robot.calibration.joint_errors), at_run_time);
  if (!text.empty()) PrintWarnings({text});
}

double InUserUnits(const Parameter& parameter, double value) {
  switch (parameter.unit) {
    case ParameterUnit::kRadian:
      return value * 180.0 / M_PI;
    case ParameterUnit::kMetre:
      return value * 1e3;
    case ParameterUnit::kRadianPerNewtonMetre:
    case ParameterUnit::kMetrePerNewton:
      return value * 1e6;
    case ParameterUnit::kMetrePerHour:
    case ParameterUnit::kMetrePerRadian:
    case ParameterUnit::kRadianPerMetre:
      return value * 1e3;
    case ParameterUnit::kPerNewton:
      return value * 1e6;
    case ParameterUnit::kRatio:
      return value * 1e2;
    default:
      return value;
  }
}

const char* UserUnit(const Parameter& parameter) {
  switch (parameter.unit) {
    case ParameterUnit::kRadian:
      return "deg";
    case ParameterUnit::kMetre:
      return "mm";
    case ParameterUnit::kRadianPerNewtonMetre:
      return "urad/(N.m)";
    case ParameterUnit::kMetrePerNewton:
      return "um/N";
    case ParameterUnit::kMetrePerHour:
      return "mm/h";
    case ParameterUnit::kMetrePerRadian:
      return "mm/rad";
    case ParameterUnit::kRadianPerMetre:
      return "mrad/m";
    case ParameterUnit::kPerNewton:
      return "um/(N.m)";
    case ParameterUnit::kRatio:
      return "%";
    default:
      return UnitName(parameter.unit);
  }
}

}  // namespace elastocal::cli
