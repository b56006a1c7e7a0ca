// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/seen_from.hpp"

#include <map>
#include <utility>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

/// Markers (as indices into the trajectories) by the body that carries them, bodies nearest to the
/// root first.
std::map<std::pair<std::size_t, int>, std::vector<int>> ByBody(const MarkedRobot& robot,
                                                               const std::vector<int>& markers) {
  std::map<std::pair<std::size_t, int>, std::vector<int>> columns;
  for (std::size_t m = 0; m < markers.size(); ++m) {
    const int body = robot.tree.links[Size(robot.markers[Size(markers[m])].link)].body;
    columns[{JointsToBody(robot.tree, body).size(), body}].push_back(static_cast<int>(m));
  }
  return columns;
}

Eigen::Matrix3Xd PositionsIn(const MarkerTrajectories& trajectories, int frame,
                             const std::vector<int>& columns) {
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    positions.col(static_cast<Eigen::Index>(k)) =
        trajectories.positions.block<1, 3>(frame, 3 * columns[k]).transpose();
  }
  return positions;
}

Eigen::Matrix3Xd NominalPositions(const MarkedRobot& robot, const std::vector<int>& markers,
                                  const std::vector<int>& columns) {
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Marker& marker = robot.markers[Size(markers[Size(columns[k])])];
    positions.col(static_cast<Eigen::Index>(k)) =
        robot.tree.links[Size(marker.link)].T_body_link * marker.p_link_marker;
  }
  return positions;
}

/// The trajectories in the frame of a body, whose pose the markers `placing` tell; `nominal` are
/// their positions in that frame.
MarkerTrajectories InBody(const std::vector<int>& placing, const Eigen::Matrix3Xd& nominal,
                          MarkerTrajectories trajectories) {
  for (int frame = 0; frame < trajectories.frame_count(); ++frame) {
    const Eigen::Matrix3Xd placed = PositionsIn(trajectories, frame, placing);
    auto row = trajectories.positions.row(frame);
    if (!placed.allFinite()) {
      row.setConstant(kNaN);
      continue;
    }
    const Transform T_body_camera = FitRigid(placed, nominal);
    for (Eigen::Index column = 0; column < row.size(); column += 3) {
      const Eigen::Vector3d p = row.segment<3>(column).transpose();
      row.segment<3>(column) = (T_body_camera * p).transpose();
    }
    for (const int own : placing) row.segment<3>(3 * own).setConstant(kNaN);
  }
  return trajectories;
}

}  // namespace

std::optional<SeenFrom> SeeFromMarkedBody(const MarkedRobot& robot, const std::vector<int>& markers,
                                          const MarkerTrajectories& trajectories) {
  for (const auto& [place, columns] : ByBody(robot, markers)) {
    const Eigen::Matrix3Xd nominal = NominalPositions(robot, markers, columns);
    if (!TellPose(nominal) || columns.size() == markers.size()) continue;
    return SeenFrom{robot.markers[Size(markers[Size(columns[0])])].link,
                    InBody(columns, nominal, trajectories)};
  }
  return std::nullopt;
}

}  // namespace elastocal
