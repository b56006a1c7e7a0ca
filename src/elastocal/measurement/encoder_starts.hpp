// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// The starts of a robot (times at which it was switched on), as its relative encoders tell them.
///
/// A relative encoder counts whole steps from where it was homed. Each start of the robot homes it
/// anew, somewhere within a step. So readings of one start differ by whole steps, and those of two
/// starts do not. Joints that hardly move show it best: a gripper, a locked head.
struct EncoderStarts {
  /// Start of each row, numbered in order of appearance; empty if no column tells starts.
  std::vector<int> start;
  std::vector<int> columns;   ///< columns that tell the starts
  std::vector<double> steps;  ///< steps of the encoders of `columns`, in the column's unit

  int count() const;  ///< number of starts; 0 if no column tells any
};

/// Starts in a table of readings in the order in which they were taken (rows x columns, rad or m;
/// a column that is not all numbers holds NaN). A column tells starts if
/// - a step of at most 2e-3 (rad or m) divides at least half of its changes from row to row, and
///   the probability that chance does this is below 1e-6;
/// - the other changes are not halves to sevenths of a step, as a finer encoder would make them;
/// - at most a quarter of the rows have another remainder than the row before.
/// Readings that are rounded to a step or coarser tell nothing.
EncoderStarts FindEncoderStarts(const Eigen::MatrixXd& readings);

}  // namespace elastocal
