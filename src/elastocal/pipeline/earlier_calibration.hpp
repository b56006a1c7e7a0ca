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
/// are of a day and not among them. Markers are those on links where they are the same in
/// `markers`, with by how little they are found again. Throws InputError for a calibration without
/// covariance.csv.
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

/// The earlier estimate as wide as the data have it (JointCheck::widened), that counts, for joints
/// that have moved or may have, as little as what is known of a new robot.
EarlierEstimate ForgetMoved(const JointCheck& check, const EarlierEstimate& earlier,
                            const ErrorModel& model, const Prior& prior);

/// The earlier estimate as the prior of an update: `after` so many of the `days`, in which zeros
/// drifted, as make the data most probable (what has not drifted need not be doubted), and with
/// what ForgetMoved does. `estimate`: of the new data, fitted with `fitted_with`.
EarlierEstimate MostProbable(const JointCheck& check, const CalibrationResult& estimate,
                             const EarlierEstimate& fitted_with, double days,
                             const std::function<EarlierEstimate(double days)>& after,
                             const Prior& prior);

/// The same of what the fit leaves of its earlier calibration; of markers, those that stayed and
/// cannot have moved instead of a joint.
EarlierEstimate KnownAfter(const EarlierFit& fit, double days, const CalibrationOptions& options);

/// These joints, a sentence each. `source`: the earlier calibration.
std::vector<std::string> DescribeForgotten(const JointCheck& check, const std::string& source);

/// That it is less exact than it says, a sentence; none where that may be chance.
std::vector<std::string> DescribeWidened(const JointCheck& check, const std::string& source);

/// That it was made from the recording that is calibrated now, a sentence.
std::string CountsTwice(const std::string& source);

/// Takes an earlier calibration as the prior of the project's estimates. What it says of joints
/// that seem to have moved since counts as little as what is known of a new robot. Returns what a
/// user should know of it, a sentence each. Throws InputError as FitAfterEarlier, and for a
/// calibration with another gauge than the project's.
std::vector<std::string> StartFromEarlier(const std::filesystem::path& calibration, double days,
                                          const Measurements& measured,
                                          std::optional<std::uint64_t> seed, Project& project);

/// Says it where an update, which errs by `updated` (m, 3-D) on postures that were left out,
/// predicts them clearly worse than the calibration that it began with; else empty.
std::string DescribeWorseUpdate(const std::filesystem::path& calibration,
                                const RecordedModel& robot, const Recording& recording,
                                CalibrationOptions options, double updated);

}  // namespace elastocal
