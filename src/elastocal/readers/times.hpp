// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace elastocal {

/// Seconds in a unit of time that files name: s, ms, us, ns; 0 for anything else.
double SecondsIn(std::string_view unit);

/// The unit in the name of a column or array of the time: "" of `t`, `time` and `__time`
/// (PlotJuggler), "ns" of `time_ns`.
/// Nothing for other names.
std::optional<std::string> TimeUnitOfName(std::string_view name);

/// Interval in the middle of all from one time to the next; 0 for fewer than two times.
double MedianInterval(const std::vector<double>& time);

/// Whether times in s would be samples of a moving robot: most follow each other by less than a
/// second, or there are hardly any.
bool MayBeSamples(const std::vector<double>& time);

/// Times of a joint log in s. They are in the unit that the file states or that the user gives.
/// Where neither does, they are in s; throws InputError naming `source`, which asks for the unit,
/// unless they then may be samples (MayBeSamples). Throws InputError as well for a
/// unit that is not known, and where file and user differ.
void ToSeconds(std::string_view stated, const std::string& given, const std::string& source,
               std::vector<double>& time);

}  // namespace elastocal
