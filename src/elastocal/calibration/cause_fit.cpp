// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/cause_fit.hpp"

#include <algorithm>
#include <numeric>

#include <Eigen/Cholesky>

namespace elastocal {
namespace {

constexpr int kWideningRounds = 4;
// Of the variance; the square of what MostWidening says of corrections.
constexpr double kMostVarianceWidening = 100.0;
// Added to the information of a correction, in units of its typical size.
constexpr double kLeastInformation = 1e-6;

std::vector<int> BaseWith(const LinearStudy& study, const std::vector<int>& causes) {
  std::vector<int> columns(static_cast<std::size_t>(study.base));
  std::iota(columns.begin(), columns.end(), 0);
  const std::vector<int> more = CauseColumns(study, causes);
  columns.insert(columns.end(), more.begin(), more.end());
  return columns;
}

}  // namespace

std::vector<int> CauseColumns(const LinearStudy& study, const std::vector<int>& causes) {
  std::vector<int> columns;
  for (int cause : causes) {
    for (int c : study.of_cause[static_cast<std::size_t>(cause)]) columns.push_back(study.base + c);
  }
  return columns;
}

void StudySums::Add(const LinearStudy::Posture& posture, double sign) {
  if (posture.residual.size() == 0) return;
  information.noalias() += sign * posture.jacobian.transpose() * posture.jacobian;
  gradient.noalias() += sign * posture.jacobian.transpose() * posture.residual;
}

BaseFit::BaseFit(const LinearStudy& study, const StudySums& sums, const std::vector<int>& taken)
    : columns(BaseWith(study, taken)) {
  for (int c = study.base; c < study.columns(); ++c) {
    if (std::find(columns.begin(), columns.end(), c) == columns.end()) others.push_back(c);
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(sums.information(columns, columns));
  step = -factor.solve(sums.gradient(columns));
  const Eigen::MatrixXd cross = sums.information(columns, others);
  explained = factor.solve(cross);
  left = sums.information(others, others) - cross.transpose() * explained;
  gradient = sums.gradient(others) + cross.transpose() * step;
}

std::vector<int> BaseFit::Positions(const LinearStudy& study, int cause) const {
  std::vector<int> positions;
  for (int c : CauseColumns(study, {cause})) {
    positions.push_back(
        static_cast<int>(std::find(others.begin(), others.end(), c) - others.begin()));
  }
  return positions;
}

Eigen::VectorXd BaseFit::Residual(const LinearStudy::Posture& posture) const {
  return posture.residual + posture.jacobian(Eigen::all, columns) * step;
}

Eigen::MatrixXd BaseFit::Beside(const LinearStudy::Posture& posture) const {
  return posture.jacobian(Eigen::all, others) - posture.jacobian(Eigen::all, columns) * explained;
}

CauseFit FitCause(const LinearStudy& study, const BaseFit& fit, int cause) {
  const std::vector<int> at = fit.Positions(study, cause);
  const std::vector<int> columns = CauseColumns(study, {cause});
  const auto count = static_cast<Eigen::Index>(at.size());
  const Eigen::MatrixXd prior = study.other(columns, columns);
  CauseFit result;
  result.information = fit.left(at, at) - prior;
  // Directions of which the data say nothing count for nothing.
  result.information.diagonal().array() += kLeastInformation;
  const Eigen::VectorXd gradient = fit.gradient(at);
  double widening = 1.0;  // of the variance
  for (int round = 0; round < kWideningRounds; ++round) {
    const Eigen::LLT<Eigen::MatrixXd> factor(result.information + prior / widening);
    result.step = -factor.solve(gradient);
    result.covariance = factor.solve(Eigen::MatrixXd::Identity(count, count));
    const double determined =
        static_cast<double>(count) - (prior / widening * result.covariance).trace();
    const double size = result.step.dot(prior * result.step);
    widening = std::clamp(size / std::max(1e-3, determined), 1.0, kMostVarianceWidening);
  }
  return result;
}

}  // namespace elastocal
