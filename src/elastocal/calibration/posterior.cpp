#include "elastocal/calibration/posterior.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "elastocal/optim/linearisation.hpp"

namespace elastocal {
namespace {

constexpr double kVagueSd = 1.0;  // m or rad

}  // namespace

Posterior ComputePosterior(const ErrorModel& model, BodyResiduals& residuals,
                           const std::vector<int>& parameters, const Eigen::VectorXd& x,
                           const Prior& prior) {
  const Linearisation linear = Linearise(residuals, x, residuals.WaistBlocks());
  const auto count = static_cast<Eigen::Index>(parameters.size());
  const Eigen::Index size = linear.information.rows();
  Eigen::VectorXd scale(count);
  Eigen::MatrixXd total = linear.information;
  for (Eigen::Index i = 0; i < size; ++i) {
    double vague = BodyResiduals::kPoseScale / kVagueSd;
    if (i < count) {
      const Parameter& parameter = model.parameters[parameters[i]];
      scale[i] = ParameterScale(parameter, prior);
      vague = std::isfinite(prior[parameter.kind]) ? 0.0 : scale[i] / kVagueSd;
    }
    total(i, i) += vague * vague;
  }
  const Eigen::MatrixXd inverse =
      Eigen::LLT<Eigen::MatrixXd>(total).solve(Eigen::MatrixXd::Identity(size, size));

  Posterior posterior;
  posterior.parameters = parameters;
  posterior.covariance =
      scale.asDiagonal() * inverse.topLeftCorner(count, count) * scale.asDiagonal();
  posterior.explained = ExplainedCovariances(linear, inverse);
  for (std::size_t block = 0; block < residuals.meanings().size(); ++block) {
    if (residuals.residual_blocks[block].active) {
      posterior.effective_parameters += posterior.explained[block].trace();
    }
  }
  return posterior;
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
