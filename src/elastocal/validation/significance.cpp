// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/significance.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

/// Inverse of a covariance by way of its correlations, because rad and m differ too much in size to
/// invert it directly.
Eigen::MatrixXd InverseOf(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> correlation(scale.asDiagonal() * covariance *
                                                scale.asDiagonal());
  if (!scale.allFinite() || correlation.info() != Eigen::Success) {
    throw std::invalid_argument("significance: covariance of differences not positive definite");
  }
  const auto size = scale.size();
  return scale.asDiagonal() * correlation.solve(Eigen::MatrixXd::Identity(size, size)) *
         scale.asDiagonal();
}

}  // namespace

double PooledFreedom(const Differences& differences, double share_a) {
  const double share_b = 1.0 - share_a;
  return 1.0 /
         (share_a * share_a / differences.freedom_a + share_b * share_b / differences.freedom_b);
}

Differences GivenNone(const Differences& differences, const std::vector<int>& which,
                      const std::vector<int>& same) {
  const Eigen::MatrixXd &A = differences.covariance_a, &B = differences.covariance_b;
  const Eigen::MatrixXd across = A(which, same) + B(which, same);
  const Eigen::MatrixXd gain = across * InverseOf(A(same, same) + B(same, same));
  const auto left = [&](const Eigen::MatrixXd& covariance) -> Eigen::MatrixXd {
    const Eigen::MatrixXd explained = gain * covariance(same, which);
    return covariance(which, which) - explained - explained.transpose() +
           gain * covariance(same, same) * gain.transpose();
  };
  Differences result = differences;
  result.values = differences.values(which) - gain * differences.values(same);
  result.covariance_a = left(A);
  result.covariance_b = left(B);
  return result;
}

DifferenceTest TestDifferences(const Differences& differences, const std::vector<int>& which,
                               const std::vector<int>& free) {
  const Eigen::MatrixXd covariance_a = differences.covariance_a(which, which);
  const Eigen::MatrixXd inverse = InverseOf(covariance_a + differences.covariance_b(which, which));
  const Eigen::VectorXd values = differences.values(which);
  const Eigen::VectorXd pull = inverse * values;
  double squared = values.dot(pull);
  if (!free.empty()) {
    const Eigen::VectorXd pull_free = pull(free);
    squared -= pull_free.dot(InverseOf(inverse(free, free)) * pull_free);
  }
  DifferenceTest test;
  test.parameters = static_cast<int>(which.size() - free.size());
  const double share_a = (inverse * covariance_a).trace() / static_cast<double>(which.size());
  test.degrees_of_freedom = PooledFreedom(differences, share_a);
  test.statistic = std::max(0.0, squared) / test.parameters;
  test.p = FisherUpperTail(test.statistic, test.parameters, test.degrees_of_freedom);
  return test;
}

std::vector<double> HolmAdjusted(const std::vector<double>& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> adjusted(p.size());
  double running = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto factor = static_cast<double>(p.size() - k);
    running = std::max(running, std::min(1.0, factor * p[order[k]]));
    adjusted[order[k]] = running;
  }
  return adjusted;
}

}  // namespace elastocal
