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

/// The robot on its feet (or with its root link held still) in one posture.
class ObservedPosture {
 public:
  /// Keeps a reference.
  explicit ObservedPosture(const ObservedRobot& model) : model_(model), jacobian_(model.robot) {}

  void Evaluate(const Geometry& geometry, const ObservedValues& values, const Eigen::VectorXd& q,
                const JointLoads& loads);

  /// What an observation in this posture depends on.
  Sight SightOf(const Observations& observations, const Observation& observation,
                const ObservedValues& values) const;

  std::vector<StandingFoot> Feet() const;
  const GeneralizedJacobian& jacobian() const { return jacobian_; }
  const Transform& T_floor_root() const { return T_floor_root_; }
  /// Rotation [rad] and displacement of its origin [m] on the floor by screws of each foot in the
  /// root's frame, and by the two tilts of a root that is held still.
  const std::vector<Matrix6d>& root_by_foot() const { return by_foot_; }
  const Eigen::Matrix<double, 6, 2>& root_by_tilt() const { return by_tilt_; }

 private:
  const ObservedRobot& model_;
  GeneralizedJacobian jacobian_;
  Transform T_floor_root_ = Transform::Identity();
  std::vector<Matrix6d> by_foot_;
  Eigen::Matrix<double, 6, 2> by_tilt_ = Eigen::Matrix<double, 6, 2>::Zero();
};

/// The nominal robot; quantities zero, their origins where the instruments put them for the nominal
/// robot (Instrument::Begin), those of trackers by registration.
ObservedValues NominalValues(const ObservedRobot& model, const Observations& observations);

/// Loads of all joints in each posture.
std::vector<JointLoads> ObservedLoads(const ObservedRobot& model, const Observations& observations,
                                      const Eigen::VectorXd& errors);

/// What each observation depends on. Effects that are not known (`effects` empty) are none. Throws
/// std::invalid_argument for values of other quantities than those of the model.
std::vector<Sight> SightsOf(const ObservedRobot& model, const Observations& observations,
                            const ObservedValues& values, const std::vector<JointLoads>& loads);

/// What is left of each observation for these values, SI, the robot bent by its loads.
std::vector<Eigen::VectorXd> LeftOf(const ObservedRobot& model, const Observations& observations,
                                    const ObservedValues& values);

}  // namespace elastocal
