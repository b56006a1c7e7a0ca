// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace elastocal {

/// The resolution of a column: the largest step of which the numbers, less a constant, are
/// multiples. One tenth of the differences of neighbouring numbers may be none, because a mean of
/// two steps is no multiple. A step is told only by ten or more different numbers. Returns 0 if
/// there is no step.
double StepOf(const Eigen::VectorXd& column);

}  // namespace elastocal
