// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/clock.hpp"
#include "elastocal/measurement/gaps.hpp"
#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/measurement/reference_scale.hpp"
#include "elastocal/measurement/signal_excerpt.hpp"
#include "elastocal/measurement/stable_samples.hpp"
#include "elastocal/measurement/torque_sensors.hpp"

namespace elastocal {

/// A joint's torque sensor that was not used, and why.
struct BadTorqueSensor {
  std::string joint;
  TorqueFinding finding;
};

/// Which part of a trial was used, and why the rest was not.
struct TrialSummary {
  Trial trial;
  std::string markers_source, joints_source;  ///< files, for messages
  std::string refused;               ///< why nothing of the trial is used; empty: it is used
  std::map<int, double> steps = {};  ///< resolution of logged positions, by coordinate (StepOf)
  double rate_hz = 0.0;
  int frame_count = 0;
  ClockFit clock;
  /// Mistakes of the log (NameOf) that had to be undone for the clock to be told. The positions in
  /// the samples are as logged.
  std::vector<std::string> clock_without;

  int postures = 0;     ///< number of rests or, in a sine trial, of moments
  int samples = 0;      ///< frames in them, as the paper counts (section 5.1)
  int outside_log = 0;  ///< number of frames that the robot's log does not cover
  double log_begin_s = 0.0, log_end_s = 0.0;  ///< begin and end of the log, in camera time
  std::optional<StableSamples> rests;         ///< empty for refused trials
  SignalExcerpt signal;                       ///< without samples in refused trials

  std::vector<std::string> markers;  ///< markers that take part in the trial and are in the file
  std::vector<MarkerSmoothing> smoothing;  ///< one for each of `markers`
  std::vector<int>
      postures_seen;  ///< for each of `markers`, number of postures in which it is seen
  std::vector<ClusterLabels>
      labels;  ///< one for each cluster; its markers are indices into `markers`
  std::vector<std::string>
      markers_missing;  ///< markers that take part, but are not in the file or never seen
  std::vector<std::string> markers_unknown;  ///< markers in the file that the project does not have
  std::vector<BadTorqueSensor> bad_torque_sensors;
  std::optional<MeasuredScale> scale;  ///< scale error by the project's reference lengths
  bool reference_missing = false;      ///< the project has reference lengths, but none is seen
  std::vector<std::string> torques_missing;  ///< joints that have a sensor, but no logged torques
};

/// One line: what was taken from the trial, and the state of its clock.
std::string Describe(const TrialSummary& summary);

/// What a user should know, one sentence each, the gravest first: why the trial was refused, bad
/// torque sensors, exchanged labels, lost markers, outliers, a log that is too short.
std::vector<std::string> Findings(const TrialSummary& summary);

}  // namespace elastocal
