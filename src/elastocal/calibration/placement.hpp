// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A foot (or the root link) that stands still through some postures of one trial.
struct Footing {
  int trial = 0;
  int leg = -1;               ///< of the model's legs; -1: the root link is held
  std::vector<int> postures;  ///< ascending
};

/// A foot, or a root link that is held, that was displaced between two postures of a trial.
struct Slip {
  int trial = 0;
  int leg = 0;            ///< as in Footing
  int posture = 0;        ///< the first one after it
  double distance = 0.0;  ///< of its markers, m
};

/// Where the robot stood in each posture: what belongs to the experiment, not to the robot. Empty
/// for a table of postures whose waist does not move.
struct Placement {
  std::vector<Footing> footings;
  std::vector<int> footing;              ///< by posture; -1: nothing ties the waist to the floor
  std::vector<Transform> T_ref_waist;    ///< by posture, in the cameras' frame
  std::vector<Transform> T_ref_footing;  ///< by footing: the foot link's frame (root: the waist's)

  bool empty() const { return T_ref_waist.empty(); }
};

/// Footings of all trials: a trial that stands on one of the model's legs, or whose root is held,
/// has one, and one more after each slip of more than `slip_m`, which the markers of the foot (of
/// the root link) show. A trial on both feet has none: how the load is shared is unknown, and the
/// waist is seen by its own markers; nor has one whose root is free. `slips`, where given, tells
/// the slips found.
std::vector<Footing> FindFootings(const ErrorModel& model, const Recording& recording,
                                  double slip_m, std::vector<Slip>* slips = nullptr);

/// A first guess of all poses, by the nominal kinematics and marker positions: the waist of each
/// posture by its markers (least squares), each footing by the first of its waists. A posture with
/// fewer than three markers gets the waist of its neighbour. Empty where the waist does not move.
Placement RegisterPlacement(const ErrorModel& model, const Recording& recording, double slip_m);

}  // namespace elastocal
