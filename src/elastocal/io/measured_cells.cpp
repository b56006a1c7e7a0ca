// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/measured_cells.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "elastocal/robot/statics.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr double kUnit = 1e-3;          // largest error of a quaternion's length
constexpr double kGravityShare = 0.05;  // largest relative error of an accelerometer
constexpr double kFarthest = 100.0;     // m: a large hall
constexpr double kNearZero = 0.1;       // m: larger than the error of any zero

void CheckMetres(const Table& table, const Instrument& instrument, const std::vector<int>& columns,
                 const Eigen::VectorXd& measured, int count) {
  for (int i = 0; i < count; ++i) {
    if (std::abs(measured[i]) <= kFarthest) continue;
    table.FailCell(columns[i],
                   fmt::format("{:g} m is no {} that '{}' can measure; is it in mm? "
                               "metres were expected",
                               measured[i], instrument.rows()[0].name, instrument.name));
  }
}

/// Checks the length of a wire, whose zero is unknown by some millimetres.
void CheckLengthOfWire(const Table& table, int column, double length) {
  if (length >= -kNearZero) return;
  table.FailCell(column, fmt::format("{:g} m is no length of a wire; does the column have the "
                                     "opposite sign?",
                                     length));
}

void CheckQuaternion(const Table& table, const std::vector<int>& columns,
                     Eigen::VectorXd& measured) {
  const double length = measured.tail<4>().norm();
  if (!(std::abs(length - 1.0) <= kUnit)) {
    table.FailCell(columns[3],
                   fmt::format("the quaternion has length {:.4g}; 1 within {:g} was expected, in "
                               "the order x, y, z, w",
                               length, kUnit));
  }
  measured.tail<4>() /= length;
}

void CheckAtRest(const Table& table, const std::vector<int>& columns,
                 const Eigen::VectorXd& measured) {
  const double gravity = kGravity.norm();
  const double length = measured.norm();
  if (std::abs(length - gravity) <= kGravityShare * gravity) return;
  const bool in_g = std::abs(length - 1.0) <= kGravityShare;
  table.FailCell(columns[0],
                 fmt::format("the acceleration has length {:.4g}; {:g} m/s^2 within {:g} % were "
                             "expected of an accelerometer at rest{}",
                             length, gravity, 100.0 * kGravityShare,
                             in_g ? "; is it in units of gravity?" : ""));
}

}  // namespace

std::optional<Eigen::VectorXd> ReadMeasured(const Table& table, const Instrument& instrument,
                                            const std::vector<int>& columns) {
  if (columns.empty() || columns.front() < 0) return std::nullopt;
  const auto is_gap = [&](int column) { return IsGap(table.Cell(column)); };
  if (std::all_of(columns.begin(), columns.end(), is_gap)) return std::nullopt;
  const auto gap = std::find_if(columns.begin(), columns.end(), is_gap);
  if (gap != columns.end()) {
    table.FailCell(*gap, "there is no number, but " + Quote(instrument.name) +
                             " has other numbers in this row; all or none were expected");
  }
  Eigen::VectorXd measured(static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    measured[static_cast<Eigen::Index>(i)] = table.Number(columns[i]);
  }
  const std::vector<RowMeaning> rows = instrument.rows();
  if (rows.front().unit == SourceUnit::kAcceleration) {
    CheckAtRest(table, columns, measured);
  } else {
    CheckMetres(table, instrument, columns, measured, std::min<int>(3, instrument.measured_size()));
  }
  if (instrument.kind() == std::string_view("wire")) {
    CheckLengthOfWire(table, columns.front(), measured[0]);
  }
  const bool turns = rows.back().unit == SourceUnit::kRadian;  // measured as a quaternion
  if (turns) CheckQuaternion(table, columns, measured);
  return measured;
}

}  // namespace elastocal
