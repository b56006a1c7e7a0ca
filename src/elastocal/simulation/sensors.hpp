// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/trial.hpp"
#include "elastocal/simulation/true_motion.hpp"

namespace elastocal {

/// How cameras and joint sensors measure a motion. 0 switches an imperfection off.
struct SensorOptions {
  std::uint64_t seed = 1;

  // Cameras.
  double marker_noise_sd = 0.2e-3;  ///< noise of a coordinate in a frame, m
  double gaps_per_minute = 0.6;     ///< occlusions of a marker
  double mean_gap_s = 0.25;
  double outlier_share = 1e-4;     ///< share of samples that are outliers
  double largest_outlier = 0.05;   ///< largest error of an outlier, m (the least is a tenth of it)
  double swaps_per_minute = 0.05;  ///< exchanges of two labels within a cluster
  double mean_swap_s = 0.4;

  // Joint log. On its clock, robot time = (1 + 1e-6 drift) camera time - lag.
  double log_rate_hz = 100.0;
  double least_lag_s = 2.0, largest_lag_s = 4.0;  ///< drawn uniformly for each trial
  /// Size of the drift. The drift is drawn once for the experiment: 0.5 to 1.5 times this size, of
  /// either sign.
  double drift_size_ppm = 30.0;
  int encoder_bits = 19;         ///< bits for one turn; 0: not quantised
  double torque_noise_sd = 0.2;  ///< N.m or N

  // Causes of error of one joint that neither geometry nor springs describe (docs/diagnose.md): the
  // logged position differs from the joint's position by them. Without a name there are none.
  std::string cause_joint;
  double eccentricity = 0.0;   ///< amplitude of sin q, rad
  double gear_error = 0.0;     ///< share of the position
  double backlash = 0.0;       ///< half width, by the sign of the load, rad
  double hysteresis = 0.0;     ///< half width, by the direction of the last motion, rad
  double cameras_drift = 0.0;  ///< drift of all markers along x, m/h; needs no joint
};

/// Faults that are put in on purpose; by default none.
struct Faults {
  double missing_share = 0.0;  ///< share of the samples of all markers, at random
  std::string lost_marker;     ///< not seen in the second half of every trial
  /// The labels of these two markers are exchanged for `swap_s`, from the first third of `trial`
  /// on.
  std::string swapped_marker_a, swapped_marker_b;
  double swap_s = 20.0;
  /// A cluster that is displaced on its link by `knock` in the middle of `trial`, and stays so in
  /// later trials.
  std::string knocked_cluster;
  double knock = 5e-3;                  ///< m
  std::string dead_torque_sensor;       ///< a joint; reads 0
  std::string saturated_torque_sensor;  ///< a joint; reads at most `saturation` to either side
  double saturation = 20.0;             ///< N.m or N
  std::optional<double> lag_s;          ///< lag of the robot's clock, instead of a drawn one
  double log_cut_s = 0.0;               ///< time by which the log of `trial` ends too early
  /// Number, from 1, of the posture of `trial` in which the robot stands `slip` aside [m], from the
  /// end of the move to it until the end of the next move; 0: none.
  int slipped_posture = 0;
  double slip = 3e-3;
  std::string trial;  ///< trial in which the faults above happen; empty: every trial
};

/// The markers of one link, with a name.
struct NamedCluster {
  std::string name;
  std::vector<int> markers;  ///< indices of the robot's markers
};

/// Imperfections of the sensors that are not noise.
struct SensorTruth {
  double lag_s = 0.0, drift_ppm = 0.0;
  std::vector<std::string> faults;  ///< faults in this trial, in words
};

/// The raw data that a laboratory gets from one trial.
struct RawTrial {
  MarkerTrajectories markers;
  JointLog joints;
  SensorTruth truth;
};

/// Measures trial number `index` of `trials`. Gain and bias of torque sensors, and the joints that
/// have one, are those of `robot`. Throws InputError for a fault that names a marker, cluster,
/// joint or trial that does not exist.
RawTrial Measure(const TrueRobot& robot, const std::vector<NamedCluster>& clusters,
                 const std::vector<PlannedTrial>& trials, std::size_t index,
                 const TrueMotion& motion, const SensorOptions& options, const Faults& faults);

}  // namespace elastocal
