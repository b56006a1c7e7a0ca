// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace elastocal {

/// Columns of a table by name: arrays of numbers (null for empty cells), or of texts if a cell is
/// no number. At most `most_rows` rows are taken, evenly chosen and always with the last one;
/// `rows` receives the number of all rows. Throws InputError that names `file` and line, as Table.
nlohmann::ordered_json ReadCsvColumns(const std::string& file, const std::string& text,
                                      std::size_t most_rows, std::size_t& rows);

}  // namespace elastocal
