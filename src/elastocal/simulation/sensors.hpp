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

/// How cameras and joint sensors see a motion. 0 switches an imperfection off.
struct SensorOptions {
  std::uint64_t seed = 1;

  // Cameras.
  double marker_noise_sd = 0.2e-3;  ///< of a coordinate in a frame, m
  double gaps_per_minute = 0.6;     ///< occlusions of a marker
  double mean_gap_s = 0.25;
  double outlier_share = 1e-4;     ///< of samples that are off
  double largest_outlier = 0.05;   ///< by up to, m (at least a tenth of it)
  double swaps_per_minute = 0.05;  ///< of two labels within a cluster
  double mean_swap_s = 0.4;

  // Joint log: its clock, robot time = (1 + 1e-6 drift) camera time - lag.
  double log_rate_hz = 100.0;
  double least_lag_s = 2.0, largest_lag_s = 4.0;  ///< drawn uniformly for each trial
  /// Size of the drift: half to one and a half of it, fast or slow; one draw for the experiment.
  double drift_size_ppm = 30.0;
  int encoder_bits = 19;         ///< a turn; 0: not quantised
  double torque_noise_sd = 0.2;  ///< N.m or N
};

/// Faults that are put in on purpose; none by default.
struct Faults {
  double missing_share = 0.0;  ///< of the samples of all markers, at random
  std::string lost_marker;     ///< not seen in the second half of every trial
  /// Labels of these two markers are exchanged for `swap_s`, from a third of `trial` on.
  std::string swapped_marker_a, swapped_marker_b;
  double swap_s = 20.0;
  /// A cluster that is pushed along its link by `knock`, in the middle of `trial`, and stays so in
  /// this trial and those after it.
  std::string knocked_cluster;
  double knock = 5e-3;                  ///< m
  std::string dead_torque_sensor;       ///< a joint; reads 0
  std::string saturated_torque_sensor;  ///< a joint; reads at most `saturation` to either side
  double saturation = 20.0;             ///< N.m or N
  std::optional<double> lag_s;          ///< of the robot's clock, instead of a draw
  double log_cut_s = 0.0;               ///< by which the log of `trial` ends too early
  /// The robot stands `slip` aside [m] in one posture of `trial`, from the end of the move to it
  /// until the next one has ended: the n-th, from 1; 0: none.
  int slipped_posture = 0;
  double slip = 3e-3;
  std::string trial;  ///< in which the above happens; empty: in every one
};

/// Markers that are on one link together.
struct NamedCluster {
  std::string name;
  std::vector<int> markers;  ///< of the robot's
};

/// What of the sensors' imperfections is not noise.
struct SensorTruth {
  double lag_s = 0.0, drift_ppm = 0.0;
  std::vector<std::string> faults;  ///< those that are in this trial, in words
};

/// What a laboratory gets from one trial.
struct RawTrial {
  MarkerTrajectories markers;
  JointLog joints;
  SensorTruth truth;
};

/// Measures trial number `index` of `trials`. Gain and bias of torque sensors, and which joints
/// have one, are those of the robot. Throws InputError for a fault that names a marker, cluster,
/// joint or trial that does not exist.
RawTrial Measure(const TrueRobot& robot, const std::vector<NamedCluster>& clusters,
                 const std::vector<PlannedTrial>& trials, std::size_t index,
                 const TrueMotion& motion, const SensorOptions& options, const Faults& faults);

}  // namespace elastocal
