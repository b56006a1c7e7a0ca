// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/io/posture_file.hpp"
#include "elastocal/math/progress.hpp"
#include "elastocal/planning/design_follow_up.hpp"
#include "elastocal/planning/observed_stance.hpp"

namespace elastocal {

struct ObservationDesignOptions {
  int count = 30;      ///< postures in all
  int candidates = 8;  ///< random feasible postures from which each is chosen
  std::uint64_t seed = 1;
  /// A calibration of the robot (folder of calibrate, or its calibration.yaml): what it tells is
  /// known, as it is `days` later. Empty: none.
  std::filesystem::path after = {};
  double days = 1.0;
  /// Whether joints may have moved since then: their changes are what postures shall tell.
  bool changes = false;
  std::vector<std::string> joints = {};  ///< which ones; empty: any
};

/// Postures in which a robot shall touch tables and be seen by instruments.
struct ObservationDesign {
  std::vector<ChainPostures> postures;  ///< by plate, then those of kLooks
  int candidates = 0;
  /// What the postures tell beside the prior of the project, in nats: half the logarithm of the
  /// determinant of information over that of the prior; mean of as many candidates at random.
  double information = 0.0, information_at_random = 0.0;
  std::vector<ZeroSensitivity> zeros = {};  ///< after a calibration, of the joints that it knows
  std::string infeasible = {};              ///< why there are no postures; empty where there are
};

/// Random feasible postures (ObservedPostureSampler): `count` of each plate that touches, and of
/// looks where there are instruments beside plates. With `infeasible` set, they are not complete.
ObservationDesign DrawObservedPostures(const Project& project, int count, std::uint64_t seed,
                                       const Progress& progress = {});

/// Chooses, among random feasible postures, those that tell most of all that is estimated (Bayesian
/// D-optimality: largest determinant of the information, prior included): one after the other, and
/// then each anew while the others stay. What a posture shows is that of the nominal robot, with
/// the noise that the sources of the set-up have at first, or that an earlier calibration found.
/// The same seed gives the same postures. Throws what ObservedPostureSampler and
/// MakeRobotAfterEarlier throw, and InputError for joints that the calibration does not know.
ObservationDesign DesignObservations(const Project& project,
                                     const ObservationDesignOptions& options,
                                     const Progress& progress = {});

/// posture_summary.json of such a design.
std::string FormatObservationDesign(const ObservationDesign& design);

}  // namespace elastocal
