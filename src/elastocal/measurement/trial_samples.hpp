// SPDX-License-Identifier: Apache-2.0
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
  /// The search range is for people who start cameras and log within a few seconds of each other.
  ClockOptions clock = {.longest_lag_s = 5.0};
  /// Camera time less robot time when the cameras start, s, if it is known. By default, all lags
  /// are searched at which cameras and log can have run together.
  std::optional<double> expected_lag_s = {};
  /// With eight frames in a rest of a second, frames are far enough apart for the filtered noise to
  /// average out.
  StableSampleOptions rest = {.samples_per_run = 8};
  /// Takes the place of ClockOptions::largest_sd_s in trials of rests, where the clock matters
  /// less: samples are at least a sixteenth of a rest (60 ms of one second) away from its ends.
  /// Because a refused trial leaves its joints uncalibrated, up to 5/3 of this value is accepted if
  /// no mistake in the log explains the uncertainty.
  double largest_rest_lag_sd_s = 0.030;
  double sine_rate_hz = 10.0;  ///< rate of the moments taken from a motion without rests
  TorqueCheckOptions torques = {};
  /// Mistakes of the log (NameOf) that may be undone while the clock is estimated. One is undone if
  /// the speeds then agree better.
  std::vector<std::string> accepted = {};
};

/// The samples of one trial, for the estimator.
struct TrialSamples {
  std::vector<int> frames;  ///< number of frames averaged in each posture
  Eigen::VectorXd time_s;   ///< mean time of each posture's frames, on the cameras' clock
  Eigen::MatrixXd q;        ///< postures x coordinates, rad or m
  Eigen::MatrixXd
      markers;  ///< postures x 3 N_M, m, cameras' frame; NaN: not seen, or not in this trial
  Eigen::MatrixXd torques;        ///< postures x joints of the tree, N.m or N; NaN without sensor
  std::vector<int> wrench_links;  ///< of the log's wrench sensors
  Eigen::MatrixXd wrenches;       ///< postures x 6 for each sensor, N and N.m
  TrialSummary summary;
};

/// Makes samples of what cameras and robot recorded in a trial. The steps are:
/// 1. correct exchanged labels and remove outlying positions, by the rigid shape of clusters
///    (CorrectLabels);
/// 2. close short gaps; filter markers and log with the same low-pass (SmoothTrajectories,
///    SmoothLog);
/// 3. estimate lag and drift of the robot's clock by the markers' speeds (EstimateTrialClock), and
///    in trials of motion, or if the speeds do not tell them well enough, by the markers' positions
///    (RefineClock); the first support foot or, without one, the root link is at rest in the
///    laboratory; if the root is free, the motion is expressed in a body with markers
///    (SeeFromMarkedBody);
/// 4. find stable samples (FindStableSamples) or, in a trial of motion, take moments at a constant
///    rate from the first motion to the last, both only where the robot's log covers the frame;
/// 5. average the samples of each rest to one posture: marker positions, and joint positions and
///    torques at the corresponding robot times. A marker that is not seen in all samples of a rest
///    is left out there, so that all markers of a posture have the same number of samples. Samples
///    of one rest are averaged because they are not independent postures.
///
/// Only the markers `markers` of the robot take part; others are NaN in the result. Torques are NaN
/// for joints without sensor (according to the robot or the log) and for sensors that are dead,
/// stuck or saturated (CheckTorqueSensors).
///
/// A trial whose clock cannot be told, or without any usable frame, is refused: it has no postures,
/// and TrialSummary::refused says why. Throws InputError, naming the file, for a joint that the
/// robot does not have, or rates too low for the filter. Linear in the number of frames.
TrialSamples SampleTrial(const MarkedRobot& robot, const Trial& trial,
                         const std::vector<int>& markers, MarkerTrajectories trajectories,
                         const JointLog& log, const MeasurementOptions& options);

}  // namespace elastocal
