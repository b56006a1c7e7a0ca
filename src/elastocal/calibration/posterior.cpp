#include "elastocal/calibration/posterior.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "elastocal/optim/linearisation.hpp"

namespace elastocal {
namespace {

constexpr double kVagueSd = 1.0;  // m or rad

}  // namespace

Eigen::MatrixXd WithVaguePrior(const ErrorModel& model, const std::vector<int>& parameters,
                               const Prior& prior, Eigen::MatrixXd information) {
  const auto count = static_cast<Eigen::Index>(parameters.size());
  for (Eigen::Index i = 0; i < information.rows(); ++i) {
    double vague = BodyResiduals::kPoseScale / kVagueSd;
    if (i < count) {
      const Parameter& parameter = model.parameters[parameters[i]];
      vague =
          std::isfinite(prior[parameter.kind]) ? 0.0 : ParameterScale(parameter, prior) / kVagueSd;
    }
    information(i, i) += vague * vague;
  }
  return information;
}

Eigen::MatrixXd TakeCovariance(const ErrorModel& model, const std::vector<int>& parameters,
                               const Prior& prior, const Eigen::MatrixXd& information,
                               Posterior& posterior) {
  const auto count = static_cast<Eigen::Index>(parameters.size());
  Eigen::VectorXd scale(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    scale[i] = ParameterScale(model.parameters[parameters[i]], prior);
  }
  Eigen::MatrixXd inverse =
      Eigen::LLT<Eigen::MatrixXd>(information)
          .solve(Eigen::MatrixXd::Identity(information.rows(), information.rows()));
  posterior.parameters = parameters;
  posterior.covariance =
      scale.asDiagonal() * inverse.topLeftCorner(count, count) * scale.asDiagonal();
  return inverse;
}

Posterior ComputePosterior(const ErrorModel& model, BodyResiduals& residuals,
                           const std::vector<int>& parameters, const Eigen::VectorXd& x,
                           const Prior& prior) {
  const Linearisation linear = Linearise(residuals, x, residuals.WaistBlocks());
  Posterior posterior;
  const Eigen::MatrixXd inverse =
      TakeCovariance(model, parameters, prior,
                     WithVaguePrior(model, parameters, prior, linear.information), posterior);
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
