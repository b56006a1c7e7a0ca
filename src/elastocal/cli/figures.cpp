// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/figures.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace elastocal::cli {
namespace {

constexpr int kMostDecimals = 9;

/// Decimal place of the second significant digit after rounding: 2 for 0.0996, which is printed as
/// 0.10. Negative left of the point.
int SecondDigit(double positive) {
  const std::string text = fmt::format("{:.1e}", positive);
  return 1 - std::stoi(text.substr(text.find('e') + 1));
}

std::string ToPlace(double value, int place) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  if (place < 0) {
    const double unit = std::pow(10.0, -place);
    value = unit * std::round(value / unit);
  }
  std::string text = fmt::format("{:.{}f}", value, std::max(0, place));
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  if (is_zero && text[0] == '-') text.erase(0, 1);
  return text;
}

bool TellsNothing(double sd) { return !std::isfinite(sd) || sd <= 0.0; }

}  // namespace

std::string RoundedSd(double sd) {
  if (sd == 0.0) return "0";
  if (TellsNothing(sd)) return ToPlace(sd, 0);
  const int place = SecondDigit(sd);
  return place > kMostDecimals ? fmt::format("{:.1e}", sd) : ToPlace(sd, place);
}

std::string RoundedTo(double value, double sd) {
  if (std::isfinite(value) && TellsNothing(sd)) return fmt::format("{:.4g}", value);
  return ToPlace(value, TellsNothing(sd) ? 0 : std::min(kMostDecimals, SecondDigit(sd)));
}

std::string RoundedInterval(double value, double half_width, double sd) {
  return fmt::format("[{}, {}]", RoundedTo(value - half_width, sd),
                     RoundedTo(value + half_width, sd));
}

std::string Millimetres(double metres, int decimals) {
  return std::isfinite(metres) ? ToPlace(1e3 * metres, decimals) : "-";
}

}  // namespace elastocal::cli
