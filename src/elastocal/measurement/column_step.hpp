// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace elastocal {

/// The largest step of which all numbers of a column are multiples, but for a constant; 0 where
/// there is none (at least ten different numbers tell it; nine of ten suffice, for a mean of two
/// neighbours is none).
double StepOf(const Eigen::VectorXd& column);

}  // namespace elastocal
