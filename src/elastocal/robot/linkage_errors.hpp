// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

/// Where the joints of linkages are.
struct LinkedPosture {
  Eigen::VectorXd q;  ///< as given, but for the joints of linkages
  /// By linkage: derivatives of its joints by its errors (see Linkage::error_count), rad/m and
  /// rad/rad.
  std::vector<Eigen::MatrixXd> by_errors;
};

/// In `q`, the joints of linkages are where the nominal rods put them. There is one position of the
/// motors for that, and for this one the rods with their errors put the joints elsewhere. A linkage
/// that does not close stays as it is, with derivatives of zero. `errors`: by linkage.
LinkedPosture PlaceLinkages(const RobotTree& tree, const std::vector<Eigen::VectorXd>& errors,
                            const Eigen::VectorXd& q);

/// The first parameter of a linkage of the model; -1 where it has none.
int FirstLinkageParameter(const ErrorModel& model, int linkage);

}  // namespace elastocal
