// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Reads a Qualisys QTM 3-D TSV (docs/formats.md): lines `KEY<tab>value`, a row of column names,
/// then one row a frame in mm. The columns Frame and Time and all but the names of the markers may
/// be absent. A marker is not seen where its cells are empty, NaN, NULL or 0 0 0. The rate is
/// FREQUENCY or, where this is absent or EXT, follows from the column Time. The column SMPTE and
/// trajectories without a name are passed over, and a last row that no line end follows; `notes`
/// gets a sentence about these two. Cost: linear in the size of the file.
/// Throws InputError naming file, line and column: a number that is none, rows of unequal length,
/// frames that do not follow each other, another number of markers or frames than the header says,
/// no rate. Files may be large: they are read line by line.
MarkerTrajectories ReadQtmTsv(const std::filesystem::path& file,
                              std::vector<std::string>* notes = nullptr);

/// The same from the text of a file; `source` names it in messages.
MarkerTrajectories ParseQtmTsv(std::string_view text, const std::string& source);

/// Writes such a file, as QTM does by default: with header, column names, Frame and Time, and
/// positions in mm with three decimals (`decimals`, from 0 to 12). A marker that was not seen has
/// empty cells. Every reader of the format takes a position that rounds to 0 0 0 for a marker that
/// was not seen.
/// Throws InputError for names that the format cannot hold and when the file cannot be written.
void WriteQtmTsv(const std::filesystem::path& file, const MarkerTrajectories& trajectories,
                 int decimals = 3);

/// The text of such a file.
std::string FormatQtmTsv(const MarkerTrajectories& trajectories, int decimals = 3);

}  // namespace elastocal
