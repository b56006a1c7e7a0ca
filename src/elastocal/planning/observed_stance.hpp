// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/io/posture_file.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/motion/standing_robot.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/moving_chain.hpp"
#include "elastocal/simulation/mjcf.hpp"

namespace elastocal {

/// Height above its table from which a plate is moved straight down to it, m.
inline constexpr double kApproachHeight = 0.05;

/// Draws postures in which a robot stands on the feet of `contact` (or its root link is held still)
/// and touches a table or is seen by instruments. By nominal kinematics the feet stand flat in
/// their places, the centre of mass is above the middle of the support, joints keep the limits of
/// the section `design`, the parts in its contacts do not touch, nothing but the plate touches a
/// table, and the hand reaches a touch from straight above. Torques are not limited.
class ObservedPostureSampler {
 public:
  /// Keeps a reference to the project. Throws InputError for a project without `contact` and
  /// `instruments`, for a foot that is no sole of the section `standing`, and for a robot that
  /// cannot stand.
  ObservedPostureSampler(const Project& project, std::uint64_t seed);

  /// Draws a posture (by coordinate) in which the plate lies flush anywhere on its table; nothing
  /// if none was found. Throws InputError if the project does not state where the table is.
  std::optional<Eigen::VectorXd> DrawTouch(int plate);

  /// Draws a posture for instruments. Joints that move something observed have any position; if the
  /// project has cameras, one of them sees a tag across a joint.
  std::optional<Eigen::VectorXd> DrawLook();

  /// After a draw without result: the most frequent obstacle.
  std::string Blame() const;

  /// The set-up of the project, with the feet in their places.
  const ObservationSetup& setup() const { return setup_; }
  std::vector<int> support() const;  ///< links of the feet, the first foot first
  const StandingRobot& robot() const { return *robot_; }

 private:
  PlacedPosture DrawStance();
  bool Balance(PlacedPosture& pose);
  bool TryTouch(int plate, const TableTop& table, PlacedPosture& pose);
  bool ReachesAbove(int plate, const PlacedPosture& touch);
  bool Feasible(const PlacedPosture& pose);
  bool Blamed(const std::string& reason);

  const Project& project_;
  ObservationSetup setup_;
  std::unique_ptr<StandingRobot> robot_;
  Random random_;
  std::vector<std::unique_ptr<MovingChain>> arms_;  // by plate
  std::vector<int> moved_;  // coordinates of joints that move something observed
  Eigen::Vector2d com_ = Eigen::Vector2d::Zero();  // centre of mass of the stance that was drawn
  std::map<std::string, int> blame_;
};

/// The plate as described; `edge` is its edge length, m.
PhysicalPlate DescribedPlate(const ContactPlate& plate, double edge = 0.08);

/// The coordinates with which a hand moves its plate: those of joints that carry it and that no
/// foot and no other plate needs; if these are fewer than three, those of all joints that carry it.
std::vector<int> HandCoordinates(const RobotTree& tree, const ObservationSetup& setup, int plate);

/// The joints that carry a plate but do not belong to a leg with a foot of `contact`, for a robot
/// in this posture.
MovingChain HandOf(const RobotTree& tree, const ObservationSetup& setup, int plate,
                   const Eigen::VectorXd& q);

/// Moves the joints of a hand in `q`, within limits by coordinate, until the plate's face has the
/// given pose (to 1e-9 m and rad). Returns false, with `q` unchanged, if that is out of reach.
bool ReachWithPlate(MovingChain& hand, const ContactPlate& plate, const Transform& T_root_face,
                    const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, Eigen::VectorXd& q);

/// Inputs of an instrument in a nominal posture, with the given pose of the root link on the floor.
Sight NominalSight(const ObservationSetup& setup, const Instrument& instrument,
                   const std::vector<Transform>& T_root_link, const Transform& T_floor_root);

}  // namespace elastocal
