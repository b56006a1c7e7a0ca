// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace elastocal {

double StudentQuantile(double probability, double degrees_of_freedom) {
  return boost::math::quantile(boost::math::students_t(degrees_of_freedom), probability);
}

double ChiSquareQuantile(double probability, double degrees_of_freedom) {
  return boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), probability);
}

double FisherQuantile(double probability, double numerator, double denominator) {
  return boost::math::quantile(boost::math::fisher_f(numerator, denominator), probability);
}

double StudentTwoSidedTail(double value, double degrees_of_freedom) {
  const boost::math::students_t student(degrees_of_freedom);
  return 2.0 * boost::math::cdf(boost::math::complement(student, std::abs(value)));
}

double FisherUpperTail(double value, double numerator, double denominator) {
  using boost::math::complement;
  if (std::isinf(denominator)) {
    const boost::math::chi_squared chi_squared(numerator);
    return boost::math::cdf(complement(chi_squared, numerator * value));
  }
  return boost::math::cdf(complement(boost::math::fisher_f(numerator, denominator), value));
}

double StudentDegreesOfFreedom(double probability, double quantile) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (quantile <= StudentQuantile(probability, kInfinity)) return kInfinity;
  // The quantile falls with the logarithm of the degrees of freedom.
  double low = 0.0;
  double high = std::log(1e12);
  for (int step = 0; step < 100; ++step) {
    const double middle = 0.5 * (low + high);
    (StudentQuantile(probability, std::exp(middle)) > quantile ? low : high) = middle;
  }
  return std::exp(low);
}

double BetaQuantile(double probability, double alpha, double beta) {
  return boost::math::quantile(boost::math::beta_distribution<>(alpha, beta), probability);
}

double Median(Eigen::VectorXd values) {
  if (values.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const Eigen::Index middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

double Median(const std::vector<double>& values) {
  return Median(Eigen::VectorXd(
      Eigen::VectorXd::Map(values.data(), static_cast<Eigen::Index>(values.size()))));
}

double RootMeanSquare(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

double StandardErrorOfMean(const Eigen::VectorXd& values) {
  const auto count = static_cast<double>(values.size());
  if (count < 2.0) return std::numeric_limits<double>::infinity();
  return std::sqrt((values.array() - values.mean()).square().sum() / (count - 1.0) / count);
}

}  // namespace elastocal
