// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/measurement/recording.hpp"

namespace elastocal {

/// An estimate with the postures from which it was made and postures that it has not seen.
struct HeldOutSplit {
  ErrorModel model;
  Eigen::VectorXd delta;  ///< errors, with markers and (in a posture table) the waist
  /// Errors that are exported, if they come from another model; empty: `delta`.
  Eigen::VectorXd exported = {};
  Recording training, held_out;
  /// The held-out postures are of the trials of `training`, so that their feet stand where they
  /// stand there. Otherwise each trial of `held_out` is placed anew.
  bool same_trials = false;
};

/// Effect of a joint's corrections, or a leg's compliances, on held-out postures.
struct JointGain {
  std::string owner;  ///< joint or leg, see OwnerName
  double gain = 0.0;  ///< rise of the RMSE where the joint returns to nominal, m
  /// 3-D RMSE over the observations that the joint moves, with its corrections, m
  double rmse = 0.0;
  /// Number of observations that it moves: by a tenth or more of its largest displacement.
  int observations = 0;
  bool kept = true;  ///< the joint stays corrected
};

/// Result of StudyGains. Errors are 3-D RMSE over all held-out observations, m.
struct GainStudy {
  std::vector<JointGain> joints;  ///< in the order of the model; only those with errors
  double uncalibrated = 0.0;      ///< error with every joint nominal
  double all = 0.0;               ///< error with every joint corrected
  double kept = 0.0;              ///< error with the joints that are kept
  int observations = 0;
  /// Observations that were measured wrong: further than six times the median from the estimate.
  int left_out = 0;
};

/// Settings of StudyGains.
struct GainOptions {
  double least = 0.0;      ///< a joint that gains no more than this returns to nominal, m
  bool with_loads = true;  ///< what is deployed compensates compliances; if false: geometry alone
  std::set<std::string> nominal = {};  ///< joints and legs that are nominal whatever they gain
  /// Names of the corrections that are deployed (corrections.hpp).
  std::set<std::string> causes = {};
  /// Markers whose positions are known beside the recording: they stay where the estimate has them.
  std::set<std::string> known_markers = {};
};

/// Finds the joints of a calibration that help on postures from which it was not estimated, by
/// backward elimination. As long as the joint with the smallest gain gains no more than `least`, it
/// returns to nominal, and the gains of the others are computed again. So of two joints whose
/// errors balance, neither is given up alone. The other joints keep their values.
///
/// **The gain of a joint** is the rise of the RMSE where it returns to nominal, over the held-out
/// observations that it moves: a wrist is not judged by the markers of the feet. Markers, and the
/// waist of a posture table, are refitted to the training postures without the joint (least
/// squares). What a joint has in common with the positions of its markers is therefore no gain,
/// unless the positions are known (`known_markers`).
///
/// Displacements by single joints are taken as additive (for errors of 10 mrad: to some percent).
/// Errors that exports do not carry are nominal from the beginning: corrections that are not in
/// `causes`, biases of torque sensors, without `with_loads` compliances, and those of the joints in
/// `nominal`. At most 400 training postures, evenly chosen, place the markers. Several splits
/// (folds) are judged together. Throws InputError where no marker was seen on held-out postures.
GainStudy StudyGains(const std::vector<HeldOutSplit>& splits, const CalibrationOptions& options,
                     const GainOptions& gains);

}  // namespace elastocal
