// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/measurement/recording.hpp"

namespace elastocal {

/// An estimate, what it was made from, and postures that it has not seen.
struct HeldOutSplit {
  ErrorModel model;
  Eigen::VectorXd delta;  ///< errors with markers and, of a table of postures, the waist
  /// Errors that are exported, where they are another model's; empty: `delta`.
  Eigen::VectorXd exported = {};
  Recording training, held_out;
  /// Whether the held-out postures are of trials of `training`, and their feet stand where they
  /// stand there; else each trial of `held_out` is placed anew.
  bool same_trials = false;
};

/// What the corrections of a joint, or the compliances of a leg, bring on held-out postures.
struct JointGain {
  std::string owner;     ///< the joint or leg, see OwnerName
  double gain = 0.0;     ///< by which the error below rises where the joint returns to nominal, m
  double rmse = 0.0;     ///< 3-D RMSE over the observations that the joint moves, with it, m
  int observations = 0;  ///< that it moves: by a tenth or more of its largest displacement
  bool kept = true;      ///< whether it stays corrected
};

/// Errors are 3-D RMSE over all held-out observations, m.
struct GainStudy {
  std::vector<JointGain> joints;  ///< in the order of the model; only those with errors
  double uncalibrated = 0.0;      ///< every joint nominal
  double all = 0.0;               ///< every joint corrected
  double kept = 0.0;              ///< those that are kept
  int observations = 0;
  int left_out = 0;  ///< observations over six times the median from the estimate: measured wrong
};

struct GainOptions {
  double least = 0.0;      ///< a joint that gains no more returns to nominal, m
  bool with_loads = true;  ///< whether what is deployed knows compliances; else geometry alone
  std::set<std::string> nominal = {};  ///< joints and legs that are nominal whatever they gain
  /// Markers whose places are known beside the recording: they stay where the estimate has them.
  std::set<std::string> known_markers = {};
};

/// Which joints of a calibration help on postures that it was not estimated from: backward
/// elimination. As long as the joint of smallest gain gains no more than `least`, it returns to
/// nominal, and the gains of the others are taken anew; so that of two joints whose errors balance,
/// neither is given up alone. The others keep their values.
///
/// **The gain of a joint** is the rise of the RMSE where it returns to nominal, over the held-out
/// observations that it moves: a wrist is not judged by the markers of the feet. Markers, and the
/// waist of a table of postures, are taken as the training postures would have them beside the
/// joints that are left (least squares): what a joint has in common with the place of its markers
/// is no gain. Where the place is known (`known_markers`), it is one.
///
/// Displacements by single joints are taken as additive (errors of 10 mrad: to some percent of
/// themselves). What exports do not carry, corrections (corrections.hpp) and biases of torque
/// sensors, and without `with_loads` compliances, is nominal from the beginning, as are `nominal`.
/// At most 400 training postures place the markers, evenly chosen. Several splits (folds) are
/// judged together. Throws InputError where nothing was seen on held-out postures.
GainStudy StudyGains(const std::vector<HeldOutSplit>& splits, const CalibrationOptions& options,
                     const GainOptions& gains);

}  // namespace elastocal
