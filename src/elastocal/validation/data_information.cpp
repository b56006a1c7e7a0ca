// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/data_information.hpp"

#include <algorithm>

#include <Eigen/Cholesky>

#include "elastocal/calibration/posterior.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {

DataInformation InformationOfData(const CalibrationResult& estimate,
                                  const EarlierEstimate& fitted_with) {
  const ErrorModel& model = estimate.model;
  DataInformation data;
  std::vector<int> at;  // in the posterior
  for (std::size_t i = 0; i < estimate.posterior.parameters.size(); ++i) {
    const int index = estimate.posterior.parameters[i];
    const bool bound = IsCompliance(model.parameters[index].kind) && estimate.delta[index] <= 0.0;
    if (bound) continue;
    at.push_back(static_cast<int>(i));
    data.parameters.push_back(index);
  }
  data.unit.resize(std::ssize(data.parameters));
  for (Eigen::Index i = 0; i < data.unit.size(); ++i) {
    data.unit[i] = ParameterScale(model.parameters[data.parameters[Size(i)]]);
  }
  const double widening = std::max(1.0, estimate.posterior.cluster_factor);
  data.information =
      data.unit.asDiagonal() * estimate.posterior.data_information(at, at) * data.unit.asDiagonal();
  // At the estimate the gradient of the log-likelihood is the negative gradient of the prior.
  const Eigen::VectorXd x = estimate.delta(data.parameters).cwiseQuotient(data.unit);
  const Eigen::MatrixXd before =
      InverseOfInformation(CovarianceBefore(estimate, data, fitted_with));
  data.vector =
      (data.information * x + before * (x - MeanBefore(estimate, data, fitted_with))) / widening;
  data.information /= widening;
  return data;
}

Eigen::MatrixXd CovarianceBefore(const CalibrationResult& estimate, const DataInformation& data,
                                 const EarlierEstimate& earlier) {
  Eigen::MatrixXd covariance = estimate.prior_sd(data.parameters)
                                   .cwiseQuotient(data.unit)
                                   .array()
                                   .square()
                                   .matrix()
                                   .asDiagonal();
  const EarlierPart known = PartOf(earlier, estimate.model, data.parameters);
  const Eigen::VectorXd per_unit = data.unit(known.positions).cwiseInverse();
  covariance(known.positions, known.positions) =
      per_unit.asDiagonal() * known.covariance * per_unit.asDiagonal();
  return covariance;
}

Eigen::VectorXd MeanBefore(const CalibrationResult& estimate, const DataInformation& data,
                           const EarlierEstimate& earlier) {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(data.unit.size());
  const EarlierPart known = PartOf(earlier, estimate.model, data.parameters);
  mean(known.positions) = known.mean.cwiseQuotient(data.unit(known.positions));
  return mean;
}

double LogEvidence(const DataInformation& data, const Eigen::VectorXd& mean,
                   const Eigen::MatrixXd& covariance) {
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  if (factor.info() != Eigen::Success) {
    throw InputError("the covariance of the earlier calibration is not positive definite");
  }
  const Eigen::MatrixXd L = factor.matrixL();
  const Eigen::VectorXd score = L.transpose() * (data.vector - data.information * mean);
  const auto identity = Eigen::MatrixXd::Identity(mean.size(), mean.size());
  const Eigen::LLT<Eigen::MatrixXd> told(identity + L.transpose() * data.information * L);
  const double log_det = 2.0 * told.matrixLLT().diagonal().array().log().sum();
  // Without the part at the mean: log p(data | x = mean) = vector' mean - mean' information mean /
  // 2.
  const double at_mean = mean.dot(data.vector) - 0.5 * mean.dot(data.information * mean);
  return at_mean + 0.5 * (score.dot(told.solve(score)) - log_det);
}

}  // namespace elastocal
