// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/observation/instrument.hpp"
#include "elastocal/tables/table_reader.hpp"

namespace elastocal {

/// Measurement of an instrument in the row of a table that was read last, from its columns; nothing
/// if all cells are gaps. Throws InputError naming file, line and column: only some cells are gaps;
/// a cell is no number; the instrument cannot show this (a quaternion whose length is not 1 within
/// 0.001, an accelerometer that does not show gravity within 5 %, millimetres for metres).
std::optional<Eigen::VectorXd> ReadMeasured(const Table& table, const Instrument& instrument,
                                            const std::vector<int>& columns);

}  // namespace elastocal
