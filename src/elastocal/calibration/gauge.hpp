// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "elastocal/calibration/calibrate.hpp"

namespace elastocal {

/// Where the root link's frame is in a calibrated robot. The root's own markers are estimated, so
/// six numbers say only that, and no measurement tells them. The prior chooses them in an estimate:
/// the corrections at all branches of the root are together as small as it says. The functions here
/// choose otherwise, afterwards: they displace the frame, and nothing else. Joints on the root,
/// markers on it and T0 change with it, exactly; all that is between links other than the root
/// stays. Compliances are about axes that are fixed by these parameters, so that torsion stays as
/// it is, and a joint's bending, a leg's compliance and that of the root link refer to axes that
/// are as much displaced (milliradians, millimetres).

/// The errors that describe the same robot where the root link's frame is `T_root_new` in the one
/// that it has with the errors `delta`. Only root joints whose axes are in the model are rewritten;
/// the poses of the waist in postures are Placement's.
Eigen::VectorXd DisplaceRoot(const ErrorModel& model, const Eigen::VectorXd& delta,
                             const Transform& T_root_new);

/// The displacement that a gauge asks for; the identity for `prior`.
/// - `nominal_markers`: the markers on the root are (least squares, rigid) where the project says;
/// - `link`: the link, which a joint on the root carries, is where the URDF has it.
Transform FindRootDisplacement(const Gauge& gauge, const ErrorModel& model,
                               const Eigen::VectorXd& delta);

/// Throws InputError where a gauge cannot be had: fewer than three markers on the root that do not
/// lie on a line; a link that no joint of the model on the root carries; placements of joints on
/// the root that the project holds; motors of a linkage on the root.
void CheckGauge(const Gauge& gauge, const ErrorModel& model, const BaseParameters& base);

/// Gives a result of kind geometric, rigid or full its gauge: errors, placement, covariance and
/// what follows from it (the linear map of the displacement; derivatives by central differences).
/// The placement of a `link` is nominal by definition then: held. `displacement`, where given, is
/// taken instead of the result's own: a rigid model is displaced as the full one that it is from.
void ApplyGauge(const Gauge& gauge, const CalibrationOptions& options, CalibrationResult& result,
                const Transform* displacement = nullptr);

}  // namespace elastocal
