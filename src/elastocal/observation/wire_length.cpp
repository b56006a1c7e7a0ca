// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/wire_length.hpp"

namespace elastocal {
namespace {

Eigen::Vector3d HookOf(const Sight& sight) {
  return sight.T_floor_link[0] * (sight.values[1].origin.translation() + sight.values[1].x);
}

/// Vector from the fixed point to the hook.
Eigen::Vector3d WireOf(const Sight& sight) {
  return HookOf(sight) - sight.values[0].origin.translation() - sight.values[0].x.head<3>();
}

}  // namespace

ObservationResidual WireLength::Evaluate(const Sight& sight,
                                         const Eigen::VectorXd& measured) const {
  const Eigen::RowVector3d along = WireOf(sight).normalized().transpose();
  Eigen::MatrixXd by_anchor(1, 4);
  by_anchor << -along, 1.0;
  return {Predict(sight) - measured,
          {along * PointByScrew(HookOf(sight))},
          {by_anchor, along * sight.T_floor_link[0].linear()}};
}

Eigen::VectorXd WireLength::Predict(const Sight& sight) const {
  return Eigen::VectorXd::Constant(1, WireOf(sight).norm() + sight.values[0].x[3]);
}

}  // namespace elastocal
