// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Differences of quantities that were estimated twice, independently, with the contribution of
/// each estimate to their covariance.
struct Differences {
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance_a, covariance_b;
  /// Degrees of freedom of the estimated noise in each covariance; infinite if the noise is known.
  double freedom_a = 0.0, freedom_b = 0.0;
};

/// Degrees of freedom of the sum of two estimated variances, by Welch and Satterthwaite. `share_a`
/// is the share of A in the sum.
double PooledFreedom(const Differences& differences, double share_a);

/// The differences `which` under the condition that the differences `same` are zero: conditional
/// values, and each estimate's contribution to the conditional covariance. Throws
/// std::invalid_argument if the covariance of `same` is not positive definite.
Differences GivenNone(const Differences& differences, const std::vector<int>& which,
                      const std::vector<int>& same);

/// Test of several differences at once. The statistic is their squared Mahalanobis distance over
/// their number; without a change it follows Fisher's F (each covariance is known up to one
/// factor).
struct DifferenceTest {
  double statistic = 0.0;  ///< NaN without covariance
  int parameters = 0;
  double degrees_of_freedom = 0.0;  ///< degrees of freedom of the denominator
  double p = 1.0;                   ///< probability of at least this statistic without a change
};

/// Tests the differences `which`, whatever the others are. Those at the positions `free` of `which`
/// may have any value and explain as much of the others as they can; at least one must not be free.
/// Throws std::invalid_argument if the covariance is not positive definite.
DifferenceTest TestDifferences(const Differences& differences, const std::vector<int>& which,
                               const std::vector<int>& free = {});

/// Corrects the p values of several tests for their number by Holm's step-down procedure (1979). If
/// tests whose corrected value is at or below a level are called significant, the probability of
/// any false one is at most that level, whatever the correlation of the tests.
std::vector<double> HolmAdjusted(const std::vector<double>& p);

}  // namespace elastocal
