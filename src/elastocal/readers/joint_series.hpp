// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Joint states with the same names, sorted by time and without repetitions.
struct JointSeries {
  std::vector<std::string> names;
  std::vector<std::int64_t> stamps_ns;
  Eigen::MatrixXd positions, efforts;  ///< messages x joints
};

/// Sorts messages by time and drops repeated ones. `positions` and `efforts` have the numbers
/// message after message. Throws InputError beginning with `place`: different positions at one
/// time.
JointSeries SortSeries(const std::string& place, std::vector<std::string> names,
                       const std::vector<std::int64_t>& stamps,
                       const std::vector<double>& positions, const std::vector<double>& efforts);

/// Merges series into one log. The series with the most values (joints times messages) gives the
/// times. Joints that only other series have are interpolated at these times. Rows where this is
/// not possible are left out, and `notes` say so.
JointLog MergeSeries(const std::string& source, const std::vector<JointSeries>& all,
                     std::vector<std::string>& notes);

}  // namespace elastocal
