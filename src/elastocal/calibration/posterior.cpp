#include "elastocal/calibration/posterior.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr double kVagueSd = 1.0;  // m or rad

/// J^T J over the masked observations, for all parameters of the model.
Eigen::MatrixXd DataInformation(const ErrorModel& model, const Recording& recording,
                                const ObservationMask& mask, const Eigen::VectorXd& delta) {
  GeneralizedJacobian jacobian(model);
  const Geometry geometry = ApplyErrors(model, delta);
  std::vector<Eigen::MatrixXd> by_marker(model.marker_count());
  for (int m = 0; m < model.marker_count(); ++m) {
    const auto size = static_cast<Eigen::Index>(jacobian.Columns(m).size());
    by_marker[m].setZero(size, size);
  }
  for (int i = 0; i < mask.rows(); ++i) {
    jacobian.Evaluate(geometry, recording.q.row(i).transpose());
    for (int m = 0; m < mask.cols(); ++m) {
      if (!mask(i, m)) continue;
      by_marker[m].selfadjointView<Eigen::Lower>().rankUpdate(jacobian.Block(m).transpose());
    }
  }
  Eigen::MatrixXd information =
      Eigen::MatrixXd::Zero(model.parameter_count(), model.parameter_count());
  for (int m = 0; m < model.marker_count(); ++m) {
    information(jacobian.Columns(m), jacobian.Columns(m)) +=
        Eigen::MatrixXd(by_marker[m].selfadjointView<Eigen::Lower>());
  }
  return information;
}

}  // namespace

Posterior ComputePosterior(const ErrorModel& model, const Recording& recording,
                           const ObservationMask& mask, const std::vector<int>& parameters,
                           const Eigen::VectorXd& delta, const Prior& prior, double marker_sd) {
  const auto size = static_cast<Eigen::Index>(parameters.size());
  Eigen::VectorXd scale(size), prior_information(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const Parameter& parameter = model.parameters[parameters[i]];
    scale[i] = ParameterScale(parameter, prior);
    const double sd = prior[parameter.kind];
    const double ratio = scale[i] / (std::isfinite(sd) ? sd : kVagueSd);
    prior_information[i] = ratio * ratio;
  }
  const Eigen::MatrixXd information = DataInformation(model, recording, mask, delta);
  const Eigen::MatrixXd data = scale.asDiagonal() * information(parameters, parameters) *
                               scale.asDiagonal() / (marker_sd * marker_sd);
  Eigen::MatrixXd total = data;
  total.diagonal() += prior_information;
  const Eigen::MatrixXd inverse =
      Eigen::LLT<Eigen::MatrixXd>(total).solve(Eigen::MatrixXd::Identity(size, size));

  Posterior posterior;
  posterior.parameters = parameters;
  posterior.covariance = scale.asDiagonal() * inverse * scale.asDiagonal();
  posterior.effective_parameters =
      static_cast<double>(size) - inverse.diagonal().dot(prior_information);
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
