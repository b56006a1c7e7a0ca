// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// Joint states with the same names: sorted by time, repeated ones once.
struct JointSeries {
  std::vector<std::string> names;
  std::vector<std::int64_t> stamps_ns;
  Eigen::MatrixXd positions, efforts;  ///< messages x joints
};

/// In the order of time, of numbers message after message. A message that comes twice counts once.
/// Throws InputError beginning with `place`: different positions at one time.
JointSeries SortSeries(const std::string& place, std::vector<std::string> names,
                       const std::vector<std::int64_t>& stamps,
                       const std::vector<double>& positions, const std::vector<double>& efforts);

/// One log: the series with the most values (joints times messages) gives the times. Joints that
/// only others have are interpolated at these times, and rows where that is not possible are left
/// out, as `notes` say.
JointLog MergeSeries(const std::string& source, const std::vector<JointSeries>& all,
                     std::vector<std::string>& notes);

}  // namespace elastocal
