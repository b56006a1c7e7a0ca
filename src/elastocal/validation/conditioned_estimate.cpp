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
#include "elastocal/robot/parameters.hpp"

namespace elastocal {
namespace {

/// Quantity of a parameter: the part of its name after the last dot.
std::string QuantityName(const std::string& parameter) {
  return parameter.substr(parameter.rfind('.') + 1);
}

/// Joints of which a calibration has geometric parameters.
std::set<std::string> JointsOf(const CalibrationEstimate& estimate) {
  using Kind = ParameterKind;
  constexpr std::array kGeometry = {Kind::kTheta, Kind::kR,    Kind::kD,    Kind::kB,
                                    Kind::kAlpha, Kind::kBeta, Kind::kGamma};
  std::set<std::string> joints;
  for (const ParameterEstimate& parameter : estimate.parameters) {
    if (parameter.external) continue;
    const std::string quantity = QuantityName(parameter.name);
    if (std::ranges::any_of(kGeometry, [&](Kind kind) { return quantity == KindName(kind); })) {
      joints.insert(OwnerName(parameter.name));
    }
  }
  return joints;
}

/// Whether the name is that of a cause that belongs to no joint (corrections.hpp).
bool IsCauseOfNoJoint(const std::string& name) {
  return IsLoad(name) || name.starts_with("waist.");
}

/// Factor by which the estimated variance of the noise grows if `count` parameters are fixed at
/// values that raise the weighted sum of squares by `squares`.
double MoreNoise(const CalibrationEstimate& estimate, double squares, Eigen::Index count) {
  const double freedom = StudentDegreesOfFreedom(0.975, estimate.interval_factor);
  if (!std::isfinite(freedom)) return 1.0;  // the noise is known
  return std::max(1.0, (freedom + squares) / (freedom + static_cast<double>(count)));
}

/// Rows of a covariance: the fixed parameters with the change of their values, and the others.
struct Rows {
  std::vector<int> fixed, others;
  Eigen::VectorXd step;
};

/// Finds the rows. Throws InputError where a fixed parameter has none.
Rows FindRows(const CalibrationEstimate& estimate, const std::vector<FixedParameter>& fixed) {
  std::map<std::string, double> values, steps;
  for (const ParameterEstimate& one : estimate.parameters) values.emplace(one.name, one.value);
  for (const FixedParameter& one : fixed) steps.emplace(one.name, one.value - values.at(one.name));
  Rows rows{.fixed = {}, .others = {}, .step = Eigen::VectorXd(std::ssize(steps))};
  for (std::size_t row = 0; row < estimate.covariance_names.size(); ++row) {
    const auto step = steps.find(estimate.covariance_names[row]);
    if (step == steps.end()) {
      rows.others.push_back(static_cast<int>(row));
      continue;
    }
    rows.step[std::ssize(rows.fixed)] = step->second;
    rows.fixed.push_back(static_cast<int>(row));
    steps.erase(step);
  }
  if (steps.empty()) return rows;
  throw InputError(estimate.source + ": its covariance has no parameter '" + steps.begin()->first +
                   "'");
}

/// Conditional normal distribution; compliances may become negative.
CalibrationEstimate ConditionedOnce(const CalibrationEstimate& estimate,
                                    const std::vector<FixedParameter>& fixed) {
  const Rows rows = FindRows(estimate, fixed);
  // In units of standard deviations, because the parameters have different units.
  const Eigen::MatrixXd& S = estimate.covariance;
  const Eigen::VectorXd per_sd = S.diagonal()(rows.fixed).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd across = S(rows.others, rows.fixed) * per_sd.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> factor(
      Eigen::MatrixXd(per_sd.asDiagonal() * S(rows.fixed, rows.fixed) * per_sd.asDiagonal()));
  if (factor.info() != Eigen::Success) {
    throw InputError(estimate.source + ": its covariance is not positive definite");
  }
  const Eigen::VectorXd step = per_sd.cwiseProduct(rows.step);
  const Eigen::VectorXd weights = factor.solve(step);
  const Eigen::VectorXd moved = across * weights;

  CalibrationEstimate result = estimate;
  result.covariance = MoreNoise(estimate, step.dot(weights), step.size()) *
                      (S(rows.others, rows.others) - across * factor.solve(across.transpose()));
  result.covariance_names.clear();
  std::map<std::string, ParameterEstimate*> by_name;
  for (ParameterEstimate& one : result.parameters) by_name.emplace(one.name, &one);
  for (const FixedParameter& one : fixed) {
    ParameterEstimate& parameter = *by_name.at(one.name);
    parameter.value = one.value;
    parameter.sd = std::numeric_limits<double>::quiet_NaN();
    parameter.status = ParameterStatus::kHeld;
  }
  for (std::size_t i = 0; i < rows.others.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const std::string& name = estimate.covariance_names[static_cast<std::size_t>(rows.others[i])];
    ParameterEstimate& parameter = *by_name.at(name);
    parameter.value += moved[row];
    parameter.sd = std::sqrt(result.covariance(row, row));
    result.covariance_names.push_back(name);
  }
  return result;
}

}  // namespace

bool IsLoad(const std::string& parameter) {
  const std::string quantity = QuantityName(parameter);
  return quantity == "mass" || quantity.starts_with("moment_") || quantity.starts_with("tilt_");
}

bool IsSpring(const std::string& parameter) {
  return QuantityName(parameter).starts_with("compliance_");
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
