// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/level_feet.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/rotation_vector.hpp"

namespace elastocal {

LevelFeet::LevelFeet(const TrueRobot& robot, const std::vector<int>& support,
                     const Eigen::VectorXd& encoders)
    : robot_(robot), support_(support) {
  const std::vector<Transform> T_root_link =
      TrueLinkTransforms(robot, TrueJointPositions(robot, encoders));
  for (int foot : support) {
    const auto leg = std::find_if(robot.legs.begin(), robot.legs.end(),
                                  [&](const Leg& of) { return of.foot_link == foot; });
    if (leg == robot.legs.end()) throw std::invalid_argument("feet belong to legs");
    for (int k : leg->joints) {
      const int coordinate = robot.tree.joints[Size(k)].coordinate;
      if (std::find(coordinates_.begin(), coordinates_.end(), coordinate) == coordinates_.end()) {
        coordinates_.push_back(coordinate);
      }
    }
    Transform T_floor_foot(leg->R_floor_foot);
    if (!T_floor_foot_.empty()) {
      const Transform at = T_floor_foot_.front() * T_root_link[Size(support.front())].inverse() *
                           T_root_link[Size(foot)];
      const Eigen::Matrix3d turned = at.linear() * leg->R_floor_foot.transpose();
      T_floor_foot.linear() =
          RotZ(std::atan2(turned(1, 0), turned(0, 0))).linear() * leg->R_floor_foot;
      T_floor_foot.translation() << at.translation().x(), at.translation().y(), 0.0;
    }
    T_floor_foot_.push_back(T_floor_foot);
  }
}

Eigen::VectorXd LevelFeet::Gaps(const Eigen::VectorXd& encoders) const {
  const std::vector<Transform> T_root_link =
      TrueLinkTransforms(robot_, TrueJointPositions(robot_, encoders));
  Eigen::VectorXd gaps(6 * static_cast<Eigen::Index>(support_.size() - 1));
  const Transform T_floor_root = T_floor_foot_[0] * T_root_link[Size(support_[0])].inverse();
  for (std::size_t f = 1; f < support_.size(); ++f) {
    const Transform found = T_floor_root * T_root_link[Size(support_[f])];
    const auto row = 6 * static_cast<Eigen::Index>(f - 1);
    gaps.segment<3>(row) = found.translation() - T_floor_foot_[f].translation();
    gaps.segment<3>(row + 3) =
        RotationVector(found.linear() * T_floor_foot_[f].linear().transpose());
  }
  return gaps;
}

Eigen::VectorXd LevelFeet::Yield(Eigen::VectorXd encoders) const {
  constexpr int kIterations = 20;
  constexpr double kClosed = 1e-9;  // m and rad
  constexpr double kStep = 1e-6;    // rad or m
  if (support_.size() < 2) return encoders;
  for (int i = 0; i < kIterations; ++i) {
    const Eigen::VectorXd gaps = Gaps(encoders);
    if (gaps.norm() < kClosed) break;
    Eigen::MatrixXd J(gaps.size(), static_cast<Eigen::Index>(coordinates_.size()));
    for (std::size_t c = 0; c < coordinates_.size(); ++c) {
      Eigen::VectorXd moved = encoders;
      moved[coordinates_[c]] += kStep;
      J.col(static_cast<Eigen::Index>(c)) = (Gaps(moved) - gaps) / kStep;
    }
    const Eigen::VectorXd change = ShortestSolution(J, -gaps);
    for (std::size_t c = 0; c < coordinates_.size(); ++c) {
      encoders[coordinates_[c]] += change[static_cast<Eigen::Index>(c)];
    }
  }
  return encoders;
}

}  // namespace elastocal
