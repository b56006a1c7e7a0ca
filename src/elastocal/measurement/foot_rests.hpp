// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A foot that supported the robot through a trial.
struct FootRest {
  int link = 0;
  int session = 0;  ///< the folder that the trial is from
  int trial = 0;    ///< its number among all trials read, whatever they were recorded for
  /// Share of the weight on the foot, mean over the postures: all of it if it stands alone; beside
  /// others, as the torques of the legs' joints say (eq. 6). NaN: a joint of a leg on the floor has
  /// no torque, a leg has fewer than six joints, or a knee is straight, in every posture; or the
  /// torques of all feet say another weight than the description (by a fifth): something else
  /// carries the robot, or they are wrong.
  double share = 1.0;
  std::vector<std::string> markers = {};  ///< on the body of the foot
  /// Where each of them mostly was (medians), m, columns; NaN where not seen: in the whole trial,
  /// and in the first and the second half of its postures.
  Eigen::Matrix3Xd at = {}, at_first = {}, at_last = {};
};

/// One entry a trial and foot, in the order of the trials; none for trials without postures and
/// tables of postures. `markers`: of the robot, by any order.
std::vector<FootRest> FindFootRests(const RobotTree& tree, const std::vector<Marker>& markers,
                                    const Recording& recording);

}  // namespace elastocal
