// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/contact_result.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr double kTiedVariance = 1e-6;  // relative, see TakePosterior

/// Half width of a 95 % interval in standard deviations.
double IntervalFactor(double degrees_of_freedom) {
  return std::clamp(StudentQuantile(0.975, std::max(1.0, degrees_of_freedom)), 1.959964, 12.7);
}

/// Standard deviations of the priors by parameter, widened like those of the posterior where few
/// numbers determine them; NaN for parameters that are not estimated.
Eigen::VectorXd PriorSds(const ObservedRobot& model, const ObservationFit& fit) {
  const double usual = IntervalFactor(fit.degrees_of_freedom);
  const std::vector<SourceOfParameter> sources = SourcesOfParameters(model);
  Eigen::VectorXd sds = Eigen::VectorXd::Constant(model.robot.parameter_count(),
                                                  std::numeric_limits<double>::quiet_NaN());
  for (int i = 0; i < model.robot.parameter_count(); ++i) {
    if (model.unknown[i] < 0) continue;
    const auto source = static_cast<std::size_t>(sources[i].source);
    const double own =
        fit.spread_freedom.empty() ? usual : IntervalFactor(fit.spread_freedom[source]);
    sds[i] = fit.spread.sd[source] * sources[i].unit * std::max(1.0, own / usual);
  }
  return sds;
}

/// Covariance of the parameters. Parameters with one value in common would make it singular, so
/// that nothing could be tested with it: each therefore has a millionth of its variance to itself.
void TakePosterior(const ObservedRobot& model, const ObservationFit& fit,
                   CalibrationResult& result) {
  std::vector<int> entries;
  for (int i = 0; i < model.robot.parameter_count(); ++i) {
    if (model.unknown[i] < 0) continue;
    result.posterior.parameters.push_back(i);
    entries.push_back(fit.entry_of_unknown[model.unknown[i]]);
  }
  result.posterior.covariance = fit.covariance(entries, entries);
  result.posterior.covariance.diagonal() *= 1.0 + kTiedVariance;
  result.posterior.effective_parameters = fit.effective_parameters;
}

}  // namespace

CalibrationResult ResultOfContacts(const ObservedRobot& model, const ObservationFit& fit,
                                   int equations) {
  CalibrationResult result;
  const auto elastic = [](const Parameter& parameter) { return IsElastic(parameter.kind); };
  result.kind = std::any_of(model.robot.parameters.begin(), model.robot.parameters.end(), elastic)
                    ? ModelKind::kFull
                    : ModelKind::kGeometric;
  result.model = model.robot;
  result.delta = fit.values.robot;
  result.prior_sd = PriorSds(model, fit);
  result.sd = result.prior_sd;
  TakePosterior(model, fit, result);
  const Eigen::VectorXd sds = result.posterior.StandardDeviations();
  const CalibrationOptions usual;
  result.status.assign(model.unknown.size(), ParameterStatus::kHeld);
  for (std::size_t k = 0; k < result.posterior.parameters.size(); ++k) {
    const int i = result.posterior.parameters[k];
    result.sd[i] = sds[static_cast<Eigen::Index>(k)];
    result.status[i] = result.sd[i] < usual.support_threshold * result.prior_sd[i]
                           ? ParameterStatus::kEstimated
                           : ParameterStatus::kUnsupported;
  }
  result.interval_factor = IntervalFactor(fit.degrees_of_freedom);
  result.equations = equations;
  result.termination = fit.termination;
  result.settled = fit.settled;
  result.iterations = fit.iterations;
  return result;
}

CalibrationResult InformationOfContacts(const ObservedRobot& model,
                                        const Observations& observations,
                                        const ObservationFit& fit) {
  CalibrationResult result;
  result.model = model.robot;
  result.delta = fit.values.robot;
  result.prior_sd = Eigen::VectorXd::Ones(model.robot.parameter_count());
  const std::vector<SourceOfParameter> sources = SourcesOfParameters(model);
  for (const int i : ParameterOfUnknown(model)) {
    result.prior_sd[i] = fit.spread[sources[Size(i)].source] * sources[Size(i)].unit;
    result.posterior.parameters.push_back(i);
  }
  result.posterior.data_information = RobotInformation(model, observations, fit);
  result.interval_factor = IntervalFactor(fit.degrees_of_freedom);
  return result;
}

}  // namespace elastocal
