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

/// The elastic joints and causes of a calibration, as the project's choice.
ElasticityChoice ElasticityOf(const StoredCalibration& calibration, const Project& project);

/// Throws InputError for a calibration of another robot. `model` is that of the recording to which
/// the calibration is applied.
void CheckApplies(const StoredCalibration& calibration, const Project& project,
                  const ErrorModel& model);

/// What a stored calibration tells about the robot `days` later: its estimates, and their
/// covariance plus the drift of each parameter since then (a random walk; project key
/// calibration.drift, as a share of the prior's standard deviation in a day). Biases of torque
/// sensors differ from day to day and are left out. Markers are included only on links that
/// `markers` marks as `same`, with kMarkerReturns added. Throws InputError for a calibration
/// without covariance.csv.
EarlierEstimate MakeEarlierEstimate(const CalibrationEstimate& calibration, const ErrorModel& model,
                                    const CalibrationOptions& options, double days,
                                    const std::vector<LinkMarkers>& markers = {});

/// Fit of a recording with an earlier calibration as prior.
struct EarlierFit {
  StoredCalibration stored;
  CalibrationEstimate calibration;  ///< the same with its covariance
  RecordedModel robot;
  EarlierEstimate fitted_with;  ///< the prior: every joint free to have moved, markers unknown
  CalibrationResult estimate;
  JointCheck check;
  Measurements measured;  ///< with separate markers before and after a knock
};

/// Opens an earlier calibration (the folder that calibrate wrote to, or its calibration.yaml,
/// `days` old), gives the project its choice of elasticity and causes, and finds the joints that
/// have moved since (FindMovedJoints). Throws InputError for files that cannot be read or without
/// covariance, and for a calibration of another robot.
EarlierFit FitAfterEarlier(const std::filesystem::path& calibration, double days,
                           const Measurements& measured, std::optional<std::uint64_t> seed,
                           const JointCheckOptions& options, Project& project);

/// The earlier estimate with its covariance times JointCheck::widened. For joints that have moved,
/// or are suspects, the squared size of a change (SizeOfChanges) is added.
EarlierEstimate ForgetMoved(const JointCheck& check, const EarlierEstimate& earlier,
                            const ErrorModel& model, const Prior& prior);

/// The earlier estimate as the prior of an update. The time for which zeros have drifted is the
/// part of `days` (1, 1/4, 1/16, 1/64 or 0) that makes the data most probable, because a zero that
/// has not drifted need not be doubted. `after` gives the estimate after so many days. Joints that
/// have moved are treated as by ForgetMoved. `estimate` is a fit of the new data with the prior
/// `fitted_with`.
EarlierEstimate MostProbable(const JointCheck& check, const CalibrationResult& estimate,
                             const EarlierEstimate& fitted_with, double days,
                             const std::function<EarlierEstimate(double days)>& after,
                             const Prior& prior);

/// MostProbable for the earlier calibration of `fit`. It includes the markers that stayed in place
/// and cannot have moved instead of a joint.
EarlierEstimate KnownAfter(const EarlierFit& fit, double days, const CalibrationOptions& options);

/// ": another robot, or joints that were homed anew?" where more than half of a robot's joints, and
/// at least three, have moved; otherwise an empty text. So many joints are not repaired at once.
std::string AskWhereMostMoved(std::size_t moved, std::size_t joints);

/// A sentence for each joint whose earlier estimate is not used any more. `source` names the
/// earlier calibration.
std::vector<std::string> DescribeForgotten(const JointCheck& check, const std::string& source);

/// A sentence that the earlier calibration is less exact than it claims; nothing where that may be
/// chance (JointCheck::widened below 4).
std::vector<std::string> DescribeWidened(const JointCheck& check, const std::string& source);

/// A sentence that the earlier calibration was made from the recording that is calibrated now.
std::string CountsTwice(const std::string& source);

/// Makes an earlier calibration the prior of the project's estimates. For joints that seem to have
/// moved since, the prior is as wide as for a new robot. Returns warnings for the user, a sentence
/// each. Throws InputError as FitAfterEarlier, and for a calibration with another gauge than the
/// project's.
std::vector<std::string> StartFromEarlier(const std::filesystem::path& calibration, double days,
                                          const Measurements& measured,
                                          std::optional<std::uint64_t> seed, Project& project);

/// A warning where an update predicts held-out postures clearly worse (by 10 %) than the
/// calibration that was its prior; else empty. `updated`: its distances on these postures
/// (CrossValidation::distances), m. Both are judged by the observations that have one.
std::string DescribeWorseUpdate(const std::filesystem::path& calibration,
                                const RecordedModel& robot, const Recording& recording,
                                CalibrationOptions options, const Eigen::MatrixXd& updated);

}  // namespace elastocal
