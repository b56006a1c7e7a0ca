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

/// Settings of DesignObservations.
struct ObservationDesignOptions {
  int count = 30;      ///< number of postures altogether
  int candidates = 8;  ///< number of random feasible postures for each posture to be chosen
  std::uint64_t seed = 1;
  /// A calibration of the robot (folder of calibrate, or its calibration.yaml), `days` old, whose
  /// estimates are prior knowledge. Empty: none.
  std::filesystem::path after = {};
  double days = 1.0;
  /// Joints may have moved since then, and the postures must tell their changes.
  bool changes = false;
  std::vector<std::string> joints = {};  ///< the joints that may have moved; empty: any
};

/// Postures in which a robot touches tables and is seen by instruments.
struct ObservationDesign {
  std::vector<ChainPostures> postures;  ///< by plate, then those of kLooks
  int candidates = 0;
  /// Information of the postures beside the prior of the project, nats: half the logarithm of the
  /// ratio of determinants (information with the postures over that of the prior); and its mean for
  /// as many random candidates.
  double information = 0.0, information_at_random = 0.0;
  std::vector<ZeroSensitivity> zeros = {};  ///< after a calibration: for the joints that it knows
  std::string infeasible = {};  ///< reason why there are no postures; empty where there are
};

/// Random feasible postures (ObservedPostureSampler): `count` for each plate that touches, and
/// `count` looks if there are instruments beside plates. Incomplete if `infeasible` is set.
ObservationDesign DrawObservedPostures(const Project& project, int count, std::uint64_t seed,
                                       const Progress& progress = {});

/// Chooses those of random feasible postures that tell most about all estimated parameters
/// (Bayesian D-optimality: largest determinant of the information, prior included). They are chosen
/// one after the other; then each is exchanged once while the others stay. Observations are those
/// of the nominal robot, with the initial noise of the set-up's sources, or the noise that an
/// earlier calibration found. The same seed gives the same postures. Throws as
/// ObservedPostureSampler and MakeRobotAfterEarlier, and InputError for joints that the calibration
/// does not know.
ObservationDesign DesignObservations(const Project& project,
                                     const ObservationDesignOptions& options,
                                     const Progress& progress = {});

/// posture_summary.json for such a design.
std::string FormatObservationDesign(const ObservationDesign& design);

}  // namespace elastocal
