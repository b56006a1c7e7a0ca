// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/plane_distance.hpp"

namespace elastocal {
namespace {

Eigen::Vector3d TipOf(const Sight& sight) {
  return sight.T_floor_link[0] * (sight.values[1].origin.translation() + sight.values[1].x);
}

}  // namespace

ObservationResidual PlaneDistance::Evaluate(const Sight& sight,
                                            const Eigen::VectorXd& measured) const {
  const QuantityValue& plane = sight.values[0];
  const Eigen::Vector3d p = TipOf(sight);
  const Eigen::RowVector3d n = plane.Normal().transpose();
  return {Predict(sight) - measured,
          {n * PointByScrew(p)},
          {plane.HeightByPlane(p), n * sight.T_floor_link[0].linear()}};
}

Eigen::VectorXd PlaneDistance::Predict(const Sight& sight) const {
  return Eigen::VectorXd::Constant(1, sight.values[0].HeightOver(TipOf(sight)));
}

void PlaneDistance::Begin(const std::vector<Sight>& sights,
                          const std::vector<Eigen::VectorXd>& measured,
                          std::vector<QuantityValue*>& values) const {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < sights.size(); ++i) {
    mean += TipOf(sights[i]) - measured[i][0] * values[0]->Normal();
  }
  values[0]->origin.translation() = mean / static_cast<double>(sights.size());
}

}  // namespace elastocal
