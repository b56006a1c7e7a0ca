// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/readers/byte_source.hpp"
#include "elastocal/readers/recording_file.hpp"

namespace elastocal {

/// A table with a header row whose columns are a posture table's by their names, without a project:
/// NAME_x, NAME_y and NAME_z of one marker or more; every other column but `t` and `time` is a
/// joint's. Nothing for another header, and for rows that follow each other by less than 0.1 s
/// (median): they are samples of joints with such names. Throws InputError where Table does.
std::optional<NamedPostures> ReadNamedPostures(const ByteSource& source);

/// A table with a header row whose names nobody knows without its project (touches, poses, corners
/// of tags, markers of other names): what its columns hold, and `why` it is no joint log. Nothing
/// where a column is the time of samples (MayBeSamples, or there is a unit of time, by its name or
/// given), and for one column alone.
/// Throws InputError where Table does.
std::optional<NamedPostures> ReadColumnsAsTheyAre(const ByteSource& source,
                                                  const std::string& time_unit, std::string& why);

/// The column of the time among those of a CSV: `t`, else `time`, else one of these with the unit
/// at its end (TimeUnitOfName); the number of columns where there is none.
std::ptrdiff_t FindTime(const std::vector<std::string>& header);

}  // namespace elastocal
