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

/// Root mean square over the markers of the median distance of each, m: a mistake of one joint
/// moves few markers, a wrong sighting is one of many. 0 without any.
double TypicalDistance(const std::vector<std::vector<double>>& by_marker);

/// How far the markers of a posture table typically are from those of the nominal robot once its
/// root link (a free one in each posture) and each marker on its link are where they fit best, m
/// (TypicalDistance). Errors of a robot leave millimetres; they are not estimated, so that a
/// mistake in the table is not taken for one of them. In a long table, evenly spread postures stand
/// for all. 0 without markers.
double PlacedMisfit(const ErrorModel& model, const Recording& recording);

/// The nominal robot where the markers of a posture table have it.
struct PlacedNominal {
  ErrorModel model;  ///< its root link at the origin
  Geometry geometry;
  Transform T_ref_root;
  std::vector<Eigen::Vector3d> places;  ///< of the markers, in their bodies' frames

  /// How far the markers of a posture are from it, root mean square without the furthest one, m.
  double Distance(const Recording& recording, int posture) const;
};

/// Places it as PlacedMisfit does; nothing where markers do not place it. Not for a free root.
/// `errors`: of a calibrated robot, whose joints do not give way; null: the nominal one.
std::optional<PlacedNominal> PlaceNominal(const ErrorModel& model, const Recording& recording,
                                          const Eigen::VectorXd* errors = nullptr);

}  // namespace elastocal
