// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace elastocal {

/// Columns of a table by name: arrays of numbers (null for empty cells), or of texts where a cell
/// is no number. At most `most_rows` rows are taken, evenly and always the last one; `rows` tells
/// how many there were. Throws InputError naming `file` and the line: what Table refuses.
nlohmann::ordered_json ReadCsvColumns(const std::string& file, const std::string& text,
                                      std::size_t most_rows, std::size_t& rows);

}  // namespace elastocal
