// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace elastocal {

/// Seconds in a unit of time that files name: s, ms, us, ns; 0 for anything else.
double SecondsIn(std::string_view unit);

/// The unit in the name of a column or array of the time: "ns" for `time_ns`; "" for `t`, `time`
/// and `__time` (PlotJuggler), which state none. Nothing for other names.
std::optional<std::string> TimeUnitOfName(std::string_view name);

/// Median interval from one time to the next; 0 for fewer than two times.
double MedianInterval(const std::vector<double>& time);

/// Whether times, taken as s, may be those of samples of a moving robot: the median interval is
/// below 1 s, or there are fewer than 20 times.
bool MayBeSamples(const std::vector<double>& time);

/// Converts the times of a joint log to s. They are in the unit that the file states (`stated`) or
/// that the user gives (`given`). If there is neither, they are taken as s; if they then cannot be
/// samples (MayBeSamples), throws InputError, which names `source` and asks for the unit. Throws
/// InputError also for an unknown unit, and if file and user differ.
void ToSeconds(std::string_view stated, const std::string& given, const std::string& source,
               std::vector<double>& time);

}  // namespace elastocal
