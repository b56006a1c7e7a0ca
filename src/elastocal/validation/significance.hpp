#pragma once

#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Differences of several quantities estimated twice, independently, and what each estimate
/// contributes to their covariance.
struct Differences {
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance_a, covariance_b;
  /// Degrees of freedom of the noise that each covariance is a multiple of; infinite: it is known.
  double freedom_a = 0.0, freedom_b = 0.0;
};

/// Degrees of freedom of the sum of two estimated variances of which A has the given share, after
/// Welch and Satterthwaite.
double PooledFreedom(const Differences& differences, double share_a);

/// A test of several differences at once: squared Mahalanobis distance over their number, which
/// without a change follows Fisher's F (each covariance being known but for one factor).
struct DifferenceTest {
  double statistic = 0.0;  ///< NaN where there is no covariance to compute it with
  int parameters = 0;
  double degrees_of_freedom = 0.0;  ///< of the denominator
  double p = 1.0;                   ///< chance of as much without a change
};

/// Tests the differences `which`, whatever the others are. Those at the positions `free` of `which`
/// may take any value and explain as much of the others as they can; not all may be free. Throws
/// std::invalid_argument where the covariance is not positive definite.
DifferenceTest TestDifferences(const Differences& differences, const std::vector<int>& which,
                               const std::vector<int>& free = {});

/// The p values of several tests, adjusted for their number by Holm's step-down (1979): those at or
/// below a level are found with a chance of at most that level of any false one, whatever the
/// correlation of the tests.
std::vector<double> HolmAdjusted(const std::vector<double>& p);

}  // namespace elastocal
