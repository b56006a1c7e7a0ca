// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/support_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <Eigen/Cholesky>

#include "elastocal/math/statistics.hpp"
#include "elastocal/math/transform.hpp"

namespace elastocal {
namespace {

constexpr double kDisplaced = 0.02;   // m: no foot slips so far
constexpr double kAtRest = 0.005;     // m: a link at rest stays within this distance
constexpr double kOftenMoved = 0.25;  // share of the frames in which a support has moved
constexpr int kMostLooked = 500;      // frames that are looked at
constexpr std::size_t kLeastLooked = 10;
constexpr double kFurther = 1.5;  // ratio of the travel of two chains: one clearly moves more

double MedianAlong(const std::vector<double>& values) {
  return Median(
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
}

/// For each frame looked at that shows a marker of the body, the median distance of these markers
/// from their usual positions, m.
std::vector<double> BodyDistances(const RobotTree& tree, const std::vector<Marker>& markers,
                                  int body, const MarkerTrajectories& trajectories) {
  const int stride = 1 + trajectories.frame_count() / kMostLooked;
  std::vector<std::vector<double>> of_frame(
      static_cast<std::size_t>(trajectories.frame_count() / stride + 1));
  for (std::size_t m = 0; m < markers.size(); ++m) {
    if (tree.links[markers[m].link].body != body) continue;
    const auto positions = trajectories.positions.middleCols<3>(3 * static_cast<Eigen::Index>(m));
    std::vector<double> along[3];
    for (int i = 0; i < trajectories.frame_count(); i += stride) {
      if (!positions.row(i).allFinite()) continue;
      for (int axis = 0; axis < 3; ++axis) along[axis].push_back(positions(i, axis));
    }
    if (along[0].empty()) continue;
    const Eigen::RowVector3d usual(MedianAlong(along[0]), MedianAlong(along[1]),
                                   MedianAlong(along[2]));
    for (int i = 0; i < trajectories.frame_count(); i += stride) {
      const double distance = (positions.row(i) - usual).norm();
      if (std::isfinite(distance)) of_frame[i / stride].push_back(distance);
    }
  }
  std::vector<double> distances;
  for (const std::vector<double>& seen : of_frame) {
    if (!seen.empty()) distances.push_back(MedianAlong(seen));
  }
  return distances;
}

/// The same for a body that may turn about a ball near the support link's origin: for each frame
/// looked at in which the markers tell the body's pose, the distance of the ball from its usual
/// position, m.
std::vector<double> PivotDistances(const RobotTree& tree, const std::vector<Marker>& markers,
                                   int support, const MarkerTrajectories& trajectories) {
  constexpr double kNear = 1e-3;     // weight of the distance from the origin, per frame
  constexpr double kFurthest = 0.4;  // share of the shank's length: the ball is not at the knee
  const int body = tree.links[support].body;
  const Eigen::Vector3d origin = tree.links[support].T_body_link.translation();
  const int stride = 1 + trajectories.frame_count() / kMostLooked;
  std::vector<Transform> poses;
  for (int i = 0; i < trajectories.frame_count(); i += stride) {
    Eigen::Matrix3Xd on_body(3, 0), seen(3, 0);
    for (std::size_t m = 0; m < markers.size(); ++m) {
      const Link& link = tree.links[markers[m].link];
      const Eigen::Vector3d position =
          trajectories.positions.row(i).segment<3>(3 * static_cast<Eigen::Index>(m)).transpose();
      if (link.body != body || !position.allFinite()) continue;
      on_body.conservativeResize(3, on_body.cols() + 1);
      seen.conservativeResize(3, seen.cols() + 1);
      on_body.rightCols<1>() = link.T_body_link * markers[m].p_link_marker;
      seen.rightCols<1>() = position;
    }
    if (TellPose(on_body)) poses.push_back(FitRigid(on_body, seen));
  }
  if (poses.empty()) return {};
  // The ball c on the body and its place p, by least squares of R c + t - p.
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  const double near = kNear * static_cast<double>(poses.size());
  normal.topLeftCorner<3, 3>().diagonal().setConstant(near);
  right.head<3>() = near * origin;
  for (const Transform& pose : poses) {
    Eigen::Matrix<double, 3, 6> rows;
    rows << pose.linear(), -Eigen::Matrix3d::Identity();
    normal += rows.transpose() * rows;
    right -= rows.transpose() * pose.translation();
  }
  Eigen::Vector3d ball = normal.ldlt().solve(right).head<3>();
  if (!((ball - origin).norm() < kFurthest * origin.norm())) ball = origin;
  std::vector<double> along[3];
  for (const Transform& pose : poses) {
    const Eigen::Vector3d place = pose * ball;
    for (int axis = 0; axis < 3; ++axis) along[axis].push_back(place[axis]);
  }
  std::vector<double> distances;
  const Eigen::Vector3d usual(MedianAlong(along[0]), MedianAlong(along[1]), MedianAlong(along[2]));
  for (const Transform& pose : poses) distances.push_back((pose * ball - usual).norm());
  return distances;
}

bool EndsAChain(const RobotTree& tree, int body) {
  return body > 0 && std::none_of(tree.joints.begin(), tree.joints.end(),
                                  [&](const Joint& joint) { return joint.parent_body == body; });
}

/// Sum of the travel of the joints between the root and `body` that are not between the root and
/// `other`.
double TravelOf(const RobotTree& tree, int body, int other, const Eigen::VectorXd& travel) {
  const std::vector<int> shared = JointsToBody(tree, other);
  double sum = 0.0;
  for (const int joint : JointsToBody(tree, body)) {
    if (std::find(shared.begin(), shared.end(), joint) == shared.end()) sum += travel[joint];
  }
  return sum;
}

/// The first cluster on the body; without one, the link's name.
std::string ClusterOn(const MarkedRobot& robot, int link) {
  for (const LabelCluster& cluster : robot.clusters) {
    for (const int m : cluster.markers) {
      const int body = robot.tree.links[robot.markers[m].link].body;
      if (body == robot.tree.links[link].body) return cluster.name;
    }
  }
  return robot.tree.links[link].name;
}

}  // namespace

std::optional<MovedSupport> FindMovedSupport(const RobotTree& tree,
                                             const std::vector<Marker>& markers, const Trial& trial,
                                             const MarkerTrajectories& trajectories,
                                             const Eigen::VectorXd& travel) {
  if (trial.free_root) return std::nullopt;
  const std::vector<int> support = trial.support.empty() ? std::vector<int>{0} : trial.support;
  // Three feet and more are balls, about which the shanks turn.
  constexpr std::size_t kBalls = 3;
  for (int link : support) {
    const std::vector<double> distances =
        support.size() < kBalls ? BodyDistances(tree, markers, tree.links[link].body, trajectories)
                                : PivotDistances(tree, markers, link, trajectories);
    const auto moved = std::count_if(distances.begin(), distances.end(),
                                     [](double distance) { return distance > kDisplaced; });
    if (distances.size() < kLeastLooked ||
        static_cast<double>(moved) <= kOftenMoved * static_cast<double>(distances.size())) {
      continue;
    }
    MovedSupport found{link, *std::max_element(distances.begin(), distances.end())};
    for (const Marker& marker : markers) {
      const int body = tree.links[marker.link].body;
      const bool stands = std::any_of(support.begin(), support.end(), [&](int declared) {
        return tree.links[declared].body == body;
      });
      if (stands || !EndsAChain(tree, body)) continue;
      const std::vector<double> other = BodyDistances(tree, markers, body, trajectories);
      if (other.size() >= kLeastLooked && *std::max_element(other.begin(), other.end()) < kAtRest) {
        found.still = marker.link;
        found.labels = TravelOf(tree, body, tree.links[link].body, travel) >
                       kFurther * TravelOf(tree, tree.links[link].body, body, travel);
      }
    }
    return found;
  }
  return std::nullopt;
}

std::string Describe(const MovedSupport& moved, const MarkedRobot& robot) {
  const RobotTree& tree = robot.tree;
  char distance[40];
  std::snprintf(distance, sizeof distance, "%.0f mm", 1e3 * moved.distance);
  const std::string what = moved.link == 0 ? "the root link, which should be held,"
                                           : "the support " + tree.links[moved.link].name;
  if (moved.labels) {
    return "the labels of " + ClusterOn(robot, moved.link) + " and " +
           ClusterOn(robot, moved.still) + " are exchanged: " + what + " seems to move by " +
           distance + ", while " + tree.links[moved.still].name +
           " stands still, though its joints move more than those of the support";
  }
  return what + " moves by " + distance +
         (moved.still < 0 ? "" : ", while " + tree.links[moved.still].name + " stands still") +
         "; see `support` in experiment.yaml";
}

}  // namespace elastocal
