// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/criterion.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "elastocal/identifiability/observability.hpp"
#include "elastocal/math/decompositions.hpp"

namespace elastocal {
namespace {

constexpr double kMinusInfinity = -std::numeric_limits<double>::infinity();
constexpr double kSingularPivot = 1e-13;  // least ratio of a pivot to its diagonal entry

using Factor = Eigen::LLT<Eigen::MatrixXd>;

bool IsRegular(const Factor& factor, const Eigen::MatrixXd& matrix) {
  if (factor.info() != Eigen::Success) return false;
  const Eigen::VectorXd pivots = factor.matrixLLT().diagonal();
  return (pivots.array().square() > kSingularPivot * matrix.diagonal().array()).all();
}

double LogDet(const Factor& factor) {
  return 2.0 * factor.matrixLLT().diagonal().array().log().sum();
}

/// Derivatives of log O_k by the singular values (descending).
Eigen::VectorXd IndexGradient(Criterion criterion, const Eigen::VectorXd& sigma) {
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(sigma.size());
  const Eigen::Index last = sigma.size() - 1;
  switch (criterion) {
    case Criterion::kO1:
      return sigma.cwiseInverse() / static_cast<double>(sigma.size());
    case Criterion::kO2:
      gradient[last] += 1.0 / sigma[last];
      gradient[0] -= 1.0 / sigma[0];
      return gradient;
    case Criterion::kO3:
      gradient[last] = 1.0 / sigma[last];
      return gradient;
    case Criterion::kO4:
      gradient[last] += 2.0 / sigma[last];
      gradient[0] -= 1.0 / sigma[0];
      return gradient;
    default:
      return sigma.array().square().inverse() / sigma.cwiseInverse().sum();
  }
}

double Index(Criterion criterion, const ObservabilityIndices& indices) {
  switch (criterion) {
    case Criterion::kO1:
      return indices.o1;
    case Criterion::kO2:
      return indices.o2;
    case Criterion::kO3:
      return indices.o3;
    case Criterion::kO4:
      return indices.o4;
    default:
      return indices.o5;
  }
}

}  // namespace

double LogDet(const Eigen::MatrixXd& information) {
  const Factor factor(information);
  return IsRegular(factor, information) ? LogDet(factor) : kMinusInfinity;
}

double LogGain(const Eigen::LLT<Eigen::MatrixXd>& information, const Eigen::MatrixXd& psi) {
  const Eigen::MatrixXd half = information.matrixL().solve(psi.transpose());
  Eigen::MatrixXd gain = half.transpose() * half;
  gain.diagonal().array() += 1.0;
  return LogDet(gain);
}

double O1(double log_det, int columns, int postures) {
  return std::exp(0.5 * log_det / columns) / std::sqrt(postures);
}

CriterionValue EvaluateCriterion(Criterion criterion, const Eigen::MatrixXd& information,
                                 int postures) {
  const Factor factor(information);
  if (!IsRegular(factor, information)) return {kMinusInfinity, {}};
  const auto columns = static_cast<double>(information.cols());
  if (criterion == Criterion::kO1) {
    return {
        0.5 * LogDet(factor) / columns - 0.5 * std::log(postures),
        factor.solve(Eigen::MatrixXd::Identity(information.rows(), information.cols())) / columns};
  }
  const SymmetricDecomposition eigen = DecomposeSymmetric(information);
  const Eigen::VectorXd sigma = eigen.values.reverse().cwiseMax(0.0).cwiseSqrt();
  const Eigen::MatrixXd V = eigen.vectors.rowwise().reverse();
  const Eigen::VectorXd scale = IndexGradient(criterion, sigma).cwiseQuotient(sigma);
  return {std::log(Index(criterion, ComputeObservability(sigma, postures))),
          V * scale.asDiagonal() * V.transpose()};
}

}  // namespace elastocal
