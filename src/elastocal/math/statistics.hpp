// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// Quantile of Student's t distribution with `degrees_of_freedom` > 0 at `probability` in (0, 1);
/// with infinite degrees of freedom, that of the normal distribution.
double StudentQuantile(double probability, double degrees_of_freedom);

/// Quantile of the chi-square distribution with `degrees_of_freedom` > 0.
double ChiSquareQuantile(double probability, double degrees_of_freedom);

/// Quantile of Fisher's F distribution with both degrees of freedom > 0.
double FisherQuantile(double probability, double numerator, double denominator);

/// Probability that Student's t is further from zero than `value`, to either side; with infinite
/// degrees of freedom, of the normal distribution.
double StudentTwoSidedTail(double value, double degrees_of_freedom);

/// Probability that Fisher's F exceeds `value` >= 0; with infinite `denominator`, that chi-square /
/// `numerator` does.
double FisherUpperTail(double value, double numerator, double denominator);

/// Degrees of freedom with which Student's t has the quantile `quantile` at `probability` in
/// (0.5, 1): the inverse of StudentQuantile. At least 1; infinite for the normal distribution's
/// quantile or less.
double StudentDegreesOfFreedom(double probability, double quantile);

/// Quantile of the beta distribution with both shapes > 0.
double BetaQuantile(double probability, double alpha, double beta);

/// Median (mean of the two middle values for an even count); NaN for no values.
double Median(Eigen::VectorXd values);
double Median(const std::vector<double>& values);

/// Root of the mean square; NaN for no values.
double RootMeanSquare(const Eigen::VectorXd& values);

/// Standard error of the mean of values that were drawn independently; infinite for fewer than two.
double StandardErrorOfMean(const Eigen::VectorXd& values);

}  // namespace elastocal
