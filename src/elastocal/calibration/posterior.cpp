// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/posterior.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/calibration/body_unknowns.hpp"
#include "elastocal/math/dense.hpp"

namespace elastocal {

Eigen::MatrixXd InverseOfInformation(const Eigen::MatrixXd& information) {
  return InverseOfPositive(information);
}

Eigen::MatrixXd ParameterCovariance(const ErrorModel& model, const std::vector<int>& parameters,
                                    const Eigen::MatrixXd& covariance) {
  const auto count = static_cast<Eigen::Index>(parameters.size());
  Eigen::VectorXd scale(count);
  for (Eigen::Index i = 0; i < count; ++i)
    scale[i] = ParameterScale(model.parameters[parameters[i]]);
  return scale.asDiagonal() * covariance.topLeftCorner(count, count) * scale.asDiagonal();
}

std::vector<Correlation> StrongCorrelations(const Posterior& posterior, double threshold) {
  const Eigen::VectorXd sd = posterior.StandardDeviations();
  std::vector<Correlation> strong;
  for (Eigen::Index i = 0; i < sd.size(); ++i) {
    for (Eigen::Index j = i + 1; j < sd.size(); ++j) {
      const double coefficient = posterior.covariance(i, j) / (sd[i] * sd[j]);
      if (std::abs(coefficient) < threshold) continue;
      strong.push_back({posterior.parameters[i], posterior.parameters[j], coefficient});
    }
  }
  std::stable_sort(strong.begin(), strong.end(), [](const Correlation& a, const Correlation& b) {
    return std::abs(a.coefficient) > std::abs(b.coefficient);
  });
  return strong;
}

}  // namespace elastocal
