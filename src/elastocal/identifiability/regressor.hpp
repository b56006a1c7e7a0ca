// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/robot/error_model.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

/// Upper-triangular (or shorter) matrix R with R^T R = Psi^T Psi, where Psi stacks the generalized
/// Jacobians (eq. 4) of all markers over the postures in the rows of `q`, for all parameters of the
/// model. R is small, and its columns have the same linear relations as those of Psi.
///
/// R is computed by Householder QR, first marker by marker (each depends on few columns), then over
/// the results; so the condition number is not squared.
///
/// `seen(i, m)` false leaves marker m out of posture i; an empty array means all are seen.
Eigen::MatrixXd RegressorFactor(const ErrorModel& model, const Geometry& geometry,
                                const Eigen::MatrixXd& q,
                                const Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>& seen);

/// The same for a root link that has an unknown pose in each posture. The rows of each posture are
/// reduced to the part that no displacement of the whole robot explains (RootProjection). The
/// columns of T0 are zero.
Eigen::MatrixXd FreeRootFactor(const ErrorModel& model, const Geometry& geometry,
                               const Eigen::MatrixXd& q);

}  // namespace elastocal
