// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/measurement/recording.hpp"
#include "elastocal/robot/error_model.hpp"

namespace elastocal {

/// A foot (or the held root link) that stands still through some postures of one trial.
struct Footing {
  int trial = 0;
  int leg = -1;               ///< index of the model's leg; -1: the root link is held
  std::vector<int> postures;  ///< indices of the postures, ascending
};

/// A displacement of a standing foot, or of a held root link, between two postures of a trial.
struct Slip {
  int trial = 0;
  int leg = 0;            ///< as in Footing
  int posture = 0;        ///< the first posture after the displacement
  double distance = 0.0;  ///< median displacement of its markers, m
};

/// Poses of the waist and of the footings in a recording. They belong to the experiment, not to the
/// robot. Empty for a posture table, in which the waist does not move.
struct Placement {
  std::vector<Footing> footings;
  std::vector<int> footing;              ///< by posture; -1: nothing ties the waist to the floor
  std::vector<Transform> T_ref_waist;    ///< by posture, in the cameras' frame
  std::vector<Transform> T_ref_footing;  ///< by footing: the foot link's frame (root: the waist's)

  bool empty() const { return T_ref_waist.empty(); }
};

/// Finds the footings of all trials. A trial that stands on one of the model's legs, or whose root
/// is held, has one, and a further one after each slip: a displacement of the markers of the foot
/// (of the root link) by more than `slip_m`. A trial on both feet has none, because the
/// distribution of the load is unknown and the waist's own markers show the waist. A trial with a
/// free root has none either. `slips`, if given, receives the slips.
std::vector<Footing> FindFootings(const ErrorModel& model, const Recording& recording,
                                  double slip_m, std::vector<Slip>* slips = nullptr);

/// First guess of all poses by the nominal kinematics and marker positions. The waist of each
/// posture is placed by its markers (least squares), each footing by the waist of its first
/// posture. A posture with fewer than three markers gets the waist of the posture before it. Empty
/// where the waist does not move.
Placement RegisterPlacement(const ErrorModel& model, const Recording& recording, double slip_m);

}  // namespace elastocal
