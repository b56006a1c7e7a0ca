// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A foot that supported the robot through one trial, and where it stood.
struct FootRest {
  int link = 0;
  int session = 0;  ///< number of the folder that the trial is from
  int trial = 0;    ///< its number among all trials read, whatever they were recorded for
  /// Share of the robot's weight on the foot, in [0, 1], by the torques of the supporting legs'
  /// joints (eq. 6), mean over the postures. If the torques of no posture tell it (a joint of a
  /// supporting leg has no torque, a leg has fewer than six joints, or a knee is straight), it is 1
  /// for a foot that stands alone and NaN beside others. It is NaN also if the torques of all feet
  /// together say a weight that is a fifth or more off that of the description (something else
  /// carries the robot, or the torques are wrong), and if the share is outside [0, 1].
  double share = 1.0;
  std::vector<std::string> markers = {};  ///< markers on the body of the foot
  /// Median position of each of `markers`, m, one column a marker, NaN if it was not seen: over the
  /// whole trial, and over the first and the second half of its postures. In the cameras' frame.
  Eigen::Matrix3Xd at = {}, at_first = {}, at_last = {};
};

/// The feet that supported the robot: one entry for each trial and foot, in the order of the
/// trials. Trials without postures and posture tables give no entry. `markers` are the robot's
/// markers in any order; they are matched by name.
std::vector<FootRest> FindFootRests(const RobotTree& tree, const std::vector<Marker>& markers,
                                    const Recording& recording);

}  // namespace elastocal
