// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/times.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "elastocal/math/input_error.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {

double SecondsIn(std::string_view unit) {
  constexpr std::array<std::pair<std::string_view, double>, 4> kUnits = {
      {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}}};
  for (const auto& [name, seconds] : kUnits) {
    if (unit == name) return seconds;
  }
  return 0.0;
}

std::optional<std::string> TimeUnitOfName(std::string_view name) {
  if (name == "__time") return "";
  const std::size_t end = name.find('_');
  const std::string_view quantity = name.substr(0, end);
  if (quantity != "t" && quantity != "time") return std::nullopt;
  if (end == std::string_view::npos) return "";
  std::string unit(name.substr(end + 1));
  if (SecondsIn(unit) == 0.0) return std::nullopt;
  return unit;
}

double MedianInterval(const std::vector<double>& time) {
  if (time.size() < 2) return 0.0;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < time.size(); ++i) intervals.push_back(time[i] - time[i - 1]);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

bool MayBeSamples(const std::vector<double>& time) {
  constexpr std::size_t kFewest = 20;
  constexpr double kLongest = 1.0;  // s
  return time.size() < kFewest || MedianInterval(time) < kLongest;
}

void ToSeconds(std::string_view stated, const std::string& given, const std::string& source,
               std::vector<double>& time) {
  if (!given.empty() && SecondsIn(given) == 0.0) {
    throw InputError("the unit of time " + Quote(given) +
                     " is not known; s, ms, us or ns was expected");
  }
  if (!stated.empty() && !given.empty() && stated != given) {
    throw InputError(source + ": states the unit of time " + Quote(std::string(stated)) + ", not " +
                     Quote(given));
  }
  if (stated.empty() && given.empty()) {
    if (MayBeSamples(time)) return;
    throw InputError(source + ": most samples would be " + FormatNumber(MedianInterval(time)) +
                     " s apart; say the unit of the time (s, ms, us or ns): in a recording "
                     "folder joints_time_unit of the trial in experiment.yaml, with 'info' and "
                     "'convert' the option --time-unit");
  }
  const double seconds = SecondsIn(given.empty() ? stated : given);
  for (double& t : time) t *= seconds;
}

}  // namespace elastocal
