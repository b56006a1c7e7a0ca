#include "elastocal/cli/session.hpp"

#include <cmath>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "elastocal/cli/warning_groups.hpp"
#include "elastocal/io/output_files.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal::cli {

void CheckOutputs(const std::vector<std::filesystem::path>& outputs,
                  const std::vector<std::filesystem::path>& inputs) {
  for (const std::filesystem::path& output : outputs) {
    for (const std::filesystem::path& input : inputs) {
      if (!output.empty() && SameFile(output, input)) {
        throw InputError(output.string() + ": this is an input; choose another output");
      }
    }
  }
}

void Print(bool quiet, const std::string& text) {
  if (quiet) return;
  EraseProgressLine();
  fmt::print("{}", text);
}

void PrintWarnings(const std::vector<std::string>& warnings, bool verbose) {
  for (const std::string& warning : verbose ? warnings : GroupWarnings(warnings)) {
    spdlog::warn("{}", warning);
  }
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
    default:
      return UnitName(parameter.unit);
  }
}

}  // namespace elastocal::cli
