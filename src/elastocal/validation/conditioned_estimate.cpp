// SPDX-License-Identifier: Apache-2.0
#include "elastocal/validation/conditioned_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <Eigen/Cholesky>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

/// The joints whose geometry a calibration has.
std::set<std::string> JointsOf(const CalibrationEstimate& estimate) {
  constexpr std::array<const char*, 7> kGeometry = {".theta", ".r",    ".d",    ".b",
                                                    ".alpha", ".beta", ".gamma"};
  std::set<std::string> joints;
  for (const ParameterEstimate& parameter : estimate.parameters) {
    if (parameter.external) continue;
    if (std::ranges::any_of(kGeometry,
                            [&](const char* kind) { return parameter.name.ends_with(kind); })) {
      joints.insert(OwnerName(parameter.name));
    }
  }
  return joints;
}

/// Whether the name is that of a cause that belongs to no joint (corrections.hpp).
bool IsCauseOfNoJoint(const std::string& name) {
  return IsLoad(name) || name.starts_with("waist.");
}

/// By how much the variance of the noise that a fit finds grows, if `count` parameters are fixed at
/// a place that costs `squares` in its weighted sum of squares.
double MoreNoise(const CalibrationEstimate& estimate, double squares, Eigen::Index count) {
  const double freedom = StudentDegreesOfFreedom(0.975, estimate.interval_factor);
  if (!std::isfinite(freedom)) return 1.0;  // the noise is known
  return std::max(1.0, (freedom + squares) / (freedom + static_cast<double>(count)));
}

CalibrationEstimate ConditionedOnce(const CalibrationEstimate& estimate,
                                    const std::vector<FixedParameter>& fixed) {
  CalibrationEstimate result = estimate;
  std::map<std::string, ParameterEstimate*> by_name;
  for (ParameterEstimate& parameter : result.parameters) {
    by_name.emplace(parameter.name, &parameter);
  }
  std::map<std::string, double> values;
  for (const FixedParameter& one : fixed) values.emplace(one.name, one.value);

  // Rows of the covariance, apart: those that are fixed and the others.
  std::vector<int> at, others;
  std::vector<double> steps;
  for (std::size_t row = 0; row < estimate.covariance_names.size(); ++row) {
    const auto value = values.find(estimate.covariance_names[row]);
    if (value == values.end()) {
      others.push_back(static_cast<int>(row));
      continue;
    }
    ParameterEstimate& parameter = *by_name.at(value->first);
    at.push_back(static_cast<int>(row));
    steps.push_back(value->second - parameter.value);
    parameter.value = value->second;
    parameter.sd = std::numeric_limits<double>::quiet_NaN();
    parameter.status = ParameterStatus::kHeld;
    values.erase(value);
  }
  if (!values.empty()) {
    throw InputError(estimate.source + ": its covariance has no parameter '" +
                     values.begin()->first + "'");
  }

  const Eigen::VectorXd step =
      Eigen::Map<const Eigen::VectorXd>(steps.data(), static_cast<Eigen::Index>(steps.size()));
  // In units of standard deviations, as the parameters have different units.
  const Eigen::MatrixXd& S = estimate.covariance;
  const Eigen::VectorXd per_sd = S.diagonal()(at).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd across = S(others, at) * per_sd.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> factor(
      Eigen::MatrixXd(per_sd.asDiagonal() * S(at, at) * per_sd.asDiagonal()));
  if (factor.info() != Eigen::Success) {
    throw InputError(estimate.source + ": its covariance is not positive definite");
  }
  const Eigen::VectorXd scaled = per_sd.cwiseProduct(step);
  const Eigen::VectorXd weights = factor.solve(scaled);
  const Eigen::VectorXd moved = across * weights;
  result.covariance = MoreNoise(estimate, scaled.dot(weights), step.size()) *
                      (S(others, others) - across * factor.solve(across.transpose()));
  result.covariance_names.clear();
  for (std::size_t i = 0; i < others.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    ParameterEstimate& parameter =
        *by_name.at(estimate.covariance_names[static_cast<std::size_t>(others[i])]);
    parameter.value += moved[row];
    parameter.sd = std::sqrt(result.covariance(row, row));
    result.covariance_names.push_back(parameter.name);
  }
  return result;
}

}  // namespace

bool IsLoad(const std::string& parameter) {
  return parameter.starts_with("gravity.") || parameter.ends_with(".mass") ||
         parameter.find(".moment_") != std::string::npos;
}

bool IsSpring(const std::string& parameter) {
  return parameter.find(".compliance_") != std::string::npos;
}

std::vector<FixedParameter> FixedIn(const CalibrationEstimate& other,
                                    const CalibrationEstimate& estimate) {
  std::map<std::string, const ParameterEstimate*> there;
  for (const ParameterEstimate& parameter : other.parameters) {
    there.emplace(parameter.name, &parameter);
  }
  const std::set<std::string> joints = JointsOf(estimate), joints_there = JointsOf(other);
  const bool all_there = std::ranges::includes(joints_there, joints);
  std::vector<FixedParameter> fixed;
  for (const ParameterEstimate& parameter : estimate.parameters) {
    if (parameter.external || parameter.status != ParameterStatus::kEstimated) continue;
    const auto at = there.find(parameter.name);
    if (at != there.end()) {
      const ParameterStatus status = at->second->status;
      if (status == ParameterStatus::kHeld || status == ParameterStatus::kNotInModel) {
        fixed.push_back({parameter.name, at->second->value});
      }
    } else if (joints_there.contains(OwnerName(parameter.name)) ||
               (all_there && IsCauseOfNoJoint(parameter.name))) {
      fixed.push_back({parameter.name, 0.0});
    }
  }
  return fixed;
}

CalibrationEstimate Conditioned(const CalibrationEstimate& estimate,
                                const std::vector<FixedParameter>& fixed) {
  std::vector<FixedParameter> all = fixed;
  while (!all.empty()) {
    CalibrationEstimate result = ConditionedOnce(estimate, all);
    const std::size_t count = all.size();
    for (const ParameterEstimate& parameter : result.parameters) {
      const bool estimated = parameter.status == ParameterStatus::kEstimated;
      if (estimated && IsSpring(parameter.name) && parameter.value < 0.0) {
        all.push_back({parameter.name, 0.0});
      }
    }
    if (all.size() == count) return result;
  }
  return estimate;
}

}  // namespace elastocal
