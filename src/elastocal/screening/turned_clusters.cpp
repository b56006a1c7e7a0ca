// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/turned_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kFewestOfTurned = 3;  // markers
constexpr double kFarFromProject = 0.05;    // m: beyond the errors of a ruler
constexpr double kLeastTurn = std::numbers::pi / 9.0;
constexpr double kLeftByTurn = 0.3;  // share of the distance from the project

/// Positions of the markers of a cluster in the frame of the joint that carries them, m.
struct PlacesOnJoint {
  Eigen::Matrix3Xd project, estimated;
};

/// Estimated positions of all markers on their links minus those of the project, m.
Eigen::Matrix3Xd MarkerErrors(const CalibrationResult& fit) {
  Eigen::Matrix3Xd errors = Eigen::Matrix3Xd::Zero(3, fit.model.marker_count());
  for (int p = 0; p < fit.model.parameter_count(); ++p) {
    const Parameter& parameter = fit.model.parameters[Size(p)];
    if (parameter.kind != ParameterKind::kMarker) continue;
    errors(parameter.name.back() - 'x', parameter.marker) = fit.delta[p];  // marker.NAME.x|y|z
  }
  return errors;
}

PlacesOnJoint PlacesOf(const CalibrationResult& fit, const std::vector<int>& markers,
                       const Eigen::Matrix3Xd& errors) {
  const auto count = static_cast<Eigen::Index>(markers.size());
  PlacesOnJoint places{Eigen::Matrix3Xd(3, count), Eigen::Matrix3Xd(3, count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const int m = markers[static_cast<std::size_t>(k)];
    const Marker& marker = fit.model.markers[Size(m)];
    const Transform& T_body_link = fit.model.tree.links[Size(marker.link)].T_body_link;
    places.project.col(k) = T_body_link * marker.p_link_marker;
    places.estimated.col(k) = T_body_link * Eigen::Vector3d(marker.p_link_marker + errors.col(m));
  }
  return places;
}

/// The rotation about the axis that brings the project's positions nearest to the estimated ones.
double BestTurn(const PlacesOnJoint& places, const Eigen::Vector3d& axis) {
  double along = 0.0, across = 0.0;
  for (Eigen::Index k = 0; k < places.project.cols(); ++k) {
    const Eigen::Vector3d from = places.project.col(k), to = places.estimated.col(k);
    along += from.dot(to) - axis.dot(from) * axis.dot(to);
    across += axis.dot(from.cross(to));
  }
  return std::atan2(across, along);
}

double RmsDistance(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a - b).norm() / std::sqrt(static_cast<double>(a.cols()));
}

/// Whether a marker on another body is beyond the joint, and so determines the joint's zero.
bool IsToldBeyond(const ErrorModel& model, int joint) {
  const RobotTree& tree = model.tree;
  return std::ranges::any_of(model.markers, [&](const Marker& marker) {
    int body = tree.links[Size(marker.link)].body;
    if (body == joint + 1) return false;
    while (body > joint + 1) body = tree.joints[Size(body - 1)].parent_body;
    return body == joint + 1;
  });
}

std::optional<TurnedCluster> TurnOf(const CalibrationResult& fit, const LabelCluster& cluster,
                                    const Eigen::Matrix3Xd& errors) {
  if (cluster.markers.size() < kFewestOfTurned) return std::nullopt;
  const RobotTree& tree = fit.model.tree;
  const int link = fit.model.markers[Size(cluster.markers.front())].link;
  const int joint = tree.links[Size(link)].body - 1;
  if (joint < 0 || tree.joints[Size(joint)].type != JointType::kRevolute) return std::nullopt;
  if (tree.joints[Size(joint)].mimic || IsToldBeyond(fit.model, joint)) return std::nullopt;
  const PlacesOnJoint places = PlacesOf(fit, cluster.markers, errors);
  const double displaced = RmsDistance(places.project, places.estimated);
  const Eigen::Vector3d& axis = tree.joints[Size(joint)].axis;
  const double angle = BestTurn(places, axis);
  if (!(displaced > kFarFromProject) || std::abs(angle) < kLeastTurn) return std::nullopt;
  const Eigen::Matrix3Xd turned = Eigen::AngleAxisd(angle, axis) * places.project;
  if (RmsDistance(turned, places.estimated) > kLeftByTurn * displaced) return std::nullopt;
  return TurnedCluster{cluster.name, tree.joints[Size(joint)].name, angle, displaced};
}

}  // namespace

std::vector<TurnedCluster> FindTurnedClusters(const CalibrationResult& fit,
                                              const std::vector<LabelCluster>& clusters) {
  const Eigen::Matrix3Xd errors = MarkerErrors(fit);
  std::vector<TurnedCluster> found;
  for (const LabelCluster& cluster : clusters) {
    if (const auto one = TurnOf(fit, cluster, errors)) found.push_back(*one);
  }
  return found;
}

std::string Describe(const TurnedCluster& found) {
  char text[120];
  std::snprintf(text, sizeof text,
                ": its markers are %.3g mm from where the project has them, as if turned by %.3g "
                "degrees about the axis of ",
                1e3 * found.displaced, found.angle * 180.0 / std::numbers::pi);
  return "cluster " + found.cluster + text + found.joint +
         ". If they are where the project says, the logged positions of " + found.joint +
         " have another zero, and what it carries is turned by as much in the calibrated URDF, "
         "which no residual shows: correct the log, or the places in the project";
}

}  // namespace elastocal
