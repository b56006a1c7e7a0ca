// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/measurement/labels.hpp"

namespace elastocal {

/// A cluster whose markers were estimated where the project has them, but turned about the axis of
/// the joint that carries them.
struct TurnedCluster {
  std::string cluster, joint;
  double angle = 0.0;      ///< by which they are turned, rad
  double displaced = 0.0;  ///< rms distance from where the project has them, m
};

/// Clusters of three markers or more that are 50 mm and more from where the project has them (rms),
/// of which a turn by 20 degrees or more about their joint's axis leaves 0.3 at most. The joint's
/// zero is another one then, or the project's places are: the markers of the last link of a limb
/// fit either way. Where markers beyond the cluster's link tell the zero, nothing is said.
std::vector<TurnedCluster> FindTurnedClusters(const CalibrationResult& fit,
                                              const std::vector<LabelCluster>& clusters);

/// "cluster LHAND: its markers are 212 mm from where the project has them, as if turned by 180
/// degrees about the axis of wrist_joint. ..."
std::string Describe(const TurnedCluster& found);

}  // namespace elastocal
