// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Starts of a robot, told by the readings of its relative encoders.
///
/// A relative encoder counts whole steps from where it was homed. Each start of the robot homes it
/// anew, somewhere within a step. So readings of one start differ by whole steps, and those of two
/// starts do not. Joints that hardly move show it best: a gripper, a locked head.
struct EncoderStarts {
  /// Start of each row, numbered in order of appearance; empty where no column tells starts.
  std::vector<int> start;
  std::vector<int> columns;   ///< that tell them
  std::vector<double> steps;  ///< of their encoders, in the unit of the column

  int count() const;  ///< of starts; 0 where none are told
};

/// Starts in a table of readings in the order in which they were taken (rows x columns, rad or m;
/// a column that is not all numbers holds NaN). A column tells starts if
/// - a step of at most 2e-3 divides at least half of its changes from row to row, which would be so
///   by chance in one of a million tables at most;
/// - the other changes are no halves to sevenths of a step, which a finer encoder would make;
/// - at most a quarter of the rows have another remainder than the row before.
/// Readings that are rounded to a step or coarser tell nothing.
EncoderStarts FindEncoderStarts(const Eigen::MatrixXd& readings);

}  // namespace elastocal
