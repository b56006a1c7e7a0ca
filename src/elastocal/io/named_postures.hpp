// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/readers/byte_source.hpp"
#include "elastocal/readers/recording_file.hpp"

namespace elastocal {

/// Recognises a posture table by its column names, without a project: it has NAME_x, NAME_y and
/// NAME_z of at least one marker, and every other column but `t` and `time` is that of a joint.
/// Returns nothing for another header, and if rows follow each other by less than 0.1 s (median):
/// these are samples of joints with such names. Throws InputError like Table.
std::optional<NamedPostures> ReadNamedPostures(const ByteSource& source);

/// Describes the columns of a table whose names are known only with its project (touches, poses,
/// corners of tags, markers of other names). `why` gets the reason why it is no joint log. Returns
/// nothing if it may be a joint log: a column is the time, and it has a unit (in its name or by
/// `time_unit`) or its values may be samples (MayBeSamples). Returns nothing also for a table of
/// one column. Throws InputError like Table.
std::optional<NamedPostures> ReadColumnsAsTheyAre(const ByteSource& source,
                                                  const std::string& time_unit, std::string& why);

/// Index of the time column of a CSV: `t`, else `time`, else the first name that TimeUnitOfName
/// knows (`time_ns`). Without one, the number of columns.
std::ptrdiff_t FindTime(const std::vector<std::string>& header);

}  // namespace elastocal
