// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/linkage_errors.hpp"

namespace elastocal {

LinkedPosture PlaceLinkages(const RobotTree& tree, const std::vector<Eigen::VectorXd>& errors,
                            const Eigen::VectorXd& q) {
  LinkedPosture posture{q, {}};
  for (std::size_t i = 0; i < tree.linkages.size(); ++i) {
    const Linkage& linkage = tree.linkages[i];
    const std::vector<int> coordinates = CoordinatesOf(tree, linkage);
    const Eigen::VectorXd positions = q(coordinates);
    posture.by_errors.emplace_back(Eigen::MatrixXd::Zero(positions.size(), linkage.error_count()));
    const auto motors = MotorPositions(tree, linkage, positions);
    if (!motors) continue;
    const auto closure = CloseLinkage(tree, linkage, *motors, errors[i], positions);
    if (!closure) continue;
    posture.q(coordinates) = closure->positions;
    posture.by_errors.back() = closure->by_errors;
  }
  return posture;
}

int FirstLinkageParameter(const ErrorModel& model, int linkage) {
  for (int i = 0; i < model.parameter_count(); ++i) {
    if (model.parameters[i].linkage == linkage) return i;
  }
  return -1;
}

}  // namespace elastocal
