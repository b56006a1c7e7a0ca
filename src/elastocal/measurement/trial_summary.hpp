#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/measurement/clock.hpp"
#include "elastocal/measurement/gaps.hpp"
#include "elastocal/measurement/labels.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/measurement/signal_excerpt.hpp"
#include "elastocal/measurement/stable_samples.hpp"
#include "elastocal/measurement/torque_sensors.hpp"

namespace elastocal {

/// A joint's torque sensor that was not used, and why.
struct BadTorqueSensor {
  std::string joint;
  TorqueFinding finding;
};

/// What of a trial was used, and why the rest was not.
struct TrialSummary {
  Trial trial;
  std::string markers_source, joints_source;  ///< files, for messages
  std::string refused;  ///< why nothing of the trial is used; empty: it is used
  double rate_hz = 0.0;
  int frame_count = 0;
  ClockFit clock;

  int postures = 0;                           ///< rests or, of a sine trial, moments
  int samples = 0;                            ///< frames in them, as the paper counts (section 5.1)
  int outside_log = 0;                        ///< frames at which the robot's log has nothing
  double log_begin_s = 0.0, log_end_s = 0.0;  ///< of the log, in camera time
  std::optional<StableSamples> rests;         ///< not of refused trials
  SignalExcerpt signal;                       ///< without samples in refused trials

  std::vector<std::string> markers;        ///< that take part in the trial and are in the file
  std::vector<MarkerSmoothing> smoothing;  ///< as `markers`
  std::vector<int> postures_seen;          ///< as `markers`: postures with the marker
  std::vector<ClusterLabels> labels;       ///< a cluster; their markers are indices into `markers`
  std::vector<std::string> markers_missing;  ///< take part, but are not in the file or never seen
  std::vector<std::string> markers_unknown;  ///< in the file, but not of the project
  std::vector<BadTorqueSensor> bad_torque_sensors;
  std::vector<std::string> torques_missing;  ///< joints that have a sensor, but no logged torques
};

/// One line: what was taken from the trial, and how its clock stands.
std::string Describe(const TrialSummary& summary);

/// What a user should know of, one sentence each, the gravest first: why the trial was refused, bad
/// torque sensors, exchanged labels, markers lost, outliers, a log that is too short.
std::vector<std::string> Findings(const TrialSummary& summary);

/// The frames that are not used, by reason, in one line.
std::string DescribeUnused(const TrialSummary& summary);

}  // namespace elastocal
