// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/camera_scale.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "elastocal/math/dense.hpp"

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
  std::vector<Eigen::Index> lengths, others;
  int told = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Parameter& parameter = model.parameters[fitted[static_cast<std::size_t>(i)]];
    if (parameter.joint < 0 || GroupOf(parameter.kind) != PriorGroup::kLengths) {
      others.push_back(i);
      continue;
    }
    lengths.push_back(i);
    const double length = NominalLength(model.placements[parameter.joint], parameter.kind);
    pattern[i] = length / unit[i];
    told += std::abs(length) > kLeastLength ? 1 : 0;
  }
  if (told < kFewestLengths || !options.earlier.empty()) return std::nullopt;
  const Eigen::VectorXd x = result.delta(fitted).cwiseQuotient(unit);
  Eigen::MatrixXd A = unit.asDiagonal() * result.posterior.data_information * unit.asDiagonal();
  const Eigen::VectorXd b = A * x + x;  // of the data alone
  // All but the lengths have their own prior, whatever that of the lengths, and are eliminated.
  A.diagonal() += Eigen::VectorXd::Ones(count);
  const Eigen::MatrixXd across = A(others, lengths);
  Eigen::MatrixXd both(across.rows(), across.cols() + 1);
  both << across, b(others);
  const Eigen::MatrixXd eliminated =
      across.transpose() * SolvePositive(Eigen::MatrixXd(A(others, others)), both);
  Eigen::MatrixXd own_information = A(lengths, lengths);
  own_information.diagonal().array() -= 1.0;
  own_information -= eliminated.leftCols(across.cols());
  const Eigen::VectorXd own_b = b(lengths) - eliminated.rightCols<1>();
  const Eigen::VectorXd own_pattern = pattern(lengths);
  // The prior was widened with the pattern in it; how wide it has to be beside the pattern:
  const double narrowest = 1.0 / result.prior_scale[PriorGroup::kLengths];
  double width = narrowest;
  CommonScale scale;
  for (int round = 0; round < kRounds; ++round) {
    const double weight = 1.0 / (width * width);
    Eigen::MatrixXd information = own_information;
    information.diagonal().array() += weight;
    const Eigen::MatrixXd covariance = InverseOfPositive(information);
    const Eigen::VectorXd pull = weight * own_pattern;
    const double known = pull.dot(own_pattern) - pull.dot(covariance * pull);
    if (!(known > 0.0)) return std::nullopt;
    scale = {pull.dot(covariance * own_b) / known, 1.0 / std::sqrt(known)};
    const Eigen::VectorXd own = covariance * (own_b + scale.size * pull) - scale.size * own_pattern;
    const double squares = weight * own.squaredNorm();
    const double determined = (1.0 - weight * covariance.diagonal().array()).sum();
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
