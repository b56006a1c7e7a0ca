#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "elastocal/simulation/base_compliance.hpp"
#include "elastocal/simulation/sensors.hpp"
#include "elastocal/simulation/waist_give.hpp"

namespace elastocal {

/// The robot's description, as a project has it.
struct DescribedRobot {
  RobotTree tree;
  std::vector<NamedChain> chains;
  std::vector<Marker> markers;
  std::vector<NamedCluster> clusters;
  std::vector<int> torque_sensors;  ///< joints
};

/// Everything that a virtual experiment can be told. `seed` replaces the seeds of the parts.
struct VirtualExperimentOptions {
  std::uint64_t seed = 1;
  TruthOptions truth;
  PhysicsOptions physics;
  MotionOptions motion;
  SensorOptions sensors;
  Faults faults;
};

/// A rigid robot as it is described, seen by perfect sensors: standard deviations, compliances,
/// friction, gaps and the like all zero, encoders not quantised, clocks in step. Servos still give
/// way to the load, which encoders see. Motions and physics stay.
void SwitchOffImperfections(VirtualExperimentOptions& options);

/// A leg's lumped compliance and the posture that it was computed in.
struct LegCompliance {
  std::string chain;
  int foot_link = 0;
  Eigen::VectorXd posture;  ///< by coordinate
  BaseCompliance base;
};

/// A true robot and what it will be asked to do.
struct VirtualExperiment {
  VirtualExperimentOptions options;
  RobotTree described_tree;
  std::vector<NamedCluster> clusters;
  TrueRobot robot;
  std::vector<PlannedTrial> trials;
  std::vector<Transform> T_camera_world;  ///< by trial: where the robot stands before the cameras
  std::vector<LegCompliance> legs;
};

/// One trial as it was played and measured.
struct SimulatedTrial {
  TrueMotion motion;
  RawTrial raw;
};

/// Draws the robot that shall play `trials`. Throws InputError for faults that name what is not
/// there.
VirtualExperiment PrepareExperiment(const DescribedRobot& described,
                                    const VirtualExperimentOptions& options,
                                    std::vector<PlannedTrial> trials);

/// The same for the trials of PlanTrials. Throws InputError also where a leg has no feasible
/// posture.
VirtualExperiment PrepareExperiment(const DescribedRobot& described,
                                    const VirtualExperimentOptions& options);

/// Plays and measures a trial. Trials do not depend on each other: any order, or several at a time.
SimulatedTrial RunTrial(const VirtualExperiment& experiment, std::size_t index);

/// Of the true robot at rest, at the end of each posture of a trial; zero where the root is held.
WaistGive LargestWaistDeflection(const VirtualExperiment& experiment, std::size_t index,
                                 const TrueMotion& motion);

}  // namespace elastocal
