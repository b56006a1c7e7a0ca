// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/cause_search.hpp"

namespace elastocal {

/// The variable on which a cause depends.
enum class CauseVariable {
  kPosition,  ///< position of a joint, rad or m
  kLoad,      ///< load on a joint, N.m or N
  kApproach,  ///< direction of a joint's last motion, -1 or 1
  kMoment,    ///< moment of the weight on the root link, N.m
  kTime,      ///< h
  kAddedLoad  ///< load on a joint by one unit of the cause, N.m or N
};

/// A cause drawn as displacement of its joint (or of the root link, or of a marker) over its
/// variable. If the cause loads joints, the displacement is the deflection of the joint that
/// deflects most. The points are partial residuals (Larsen and McCleary 1972): the displacement by
/// the cause in a posture, plus what that posture's own residuals ask for beside it.
struct CausePicture {
  CauseFinding finding;
  /// The parameters of `finding` that are drawn: those with the same displacement and variable.
  std::vector<int> parameters;
  int correction = 0;  ///< index of the first one's correction in the model
  CauseVariable variable = CauseVariable::kPosition;
  int joint = -1;             ///< joint whose position, load or motion is the variable; -1: none
  std::string driver, owner;  ///< name of that joint, and of the displaced one; empty: none
  bool is_angle = false;      ///< the displacement is in rad; if false, in m
  bool driver_turns = true;   ///< the driver is a revolute joint; if false, a prismatic one
  int axis = 2;               ///< axis of the joint's deflection (JointLoads)
  double compliance = 0.0;    ///< estimated compliance about it, rad/(N.m) or m/N
  std::vector<int> postures;
  /// By posture: variable, displacement, and its standard deviation due to the noise of the
  /// markers.
  Eigen::VectorXd x, y, sd;
  Eigen::VectorXd curve_x, curve_y;  ///< the cause as estimated
};

/// Configuration of the robot in the postures of a study, without the causes.
struct CauseScene {
  const ErrorModel& wide;  ///< the model of the study
  Geometry geometry = {};
  std::vector<JointLoads> loads = {};  ///< by posture
  const Eigen::MatrixXd& q;            ///< postures x coordinates
};

/// The scene of a recording with markers.
CauseScene SceneOf(const ErrorModel& wide, const Recording& recording,
                   const CalibrationResult& result, const CalibrationOptions& options);

/// Draws at most `most` causes: first those that were taken, each beside those before it, then the
/// others beside the calibration alone, by ascending p. Postures whose displacement has more than
/// four times the median standard deviation are left out, and of very many postures only some are
/// shown.
std::vector<CausePicture> DrawCauses(const LinearStudy& study, const CauseSearch& search,
                                     const CauseScene& scene, int most = 6);

}  // namespace elastocal
