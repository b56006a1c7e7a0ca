// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/observation/observed_robot.hpp"
#include "elastocal/robot/jacobian.hpp"
#include "elastocal/robot/shared_support.hpp"

namespace elastocal {

/// All that is estimated from observations, SI.
struct ObservedValues {
  Eigen::VectorXd robot = {};                  ///< errors, one a parameter of the robot
  std::vector<QuantityValue> quantities = {};  ///< by quantity of the setup
  std::vector<Eigen::VectorXd> effects = {};   ///< by effect of the observations
};

/// Kinematics of the robot on its feet (or with its root link held still) in one posture.
class ObservedPosture {
 public:
  /// Keeps a reference.
  explicit ObservedPosture(const ObservedRobot& model) : model_(model), jacobian_(model.robot) {}

  void Evaluate(const Geometry& geometry, const ObservedValues& values, const Eigen::VectorXd& q,
                const JointLoads& loads);

  /// Inputs of an observation in this posture.
  Sight SightOf(const Observations& observations, const Observation& observation,
                const ObservedValues& values) const;

  std::vector<StandingFoot> Feet() const;
  const GeneralizedJacobian& jacobian() const { return jacobian_; }
  const Transform& T_floor_root() const { return T_floor_root_; }
  /// Derivatives of the root's rotation [rad] and displacement of its origin [m] on the floor: by
  /// the screw of each foot in the root's frame, and by the two tilts of a root that is held still.
  const std::vector<Matrix6d>& root_by_foot() const { return by_foot_; }
  const Eigen::Matrix<double, 6, 2>& root_by_tilt() const { return by_tilt_; }

 private:
  const ObservedRobot& model_;
  GeneralizedJacobian jacobian_;
  Transform T_floor_root_ = Transform::Identity();
  std::vector<Matrix6d> by_foot_;
  Eigen::Matrix<double, 6, 2> by_tilt_ = Eigen::Matrix<double, 6, 2>::Zero();
};

/// Nominal values: the nominal robot, with quantities zero. Their origins are those that the
/// instruments suggest for the nominal robot (Instrument::Begin); those of trackers are found by
/// registration.
ObservedValues NominalValues(const ObservedRobot& model, const Observations& observations);

/// Loads of all joints in each posture, for a robot with these errors.
std::vector<JointLoads> ObservedLoads(const ObservedRobot& model, const Observations& observations,
                                      const Eigen::VectorXd& errors);

/// Inputs of each observation. If effects are not known (`effects` empty), they are zero. Throws
/// std::invalid_argument for values of other quantities than the model's.
std::vector<Sight> SightsOf(const ObservedRobot& model, const Observations& observations,
                            const ObservedValues& values, const std::vector<JointLoads>& loads);

/// Residual of each observation for these values, SI, with the robot deflected by its loads.
std::vector<Eigen::VectorXd> LeftOf(const ObservedRobot& model, const Observations& observations,
                                    const ObservedValues& values);

}  // namespace elastocal
