// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// The step that minimises g'd + d'Hd/2 where the entries `nonnegative` of x + d may not become
/// negative (an active set; `information` positive definite).
Eigen::VectorXd BoundedStep(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient,
                            const Eigen::VectorXd& x, const std::vector<int>& nonnegative);

}  // namespace elastocal
