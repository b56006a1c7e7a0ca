// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/error_model.hpp"
#include "elastocal/robot/legs.hpp"
#include "elastocal/simulation/series_random.hpp"

namespace elastocal {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// How far the true robot is from its description. Values are standard deviations of normal draws
/// unless stated otherwise; 0 switches an imperfection off. Sizes are those of the paper's Table 1;
/// docs/accuracy.md says why. "Upper" means head, arms and trunk.
struct TruthOptions {
  std::uint64_t seed = 1;
  /// Errors that robots of a series have in common; all errors except positions of markers.
  SeriesOptions series = {};

  /// Lengths below (except those of markers) are for a robot on legs whose root link stands this
  /// high [m]. On a robot that is half as high they are half as large.
  double described_height = 1.083;

  // Geometry: every joint's placement has a general displacement (three lengths, three angles).
  double upper_offset_sd =
      M_PI / 180.0;  ///< of joint zeros, rad (for prismatic joints: length_sd, m)
  double leg_offset_sd = 0.5 * M_PI / 180.0;  ///< rad
  double length_sd = 1.2e-3;                  ///< m, each of three directions
  double angle_sd = 0.3 * M_PI / 180.0;       ///< rad, each of three axes
  double upper_geometry_scale = 0.7;  ///< factor on all of the above for head, arms and trunk
  double leg_geometry_scale = 1.6;    ///< the same for the legs
  double marker_sd = 3e-3;            ///< of a marker's coordinate on its link, m
  // Errors of linkages have the standard deviations of their priors, times the same factors.

  // Elasticity. Joint springs about the joints' axes: stiffness log-uniform between two values,
  // N.m/rad; along those of sliding joints, of legs or not, N/m: spindles, belts of steel, racks.
  double upper_stiffness_least = 0.3e5, upper_stiffness_most = 5e5;
  double leg_stiffness_least = 2e5, leg_stiffness_most = 6e5;
  double slide_stiffness_least = 1e6, slide_stiffness_most = 1e7;
  double upper_elasticity_scale = 1.0;  ///< factor on the compliances; 0: rigid
  double leg_elasticity_scale = 2.0;    ///< factor on the compliances of the legs' joints and links
  /// Compliance of a leg's links, each half way between its joints, along and about the link's axes
  /// [m/N x 3, rad/(N.m) x 3]. The three values are for the root link between its origin and the
  /// hip, for the first half of the leg's links, and for the rest. Each entry is multiplied by a
  /// factor drawn uniformly within 1 +- link_compliance_spread.
  Vector6d pelvis_compliance{{2e-7, 2e-7, 4e-7, 8e-6, 6e-5, 2e-6}};
  Vector6d hip_link_compliance{{2e-7, 2e-7, 4e-7, 2e-6, 5e-6, 1e-6}};
  Vector6d shank_link_compliance{{2e-7, 2e-7, 4e-7, 1e-6, 5e-7, 1e-6}};
  double link_compliance_spread = 0.3;

  // Inertia.
  double mass_sd = 0.05;  ///< relative
  double com_sd = 3e-3;   ///< of each coordinate of a link's centre of mass, m

  double friction_share = 0.003;  ///< ratio of a joint's Coulomb friction to its largest effort

  // Torque sensors.
  double torque_gain_sd = 0.02;  ///< relative
  double torque_bias_sd = 0.5;   ///< N.m (at most 2 % of the largest effort)

  // Causes beyond geometry and springs (docs/diagnose.md).
  std::string heavy_link = {};       ///< link with an additional error of mass; empty: none
  double heavy_share = 0.0;          ///< additional mass of `heavy_link`, share of its mass
  std::string creeping_marker = {};  ///< marker that moves along x of its link; empty: none
  double creep = 0.0;                ///< speed of `creeping_marker`, m/h
};

/// The true robot, with what its description does not say.
struct TrueRobot {
  RobotTree tree;  ///< with the true placements, masses and centres of mass
  std::vector<Leg> legs;
  std::vector<Marker> markers;  ///< at their true positions
  Eigen::VectorXd offset;       ///< by joint: true position = encoder's + offset, rad or m
  Eigen::VectorXd compliance;   ///< by joint, about or along its axis, rad/(N.m) or m/N; 0: rigid
  /// By joint, compliance of the link that carries it, half way between that link's own joint (or
  /// the root link's origin) and this one, in the link's axes, m/N and rad/(N.m); zeros mean rigid.
  std::vector<Vector6d> link_compliance;
  std::vector<Vector6d> foot_compliance;  ///< by leg, the same between its last joint and the sole
  Eigen::VectorXd friction;               ///< by joint, N.m or N
  std::vector<bool> torque_sensor;        ///< by joint: whether it has one
  Eigen::VectorXd torque_gain, torque_bias;  ///< by joint: reading = gain * torque + bias
  int creeping_marker = -1;                  ///< moves along x of its link; -1: none
  double creep = 0.0;                        ///< m/h, from the beginning of a trial
  /// The robot as described, if it has linkages. `tree` has the true rods, whose loops close on the
  /// true tree; joints of linkages have no `offset`.
  RobotTree described;
  std::vector<Eigen::VectorXd> linkage_errors;  ///< of the true rods, by linkage: WithErrors
};

/// The robot exactly as described: rigid, without friction, perfect sensors on the given joints.
TrueRobot NominalRobot(RobotTree tree, std::vector<Marker> markers, std::vector<Leg> legs,
                       const std::vector<int>& torque_sensors);

/// A robot with errors drawn as the options say. The same seed draws the same errors for each kind
/// of imperfection whatever the options of the others. Throws InputError for a link or marker that
/// does not exist.
TrueRobot DrawTrueRobot(const TrueRobot& nominal, const TruthOptions& options);

/// True joint positions, by joint, without deflection, for encoder positions by coordinate of the
/// tree; rad or m. Encoders of linkages are on the motors; their joints' encoder positions are
/// those that the described rods give.
Eigen::VectorXd TrueJointPositions(const TrueRobot& robot, const Eigen::VectorXd& encoders);

/// Inverse of TrueJointPositions: encoder positions, by joint, for true positions by joint.
Eigen::VectorXd EncoderPositions(const TrueRobot& robot, const Eigen::VectorXd& positions);

/// Poses of all links in the root link's frame, like LinkTransforms, for true positions by joint.
std::vector<Transform> TrueLinkTransforms(const TrueRobot& robot, const Eigen::VectorXd& positions);

}  // namespace elastocal
