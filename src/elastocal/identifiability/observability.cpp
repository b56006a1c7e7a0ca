// SPDX-License-Identifier: Apache-2.0
#include "elastocal/identifiability/observability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/priority_qr.hpp"

namespace elastocal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Singular values up to this one are zero up to rounding.
double SingularFloor(const Eigen::VectorXd& sigma) {
  return 1e-14 * sigma[0] * static_cast<double>(sigma.size());
}

/// Largest over smallest singular value; infinite if the smallest is below machine precision or
/// there are fewer rows than columns.
double ConditionNumber(const Eigen::MatrixXd& A) {
  if (A.cols() == 0 || A.rows() < A.cols()) return kInfinity;
  const Eigen::VectorXd sigma = SingularValues(A);
  const double smallest = sigma[sigma.size() - 1];
  return smallest > SingularFloor(sigma) ? sigma[0] / smallest : kInfinity;
}

/// Diagonal of (A^T A)^-1, by singular vectors. Entries are infinite for columns that depend on
/// others.
Eigen::VectorXd InverseDiagonal(const Eigen::MatrixXd& A) {
  const SingularValueDecomposition svd = DecomposeSingular(A);
  const Eigen::VectorXd& sigma = svd.values;
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(A.cols());
  for (Eigen::Index k = 0; k < sigma.size(); ++k) {
    for (Eigen::Index i = 0; i < A.cols(); ++i) {
      const double v = svd.V(i, k);
      if (sigma[k] > SingularFloor(sigma)) {
        diagonal[i] += v * v / (sigma[k] * sigma[k]);
      } else if (std::abs(v) > 1e-8) {  // takes part in the dependence by more than rounding
        diagonal[i] = kInfinity;
      }
    }
  }
  return diagonal;
}

}  // namespace

ObservabilityIndices ComputeObservability(const Eigen::VectorXd& singular_values, int postures) {
  ObservabilityIndices indices;
  if (singular_values.size() == 0 || singular_values.minCoeff() <= 0.0) return indices;
  const double smallest = singular_values.minCoeff();
  const double largest = singular_values.maxCoeff();
  indices.o1 = std::exp(singular_values.array().log().mean()) / std::sqrt(postures);
  indices.o2 = smallest / largest;
  indices.o3 = smallest;
  indices.o4 = smallest * smallest / largest;
  indices.o5 = 1.0 / singular_values.cwiseInverse().sum();
  return indices;
}

Excitation AssessExcitation(const Eigen::MatrixXd& factor, const std::vector<int>& base,
                            int postures, double marker_sd) {
  Excitation excitation;
  excitation.parameters = base;
  const Eigen::MatrixXd R_base = factor(Eigen::all, base);
  const Eigen::VectorXd scale = InverseColumnNorms(R_base);
  excitation.condition_all = ConditionNumber(factor * InverseColumnNorms(factor).asDiagonal());
  excitation.condition_base = ConditionNumber(R_base * scale.asDiagonal());
  excitation.parameter_sd.setConstant(static_cast<Eigen::Index>(base.size()), kInfinity);
  if (base.empty() || R_base.rows() < R_base.cols()) return excitation;

  excitation.indices = ComputeObservability(SingularValues(R_base), postures);
  const Eigen::ArrayXd variance = InverseDiagonal(R_base * scale.asDiagonal());
  excitation.parameter_sd =
      marker_sd * variance.sqrt() / R_base.colwise().norm().transpose().array();
  return excitation;
}

std::vector<int> HardlyExcited(const std::vector<Parameter>& parameters,
                               const Excitation& excitation) {
  std::vector<int> weak;
  for (std::size_t k = 0; k < excitation.parameters.size(); ++k) {
    const int i = excitation.parameters[k];
    const bool angle = parameters[i].unit == ParameterUnit::kRadian;
    const double limit = angle ? M_PI / 180.0 : 5e-3;
    if (excitation.parameter_sd[static_cast<Eigen::Index>(k)] > limit) weak.push_back(i);
  }
  return weak;
}

}  // namespace elastocal
