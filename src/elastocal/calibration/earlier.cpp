// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/earlier.hpp"

#include <map>

#include <Eigen/Cholesky>

#include "elastocal/math/input_error.hpp"

namespace elastocal {

Eigen::MatrixXd EarlierPart::Whitening() const {
  // In units of the standard deviations: angles and compliances differ by orders of magnitude.
  const Eigen::VectorXd unit = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::MatrixXd correlation =
      unit.cwiseInverse().asDiagonal() * covariance * unit.cwiseInverse().asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> factor(correlation);
  if (!correlation.allFinite() || factor.info() != Eigen::Success) {
    throw InputError("the covariance of the earlier calibration is not positive definite");
  }
  return factor.matrixL().solve(Eigen::MatrixXd(unit.cwiseInverse().asDiagonal()));
}

Eigen::MatrixXd EarlierPart::Information() const {
  const Eigen::MatrixXd whitening = Whitening();
  return whitening.transpose() * whitening;
}

EarlierPart PartOf(const EarlierEstimate& earlier, const ErrorModel& model,
                   const std::vector<int>& parameters) {
  std::map<std::string, int> row;
  for (const std::string& name : earlier.names) row.emplace(name, static_cast<int>(row.size()));
  EarlierPart part;
  std::vector<int> rows;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto at = row.find(model.parameters[parameters[i]].name);
    if (at == row.end()) continue;
    part.positions.push_back(static_cast<int>(i));
    rows.push_back(at->second);
  }
  part.mean = earlier.mean(rows);
  part.covariance = earlier.covariance(rows, rows);
  return part;
}

}  // namespace elastocal
