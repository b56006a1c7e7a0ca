// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/linkage_errors.hpp"

namespace elastocal {

LinkedPosture PlaceLinkages(const ErrorModel& model, const Geometry& geometry,
                            const Eigen::VectorXd& q) {
  LinkedPosture posture{q, {}};
  for (std::size_t i = 0; i < model.tree.linkages.size(); ++i) {
    const Linkage& linkage = model.tree.linkages[i];
    const std::vector<int> coordinates = CoordinatesOf(model.tree, linkage);
    const Eigen::VectorXd positions = q(coordinates);
    posture.by_errors.push_back(Eigen::MatrixXd::Zero(positions.size(), linkage.error_count()));
    const auto motors = MotorPositions(model.tree, linkage, positions);
    if (!motors) continue;
    const auto closure =
        CloseLinkage(model.tree, linkage, *motors, geometry.linkage_errors[i], positions);
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
