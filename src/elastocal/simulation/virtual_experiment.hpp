// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/simulation/instrument_options.hpp"
#include "elastocal/simulation/sensors.hpp"
#include "elastocal/simulation/waist_compliance.hpp"
#include "elastocal/simulation/waist_give.hpp"

namespace elastocal {

/// The nominal robot, as a project describes it.
struct DescribedRobot {
  RobotTree tree;
  std::vector<NamedChain> chains;
  std::vector<Marker> markers;
  std::vector<NamedCluster> clusters;
  std::vector<int> torque_sensors;  ///< joints
};

/// All options of a virtual experiment. `seed` replaces the seeds of the parts.
struct VirtualExperimentOptions {
  std::uint64_t seed = 1;
  /// Seed of the robot's errors, if not `seed`. With it, a second recording of the same robot has
  /// other postures, places and noise.
  std::optional<std::uint64_t> robot_seed = {};
  /// Whether the root link drives between the rests of trials without support (DriveBase).
  bool free_root = false;
  TruthOptions truth;
  PhysicsOptions physics;
  MotionOptions motion;
  SensorOptions sensors;
  InstrumentOptions instruments;
  Faults faults;
};

/// Makes the robot rigid and nominal and the sensors perfect: standard deviations, compliances,
/// friction, gaps and the like become zero, encoders are not quantised, and clocks agree. Servos
/// still yield to the load, which encoders measure. Motions and physics stay.
void SwitchOffImperfections(VirtualExperimentOptions& options);

/// A leg's lumped compliance, and the posture in which it was computed: the mean of the postures in
/// which the robot rests on this leg alone in calibration trials, or without any, the posture in
/// which it stands.
struct LegCompliance {
  std::string chain;
  int foot_link = 0;
  Eigen::VectorXd posture;  ///< by coordinate
  WaistCompliance compliance;
};

/// A true robot and the trials that it will play.
struct VirtualExperiment {
  VirtualExperimentOptions options;
  RobotTree described_tree;
  std::vector<NamedCluster> clusters;
  TrueRobot robot;
  std::vector<PlannedTrial> trials;
  std::vector<Transform>
      T_camera_world;  ///< by trial: where the robot stands in the cameras' frame
  std::vector<LegCompliance> legs;
};

/// One trial as it was played and measured.
struct SimulatedTrial {
  TrueMotion motion;
  RawTrial raw;
};

/// Draws the robot that will play `trials`. Throws InputError for faults that name something that
/// does not exist.
VirtualExperiment PrepareExperiment(const DescribedRobot& described,
                                    const VirtualExperimentOptions& options,
                                    std::vector<PlannedTrial> trials);

/// The same for the trials of PlanTrials. Also throws InputError if a leg has no feasible posture.
VirtualExperiment PrepareExperiment(const DescribedRobot& described,
                                    const VirtualExperimentOptions& options);

/// Plays and measures a trial. Trials do not depend on each other: they may be run in any order,
/// and several at a time.
SimulatedTrial RunTrial(const VirtualExperiment& experiment, std::size_t index);

/// Largest deflection of the true robot's waist at the end of each rest of a trial; zero if the
/// root is held still.
WaistGive LargestWaistDeflection(const VirtualExperiment& experiment, std::size_t index,
                                 const TrueMotion& motion);

}  // namespace elastocal
