// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/measurement/labels.hpp"

namespace elastocal {

/// A cluster whose estimated marker positions are those of the project, rotated about the axis of
/// the joint that carries them.
struct TurnedCluster {
  std::string cluster, joint;
  double angle = 0.0;      ///< rotation, rad
  double displaced = 0.0;  ///< rms distance from the positions in the project, m
};

/// Finds clusters of three markers or more that are more than 50 mm from their positions in the
/// project (rms), if a rotation by at least 20 degrees about their revolute joint's axis leaves at
/// most 0.3 of the distance. Either the joint's zero or the project's positions are different:
/// markers of the last link of a limb fit both. If markers beyond the cluster's link determine the
/// zero, nothing is returned.
std::vector<TurnedCluster> FindTurnedClusters(const CalibrationResult& fit,
                                              const std::vector<LabelCluster>& clusters);

/// Text such as "cluster LHAND: its markers are 212 mm from where the project has them, as if
/// turned by 180 degrees about the axis of wrist_joint. ...".
std::string Describe(const TurnedCluster& found);

}  // namespace elastocal
