// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// The step d that minimises g'd + d'Hd/2 while the entries `nonnegative` of x + d do not become
/// negative, by an active-set method. `information` is H and must be positive definite; `gradient`
/// is g.
Eigen::VectorXd BoundedStep(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient,
                            const Eigen::VectorXd& x, const std::vector<int>& nonnegative);

}  // namespace elastocal
