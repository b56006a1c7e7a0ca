// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/earlier.hpp"
#include "elastocal/io/calibration_file.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/validation/common_parameters.hpp"
#include "elastocal/validation/moved_joints.hpp"

namespace elastocal {

/// The joints that a calibration found elastic, and its causes, whatever the project leaves open.
ElasticityChoice ElasticityOf(const StoredCalibration& calibration, const Project& project);

/// Throws InputError for a calibration of another robot. `model`: of the recording that it is
/// applied to.
void CheckApplies(const StoredCalibration& calibration, const Project& project,
                  const ErrorModel& model);

/// What a stored calibration says of the robot `days` later: its estimates, and their covariance
/// with the drift of each parameter since then added to it (a random walk: project key
/// calibration.drift, a part of the prior's standard deviation in a day). Biases of torque sensors
/// differ from day to day and are left out. Markers are known on those links only on which
/// `markers` says that they stayed, as exactly as they were found again. Throws InputError for a
/// calibration without covariance.csv.
EarlierEstimate MakeEarlierEstimate(const CalibrationEstimate& calibration, const ErrorModel& model,
                                    const CalibrationOptions& options, double days,
                                    const std::vector<LinkMarkers>& markers = {});

/// A recording fitted with an earlier calibration as the prior.
struct EarlierFit {
  StoredCalibration stored;
  CalibrationEstimate calibration;  ///< the same with its covariance
  RecordedModel robot;
  EarlierEstimate fitted_with;  ///< every joint free to have moved, markers anywhere
  CalibrationResult estimate;
  JointCheck check;
  Measurements measured;  ///< with separate markers before and after knocks
};

/// Opens an earlier calibration (the folder that calibrate wrote to, or its calibration.yaml, made
/// `days` ago), gives the project its choice of elasticity and causes, and finds the joints that
/// have moved since (FindMovedJoints). Throws InputError: files that cannot be read, or without
/// covariance; a calibration of another robot.
EarlierFit FitAfterEarlier(const std::filesystem::path& calibration, double days,
                           const Measurements& measured, std::optional<std::uint64_t> seed,
                           const JointCheckOptions& options, Project& project);

/// The earlier estimate with its covariance widened as the data ask for (JointCheck::widened). Of
/// joints that have moved, or may have, it knows no more than is known of a new robot.
EarlierEstimate ForgetMoved(const JointCheck& check, const EarlierEstimate& earlier,
                            const ErrorModel& model, const Prior& prior);

/// The earlier estimate as the prior of an update. Zeros have drifted for the part of `days` that
/// makes the data most probable, because a zero that has not drifted need not be doubted; `after`
/// gives the estimate after so many days. Joints that have moved are treated as by ForgetMoved.
/// `estimate`: of the new data, fitted with `fitted_with`.
EarlierEstimate MostProbable(const JointCheck& check, const CalibrationResult& estimate,
                             const EarlierEstimate& fitted_with, double days,
                             const std::function<EarlierEstimate(double days)>& after,
                             const Prior& prior);

/// MostProbable for the earlier calibration of `fit`. It knows the markers that stayed where they
/// were and cannot have moved in place of a joint.
EarlierEstimate KnownAfter(const EarlierFit& fit, double days, const CalibrationOptions& options);

/// ": another robot, or joints that were homed anew?" where most of a robot's joints, three at
/// least, have moved; otherwise an empty text. Nobody mends as many joints at once.
std::string AskWhereMostMoved(std::size_t moved, std::size_t joints);

/// A sentence for each joint whose earlier estimate does not count any more. `source`: the earlier
/// calibration.
std::vector<std::string> DescribeForgotten(const JointCheck& check, const std::string& source);

/// A sentence that says that the earlier calibration is less exact than it claims; none where that
/// may be chance.
std::vector<std::string> DescribeWidened(const JointCheck& check, const std::string& source);

/// The sentence that the earlier calibration was made from the very recording that is calibrated
/// now.
std::string CountsTwice(const std::string& source);

/// Takes an earlier calibration as the prior of the project's estimates. What it says of joints
/// that seem to have moved since counts as little as what is known of a new robot. Returns what a
/// user should know of it, a sentence each. Throws InputError as FitAfterEarlier, and for a
/// calibration with another gauge than the project's.
std::vector<std::string> StartFromEarlier(const std::filesystem::path& calibration, double days,
                                          const Measurements& measured,
                                          std::optional<std::uint64_t> seed, Project& project);

/// A warning where an update predicts left-out postures clearly worse than the calibration that it
/// began with; else empty. `updated`: its error on these postures (m, 3-D).
std::string DescribeWorseUpdate(const std::filesystem::path& calibration,
                                const RecordedModel& robot, const Recording& recording,
                                CalibrationOptions options, double updated);

}  // namespace elastocal
