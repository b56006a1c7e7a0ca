// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/math/transform.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

/// Root mean square over the markers of the median distance of each marker, m. The median removes
/// wrong observations, while a mistake of one joint, which moves only few markers, still counts. 0
/// without markers.
double TypicalDistance(const std::vector<std::vector<double>>& by_marker);

/// Misfit of a posture table: TypicalDistance of the markers from the nominal robot, m, after the
/// root link (a free one in each posture) and the markers on their links are placed best. Errors of
/// a robot leave millimetres; they are not estimated, so that a mistake in the table is not taken
/// for one of them. A long table is represented by evenly spread postures. 0 without markers.
double PlacedMisfit(const ErrorModel& model, const Recording& recording);

/// The nominal robot, placed by the markers of a posture table.
struct PlacedNominal {
  ErrorModel model;  ///< with the root link at the origin
  Geometry geometry;
  Transform T_ref_root;
  std::vector<Eigen::Vector3d> places;  ///< positions of the markers in their bodies' frames

  /// Distance of the markers of a posture from the robot, root mean square without the furthest
  /// marker, m.
  double Distance(const Recording& recording, int posture) const;
};

/// Places the robot as PlacedMisfit does; nothing where markers do not place it. Not for a free
/// root. `errors` are those of a calibrated robot, without deflection; null: the nominal robot.
std::optional<PlacedNominal> PlaceNominal(const ErrorModel& model, const Recording& recording,
                                          const Eigen::VectorXd* errors = nullptr);

}  // namespace elastocal
