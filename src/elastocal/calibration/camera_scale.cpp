// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/camera_scale.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "elastocal/calibration/posterior.hpp"

namespace elastocal {
namespace {

constexpr double kLeastScale = 3e-3;
constexpr double kCertain = 4.5;  // standard deviations
constexpr int kRounds = 10;
constexpr int kFewestLengths = 4;
constexpr double kLeastLength = 0.02;  // m: shorter ones tell nothing of a scale

double NominalLength(const JointPlacement& placement, ParameterKind kind) {
  switch (kind) {
    case ParameterKind::kR:
      return placement.r;
    case ParameterKind::kD:
      return placement.d;
    case ParameterKind::kB:
      return placement.b;
    default:
      return 0.0;
  }
}

}  // namespace

std::optional<CommonScale> EstimateCommonScale(const CalibrationResult& result,
                                               const CalibrationOptions& options) {
  const ErrorModel& model = result.model;
  const std::vector<int>& fitted = result.posterior.parameters;
  const auto count = static_cast<Eigen::Index>(fitted.size());
  // In units of the prior.
  const Eigen::VectorXd unit = result.prior_sd(fitted);
  Eigen::VectorXd pattern = Eigen::VectorXd::Zero(count);
  std::vector<Eigen::Index> lengths;
  int told = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Parameter& parameter = model.parameters[fitted[static_cast<std::size_t>(i)]];
    if (parameter.joint < 0 || GroupOf(parameter.kind) != PriorGroup::kLengths) continue;
    lengths.push_back(i);
    const double length = NominalLength(model.placements[parameter.joint], parameter.kind);
    pattern[i] = length / unit[i];
    told += std::abs(length) > kLeastLength ? 1 : 0;
  }
  if (told < kFewestLengths || !options.earlier.empty()) return std::nullopt;
  const Eigen::MatrixXd A =
      unit.asDiagonal() * result.posterior.data_information * unit.asDiagonal();
  const Eigen::VectorXd x = result.delta(fitted).cwiseQuotient(unit);
  const Eigen::VectorXd b = A * x + x;  // of the data alone
  // The prior was widened with the pattern in it; how wide it has to be beside the pattern:
  const double narrowest = 1.0 / result.prior_scale[PriorGroup::kLengths];
  double width = narrowest;
  CommonScale scale;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::VectorXd weight = Eigen::VectorXd::Ones(count);
    for (Eigen::Index i : lengths) weight[i] = 1.0 / (width * width);
    Eigen::MatrixXd information = A;
    information.diagonal() += weight;
    const Eigen::MatrixXd covariance = InverseOfInformation(information);
    const Eigen::VectorXd pull = weight.cwiseProduct(pattern);
    const double known = pull.dot(pattern) - pull.dot(covariance * pull);
    if (!(known > 0.0)) return std::nullopt;
    scale = {pull.dot(covariance * b) / known, 1.0 / std::sqrt(known)};
    const Eigen::VectorXd own = covariance * (b + scale.size * pull) - scale.size * pattern;
    double squares = 0.0, determined = 0.0;
    for (Eigen::Index i : lengths) {
      squares += own[i] * own[i] * weight[i];
      determined += 1.0 - covariance(i, i) * weight[i];
    }
    if (determined < 1.0) break;
    width = std::max(narrowest, width * std::sqrt(squares / determined));
  }
  return scale;
}

std::optional<CommonScale> FindWrongScale(const CalibrationResult& result,
                                          const CalibrationOptions& options) {
  const auto scale = EstimateCommonScale(result, options);
  const bool wrong =
      scale && std::abs(scale->size) > kLeastScale && std::abs(scale->size) > kCertain * scale->sd;
  return wrong ? scale : std::nullopt;
}

std::string Describe(const CommonScale& scale) {
  char text[300];
  std::snprintf(
      text, sizeof text,
      "the cameras' positions seem %.4f +- %.4f times the true ones in all trials, since all "
      "lengths of the robot are off by as much: calibrate the cameras again with the right "
      "wand, or describe the robot with its own size",
      1.0 + scale.size, scale.sd);
  return text;
}

}  // namespace elastocal
