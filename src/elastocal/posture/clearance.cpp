// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/clearance.hpp"

namespace elastocal {
namespace {

constexpr double kFar = 1e3;              // m: no upper limit
constexpr double kLeastDistance = 1e-12;  // m: of centres, where the direction is undefined

}  // namespace

SphereClearance::SphereClearance(std::vector<CollisionSphere> spheres,
                                 std::vector<SpherePair> pairs, double margin)
    : spheres_(std::move(spheres)), pairs_(std::move(pairs)) {
  const auto count = static_cast<Eigen::Index>(pairs_.size());
  SetRange(Eigen::VectorXd::Constant(count, margin), Eigen::VectorXd::Constant(count, kFar));
}

std::string SphereClearance::Name(int row) const {
  return "distance between " + spheres_[pairs_[row].first].name + " and " +
         spheres_[pairs_[row].second].name;
}

void SphereClearance::Evaluate(const MovingChain& chain, Eigen::Ref<Eigen::VectorXd> value,
                               Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  const Eigen::Matrix3Xd centres = SphereCentres(spheres_, chain.link_poses());
  for (int row = 0; row < size(); ++row) {
    const auto [a, b] = pairs_[row];
    const Eigen::Vector3d between = centres.col(a) - centres.col(b);
    const double distance = std::max(between.norm(), kLeastDistance);
    value[row] = distance - spheres_[a].radius - spheres_[b].radius;
    jacobian.row(row) =
        (between / distance).transpose() * (chain.PointJacobian(spheres_[a].link, centres.col(a)) -
                                            chain.PointJacobian(spheres_[b].link, centres.col(b)));
  }
}

FloorClearance::FloorClearance(std::vector<CollisionSphere> spheres, double floor_z)
    : spheres_(std::move(spheres)) {
  const auto count = static_cast<Eigen::Index>(spheres_.size());
  SetRange(Eigen::VectorXd::Constant(count, floor_z), Eigen::VectorXd::Constant(count, kFar));
}

std::string FloorClearance::Name(int row) const {
  return "height of " + spheres_[row].name + " above the floor";
}

void FloorClearance::Evaluate(const MovingChain& chain, Eigen::Ref<Eigen::VectorXd> value,
                              Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  const Eigen::Matrix3Xd centres = SphereCentres(spheres_, chain.link_poses());
  for (int row = 0; row < size(); ++row) {
    value[row] = centres(2, row) - spheres_[row].radius;
    jacobian.row(row) = chain.PointJacobian(spheres_[row].link, centres.col(row)).row(2);
  }
}

}  // namespace elastocal
