#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/measurement/clock.hpp"
#include "elastocal/measurement/gaps.hpp"
#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/marked_robot.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/measurement/stable_samples.hpp"
#include "elastocal/measurement/torque_sensors.hpp"
#include "elastocal/measurement/trial.hpp"
#include "elastocal/measurement/trial_summary.hpp"

namespace elastocal {

/// How samples are taken from raw recordings (paper, section 5.1).
struct MeasurementOptions {
  LabelOptions labels = {};
  SmoothingOptions smoothing = {};  ///< of markers, joint positions, torques and wrenches alike
  /// But for the next. People start cameras and log within a few seconds.
  ClockOptions clock = {.longest_lag_s = 5.0};
  /// Camera time less robot time when the cameras start, s, where it is known; by default all lags
  /// at which cameras and log could have run together are looked at.
  std::optional<double> expected_lag_s = {};
  /// Eight frames of a rest of a second are far enough apart for the filtered noise to average out.
  StableSampleOptions rest = {.samples_per_run = 8};
  /// ClockOptions::largest_sd_s for trials of rests: a robot at rest does the same a little later.
  double largest_rest_lag_sd_s = 0.010;
  double sine_rate_hz = 10.0;  ///< of moments taken from a motion without rests
  TorqueCheckOptions torques = {};
};

/// The samples of one trial, for the estimator.
struct TrialSamples {
  std::vector<int> frames;  ///< of each posture: how many are averaged in it
  Eigen::VectorXd time_s;   ///< of each posture: mean time of its frames, on the cameras' clock
  Eigen::MatrixXd q;        ///< postures x coordinates, rad or m
  Eigen::MatrixXd markers;  ///< postures x 3 N_M, m, cameras' frame; NaN: not seen, or no part
  Eigen::MatrixXd torques;  ///< postures x joints of the tree, N.m or N; NaN where there is none
  std::vector<int> wrench_links;  ///< of the log's wrench sensors
  Eigen::MatrixXd wrenches;       ///< postures x 6 a sensor, N and N.m
  TrialSummary summary;
};

/// From what cameras and robot recorded of a trial to its samples:
/// 1. exchanged labels and outlying positions, by the rigid shape of clusters (CorrectLabels);
/// 2. short gaps closed, markers and log low-passed alike (SmoothTrajectories, SmoothLog);
/// 3. lag and drift of the robot's clock (EstimateTrialClock), with the first support or, where
///    there is none, the root link at rest in the laboratory;
/// 4. stable samples (FindStableSamples) or, of a sine trial, moments at a constant rate from the
///    first motion to the last; only where the robot's log has something to say;
/// 5. the means of each rest's frames, the same for all: marker positions, joint positions and
///    torques at the corresponding robot times. A marker not seen in all of them is left out, so
///    that all markers of a posture have the same number of samples. Frames of one rest are no
///    independent postures, so they are one posture here.
///
/// Only the markers `markers` of the robot take part; others are NaN in the result. Torques are NaN
/// of joints without sensor, by the robot or the log, and of sensors that are dead, stuck or
/// saturated (CheckTorqueSensors).
///
/// A trial whose clock cannot be told, or without any usable frame, is refused: no postures, and
/// TrialSummary::refused says why. Throws InputError, naming the file, for a joint that the robot
/// does not have, or rates too low for the filter. Linear in the number of frames.
TrialSamples SampleTrial(const MarkedRobot& robot, const Trial& trial,
                         const std::vector<int>& markers, MarkerTrajectories trajectories,
                         const JointLog& log, const MeasurementOptions& options);

}  // namespace elastocal
