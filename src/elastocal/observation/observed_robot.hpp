// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/calibration/earlier.hpp"
#include "elastocal/observation/setup.hpp"
#include "elastocal/robot/error_model.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

/// Measurement of one instrument in one posture.
struct Observation {
  int posture = 0;                ///< row of Observations::q
  int instrument = 0;             ///< index in the setup
  Eigen::VectorXd measured = {};  ///< numbers in the order of the kind of instrument
  std::vector<int> effects = {};  ///< indices of Observations::effects that act on its quantities
};

/// Effect of a session on a quantity, which is added to the quantity. Between two sessions the
/// robot was started anew, or the table was displaced a little.
struct SessionEffect {
  int quantity = 0;
  std::string name;
};

/// File and line from which a posture was read.
struct PosturePlace {
  int file = 0;  ///< index in Observations::files
  int line = 0;  ///< line of the file
};

/// All observations, with the positions of all joints.
struct Observations {
  std::vector<std::string> files = {};
  std::vector<SessionEffect> effects = {};
  std::vector<PosturePlace> postures = {};
  Eigen::MatrixXd q = {};         ///< postures x coordinates of the tree, rad or m
  Eigen::MatrixXd approach = {};  ///< see Recording::approach; without rows: unknown
  std::vector<Observation> all = {};

  int posture_count() const { return static_cast<int>(postures.size()); }
  int count() const { return static_cast<int>(all.size()); }
};

/// Model of the robot and its instruments. The reference frame is that of the root link. The first
/// legs of `robot` are the feet, the following ones the observed links.
struct ObservedRobot {
  ErrorModel robot;
  ObservationSetup setup;
  /// Unknown of each parameter of the robot; -1: it stays nominal (T0 and held parameters).
  /// Parameters in common have the same unknown.
  std::vector<int> unknown;
  int unknown_count = 0;
  std::vector<int> leg_of_link;  ///< by link of the tree; -1: not observed, or fixed to the root
  int root_tilt = -1;  ///< quantity with the tilt of a root link that is held still; -1: on feet
  /// Earlier calibration of the robot. For its parameters it is the prior, instead of deviations
  /// from nominal by kind.
  EarlierEstimate earlier = {};

  const Instrument& instrument(int index) const {
    return *setup.instruments[static_cast<std::size_t>(index)];
  }
  /// Whether an instrument is a plate that touches flush; its description is then
  /// `setup.plates[index]`.
  bool IsPlate(int index) const { return index < static_cast<int>(setup.plates.size()); }
};

/// Makes the model of an observed robot. `torsion` and `bending` name the elastic joints.
/// `corrections` are those of joints, of a root link that is held still and of loads
/// (ObservableCorrections). Patterns of the setup that match nothing have no effect here: they may
/// concern springs or corrections of another model of the same robot. Throws InputError for
/// parameters in common of different kinds.
ObservedRobot MakeObservedRobot(const RobotTree& tree, const PlacementOptions& placement,
                                const ObservationSetup& setup, const std::vector<int>& torsion,
                                const std::vector<int>& bending,
                                const std::vector<Correction>& corrections = {});

/// Excludes from the estimate the parameters of joints that move no foot and nothing observed.
void KeepObservedUnknowns(const Observations& observations, ObservedRobot& model);

/// Source of a parameter of the robot, and the unit in which its deviation counts there: 1; for
/// compliances the one that gives the typical deflection under the joint's largest torque; for
/// corrections their typical size.
struct SourceOfParameter {
  int source = kLength;
  double unit = 1.0;
};

/// One entry for each parameter of the robot; those of T0 have no meaning.
std::vector<SourceOfParameter> SourcesOfParameters(const ObservedRobot& model);

/// The first parameter of each unknown of the robot.
std::vector<int> ParameterOfUnknown(const ObservedRobot& model);

/// Fills `approach` from the order of the rows in each file, as NoteApproach of a Recording.
void NoteApproach(Observations& observations);

/// The observations in some postures, in the same order.
Observations SelectPostures(const Observations& observations, const std::vector<int>& postures);

/// The observations without those in `out`; postures without any other observation are left out.
Observations WithoutObservations(const Observations& observations, const std::set<int>& out);

}  // namespace elastocal
