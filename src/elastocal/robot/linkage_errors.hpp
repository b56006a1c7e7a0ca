// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

/// A posture in which the joints of linkages are where the rods with errors put them.
struct LinkedPosture {
  Eigen::VectorXd q;  ///< positions as given, except those of the joints of linkages
  /// For each linkage, derivatives of its joints by its errors (Linkage::error_count), rad/m and
  /// rad/rad.
  std::vector<Eigen::MatrixXd> by_errors;
};

/// Moves the joints of linkages from where the nominal rods put them (in `q`) to where the rods
/// with errors put them, for the same positions of the motors. A linkage that does not close stays
/// as it is, with derivatives of zero. `errors` has one vector for each linkage.
LinkedPosture PlaceLinkages(const RobotTree& tree, const std::vector<Eigen::VectorXd>& errors,
                            const Eigen::VectorXd& q);

/// Index of the first parameter of a linkage in the model; -1 if the linkage has none.
int FirstLinkageParameter(const ErrorModel& model, int linkage);

}  // namespace elastocal
