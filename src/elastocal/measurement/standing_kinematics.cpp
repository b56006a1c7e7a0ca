// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/standing_kinematics.hpp"

namespace elastocal {

StandingKinematics::StandingKinematics(const MarkedRobot& robot, const std::vector<int>& markers,
                                       const std::vector<int>& standing) {
  for (const int link : standing) standing_.push_back(robot.tree.links[link]);
  std::vector<Marker> carried;
  for (const int marker : markers) carried.push_back(robot.markers[marker]);
  for (const Marker& marker : carried) {
    const Link& link = robot.tree.links[marker.link];
    bodies_.push_back(link.body);
    p_body_marker_.push_back(link.T_body_link * marker.p_link_marker);
  }
  // The joints that carry the standing links must move in the model, even without markers.
  for (const int link : standing) {
    carried.push_back({.name = "on " + robot.tree.links[link].name, .link = link});
  }
  model_ = MakeErrorModel(robot.tree, std::move(carried));
  geometry_ = ApplyErrors(model_, Eigen::VectorXd::Zero(model_.parameter_count()));
  const Eigen::Matrix3Xd origins = Origins(BodyTransforms(model_, geometry_, robot.q_not_logged));
  if (TellPose(origins)) origins_ = origins;
}

Eigen::Matrix3Xd StandingKinematics::Positions(const Eigen::VectorXd& q) const {
  return PositionsOn(Bodies(q));
}

std::vector<Transform> StandingKinematics::Bodies(const Eigen::VectorXd& q) const {
  std::vector<Transform> bodies = BodyTransforms(model_, geometry_, q);
  const Transform T_standing_root =
      origins_.cols() > 0 ? FitRigid(Origins(bodies), origins_)
                          : (bodies[standing_.front().body] * standing_.front().T_body_link)
                                .inverse(Eigen::Isometry);
  for (Transform& body : bodies) body = T_standing_root * body;
  return bodies;
}

Eigen::Matrix3Xd StandingKinematics::PositionsOn(const std::vector<Transform>& bodies) const {
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(bodies_.size()));
  for (std::size_t m = 0; m < bodies_.size(); ++m) {
    positions.col(static_cast<Eigen::Index>(m)) = bodies[bodies_[m]] * p_body_marker_[m];
  }
  return positions;
}

Eigen::Matrix3Xd StandingKinematics::Origins(const std::vector<Transform>& T_root_body) const {
  Eigen::Matrix3Xd origins(3, static_cast<Eigen::Index>(standing_.size()));
  for (std::size_t k = 0; k < standing_.size(); ++k) {
    origins.col(static_cast<Eigen::Index>(k)) =
        T_root_body[standing_[k].body] * standing_[k].T_body_link.translation();
  }
  return origins;
}

}  // namespace elastocal
