// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// Gauge: the choice of the root link's frame in a calibrated robot. The root's own markers are
/// estimated, so that six numbers only say where this frame is, and no measurement tells them. In
/// an estimate the prior chooses them: the corrections at all branches of the root together become
/// as small as possible. The functions here make another choice afterwards. They displace the frame
/// and nothing else: joints on the root, markers on it and T0 change exactly with it, and all that
/// is between links other than the root stays. Compliances refer to axes that these parameters fix.
/// Torsion stays as it is; a joint's bending, a leg's compliance and that of the root link then
/// refer to axes that are displaced by the same amount (milliradians, millimetres).

/// The errors that describe the same robot after its root link's frame is displaced to
/// `T_root_new`, given in the frame that it has with the errors `delta`. Only placements of root
/// joints that are parameters of the model change. The poses of the waist in each posture are in
/// Placement and are not changed here.
Eigen::VectorXd DisplaceRoot(const ErrorModel& model, const Eigen::VectorXd& delta,
                             const Transform& T_root_new);

/// The displacement of the root link's frame that a gauge asks for:
/// - `prior`: the identity;
/// - `nominal_markers`: the markers on the root are as close as possible to their nominal positions
///   (least squares, rigid);
/// - `link`: the link, which a joint on the root carries, is where the URDF has it.
Transform FindRootDisplacement(const Gauge& gauge, const ErrorModel& model,
                               const Eigen::VectorXd& delta);

/// Throws InputError where a gauge is impossible: `nominal_markers` with fewer than three markers
/// on the root or markers on one line; a `link` that no joint of the model on the root carries;
/// placements of joints on the root that the project holds; motors of a linkage on the root.
void CheckGauge(const Gauge& gauge, const ErrorModel& model, const BaseParameters& base);

/// Gives a result of kind geometric, rigid or full its gauge. Changes errors, placement, covariance
/// and what follows from it (by the linear map of the displacement, whose derivatives are central
/// differences). With the rule `link`, the placement of that link is nominal by definition and gets
/// the status held. `displacement`, if given, replaces the result's own: a rigid model is displaced
/// as the full model from which it comes.
void ApplyGauge(const Gauge& gauge, const CalibrationOptions& options, CalibrationResult& result,
                const Transform* displacement = nullptr);

}  // namespace elastocal
