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

double BetaQuantile(double probability, double alpha, double beta) {
  return boost::math::quantile(boost::math::beta_distribution<>(alpha, beta), probability);
}

double Median(Eigen::VectorXd values) {
  if (values.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const Eigen::Index middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

double RootMeanSquare(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

}  // namespace elastocal
