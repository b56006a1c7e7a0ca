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

/// What one instrument showed in one posture.
struct Observation {
  int posture = 0;                ///< row of Observations::q
  int instrument = 0;             ///< of the setup
  Eigen::VectorXd measured = {};  ///< as the kind of the instrument has it
  std::vector<int> effects = {};  ///< of Observations::effects that act on its quantities
};

/// A quantity that differs between sessions: between two of them the robot has been started anew,
/// or the table been moved a little. The effect is added to the quantity.
struct SessionEffect {
  int quantity = 0;
  std::string name;
};

/// Where a posture was read.
struct PosturePlace {
  int file = 0;  ///< of Observations::files
  int line = 0;  ///< of the file
};

/// All that was observed, with the positions of all joints.
struct Observations {
  std::vector<std::string> files = {};
  std::vector<SessionEffect> effects = {};
  std::vector<PosturePlace> postures = {};
  Eigen::MatrixXd q = {};         ///< postures x coordinates of the tree, rad or m
  Eigen::MatrixXd approach = {};  ///< see Recording::approach; no rows: nothing known
  std::vector<Observation> all = {};

  int posture_count() const { return static_cast<int>(postures.size()); }
  int count() const { return static_cast<int>(all.size()); }
};

/// The robot as its instruments see it. Its reference frame is that of the root link; the first
/// legs of `robot` are the feet, the following ones the links that are observed.
struct ObservedRobot {
  ErrorModel robot;
  ObservationSetup setup;
  /// By parameter of the robot: which unknown it is; -1: it stays nominal (T0 and what is held).
  /// Parameters in common have the same one.
  std::vector<int> unknown;
  int unknown_count = 0;
  std::vector<int> leg_of_link;  ///< by link of the tree; -1: not observed, or fixed to the root
  int root_tilt = -1;            ///< quantity: of a root link that is held still; -1: on feet
  /// What an earlier calibration says of the robot: of its parameters it is the prior, instead of
  /// deviations from nominal by kind.
  EarlierEstimate earlier = {};

  const Instrument& instrument(int index) const {
    return *setup.instruments[static_cast<std::size_t>(index)];
  }
  /// Whether an instrument is a plate that touches flush, and then `setup.plates[index]`.
  bool IsPlate(int index) const { return index < static_cast<int>(setup.plates.size()); }
};

/// `torsion`, `bending`: joints that give way; `corrections`: of joints, of a root link that is
/// held still and of loads (ObservableCorrections). Throws InputError for patterns
/// that match nothing, and for parameters in common of different kinds.
ObservedRobot MakeObservedRobot(const RobotTree& tree, const PlacementOptions& placement,
                                const ObservationSetup& setup, const std::vector<int>& torsion,
                                const std::vector<int>& bending,
                                const std::vector<Correction>& corrections = {});

/// Leaves out of the estimate the parameters of joints that move no foot and nothing observed.
void KeepObservedUnknowns(const Observations& observations, ObservedRobot& model);

/// The source of a parameter of the robot's, and the unit in which its deviation counts there (1,
/// but for compliances: how far joints give way under their largest torque; and corrections: their
/// typical size).
struct SourceOfParameter {
  int source = kLength;
  double unit = 1.0;
};

/// One for each parameter of the robot; those of T0 have no meaning.
std::vector<SourceOfParameter> SourcesOfParameters(const ObservedRobot& model);

/// By unknown of the robot the first of its parameters.
std::vector<int> ParameterOfUnknown(const ObservedRobot& model);

/// Fills `approach` from the order of the rows of each file, as NoteApproach of a Recording.
void NoteApproach(Observations& observations);

/// The observations in some postures, which keep their order.
Observations SelectPostures(const Observations& observations, const std::vector<int>& postures);

/// All but these observations; postures that show nothing else are left out.
Observations WithoutObservations(const Observations& observations, const std::set<int>& out);

}  // namespace elastocal
