// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/cause_search.hpp"

namespace elastocal {

/// What drives a cause.
enum class CauseVariable {
  kPosition,  ///< of a joint, rad or m
  kLoad,      ///< of a joint, N.m or N
  kApproach,  ///< direction of the last motion, -1 or 1
  kMoment,    ///< of the weight on the root link, N.m
  kTime,      ///< h
  kAddedLoad  ///< on a joint, by one unit of the cause, N.m or N
};

/// What a cause looks like: displacement of the joint (or of the root link, or of a marker) against
/// what drives it. If the cause loads joints, it is the deflection of the joint that gives way
/// most. The points are partial residuals (Larsen and McCleary 1972): the displacement that the
/// cause has in a posture, and what that posture's own residuals ask for beside it.
struct CausePicture {
  CauseFinding finding;
  /// Those of `finding.parameters` that are drawn: with one displacement and one variable.
  std::vector<int> parameters;
  int correction = 0;  ///< of the model, of the first of them
  CauseVariable variable = CauseVariable::kPosition;
  int joint = -1;             ///< whose position, load or motion is the variable; -1: of none
  std::string driver, owner;  ///< name of that joint, and of the one displaced; empty: of none
  bool is_angle = false;      ///< whether the displacement is in rad, and not in m
  bool driver_turns = true;   ///< whether the driver is a revolute joint, and not a slide
  int axis = 2;               ///< of the joint's deflection (JointLoads)
  double compliance = 0.0;    ///< about it, as estimated, rad/(N.m) or m/N
  std::vector<int> postures;
  /// By posture: variable, displacement, and standard deviation of that by the noise of the
  /// markers.
  Eigen::VectorXd x, y, sd;
  Eigen::VectorXd curve_x, curve_y;  ///< the cause as it was estimated
};

/// The robot in the postures of a study, without the causes.
struct CauseScene {
  const ErrorModel& wide;  ///< the model of the study
  Geometry geometry = {};
  std::vector<JointLoads> loads = {};  ///< by posture
  const Eigen::MatrixXd& q;            ///< postures x coordinates
};

/// That of a recording with markers.
CauseScene SceneOf(const ErrorModel& wide, const Recording& recording,
                   const CalibrationResult& result, const CalibrationOptions& options);

/// At most `most` pictures: of the causes that were taken, each beside those before it, then of the
/// others, the smallest p first, beside the calibration alone. Postures in which the displacement
/// is known four times worse than in most are left out, and of very many only some are shown.
std::vector<CausePicture> DrawCauses(const LinearStudy& study, const CauseSearch& search,
                                     const CauseScene& scene, int most = 6);

}  // namespace elastocal
