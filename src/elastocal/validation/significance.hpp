// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Differences of several quantities that were estimated twice, independently, and the contribution
/// of each estimate to their covariance.
struct Differences {
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance_a, covariance_b;
  /// Degrees of freedom of the estimated noise in each covariance; infinite if the noise is known.
  double freedom_a = 0.0, freedom_b = 0.0;
};

/// Degrees of freedom, by Welch and Satterthwaite, of the sum of two estimated variances, of which
/// A has the given share.
double PooledFreedom(const Differences& differences, double share_a);

/// The differences `which` as they are if there is none at `same`: values and each estimate's
/// contribution to their covariance under that condition of the normal distribution.
/// Throws std::invalid_argument if the covariance of `same` is not positive definite.
Differences GivenNone(const Differences& differences, const std::vector<int>& which,
                      const std::vector<int>& same);

/// A test of several differences at once. The statistic is their squared Mahalanobis distance over
/// their number; without a change it follows Fisher's F (each covariance is known up to one
/// factor).
struct DifferenceTest {
  double statistic = 0.0;  ///< NaN without covariance
  int parameters = 0;
  double degrees_of_freedom = 0.0;  ///< of the denominator
  double p = 1.0;                   ///< probability of such a statistic without a change
};

/// Tests the differences `which`, whatever the others are. Those at the positions `free` of `which`
/// may take any value and explain as much of the others as they can; at least one must not be free.
/// Throws std::invalid_argument if the covariance is not positive definite.
DifferenceTest TestDifferences(const Differences& differences, const std::vector<int>& which,
                               const std::vector<int>& free = {});

/// Adjusts the p values of several tests for their number by Holm's step-down procedure (1979). If
/// tests whose adjusted value is at or below a level are called significant, the probability of any
/// false one is at most that level, whatever the correlation of the tests.
std::vector<double> HolmAdjusted(const std::vector<double>& p);

}  // namespace elastocal
