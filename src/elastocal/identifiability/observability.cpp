#include "elastocal/identifiability/observability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/SVD>

namespace elastocal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Eigen::VectorXd InverseNorms(const Eigen::MatrixXd& A) {
  return A.colwise().norm().unaryExpr([](double n) { return n > 0.0 ? 1.0 / n : 0.0; });
}

/// Largest over smallest singular value; infinite below machine precision or where rows are short.
double ConditionNumber(const Eigen::MatrixXd& A) {
  if (A.cols() == 0 || A.rows() < A.cols()) return kInfinity;
  const Eigen::VectorXd sigma = Eigen::BDCSVD<Eigen::MatrixXd>(A).singularValues();
  const double floor = sigma[0] * 1e-14 * static_cast<double>(A.cols());
  const double smallest = sigma[sigma.size() - 1];
  return smallest > floor ? sigma[0] / smallest : kInfinity;
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
  const Eigen::MatrixXd R_base = factor(Eigen::all, base);
  const Eigen::VectorXd scale = InverseNorms(R_base);
  excitation.condition_all = ConditionNumber(factor * InverseNorms(factor).asDiagonal());
  excitation.condition_base = ConditionNumber(R_base * scale.asDiagonal());
  excitation.parameter_sd.setConstant(static_cast<Eigen::Index>(base.size()), kInfinity);
  if (R_base.rows() < R_base.cols()) return excitation;

  excitation.indices = ComputeObservability(
      Eigen::BDCSVD<Eigen::MatrixXd>(R_base).singularValues(), postures);
  // Diagonal of (Psi^T Psi)^-1 from the singular vectors of the scaled columns.
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(R_base * scale.asDiagonal(), Eigen::ComputeThinV);
  const Eigen::ArrayXd sigma = svd.singularValues();
  for (Eigen::Index i = 0; i < scale.size(); ++i) {
    const Eigen::ArrayXd v = svd.matrixV().row(i).transpose();
    const double floor = sigma[0] * 1e-14;
    const double variance =
        (sigma > floor).select(v / sigma.max(floor), v.abs() / floor).square().sum();
    if (scale[i] > 0.0) excitation.parameter_sd[i] = marker_sd * scale[i] * std::sqrt(variance);
  }
  return excitation;
}

}  // namespace elastocal
