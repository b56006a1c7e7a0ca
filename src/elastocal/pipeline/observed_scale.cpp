// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/observed_scale.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "elastocal/math/dense.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/optim/normal_equations.hpp"

namespace elastocal {
namespace {

bool MeasuresLengths(const Instrument& instrument) {
  const std::string_view kind = instrument.kind();
  return kind == "pose" || kind == "position" || kind == "wire";
}

/// What the observations alone tell of entries of x, all others being unknown with their priors, in
/// units of `scale`; `prior`: of these entries, likewise.
Eigen::MatrixXd DataInformation(const Eigen::MatrixXd& information, const std::vector<int>& entries,
                                const Eigen::VectorXd& prior) {
  std::vector<char> own(Size(information.rows()), 0);
  for (const int entry : entries) own[Size(entry)] = 1;
  std::vector<int> others;
  for (int i = 0; i < static_cast<int>(own.size()); ++i) {
    if (own[Size(i)] == 0) others.push_back(i);
  }
  Eigen::MatrixXd data = information(entries, entries);
  if (!others.empty()) {
    const Eigen::MatrixXd across = information(others, entries);
    data -=
        across.transpose() * SolvePositive(Eigen::MatrixXd(information(others, others)), across);
  }
  data.diagonal() -= prior;
  return data;
}

}  // namespace

std::optional<CommonScale> FindObservedScale(const ObservedRobot& model,
                                             const Observations& observations,
                                             const ObservationFit& fit) {
  const bool told = std::any_of(
      observations.all.begin(), observations.all.end(),
      [&](const Observation& of) { return MeasuresLengths(model.instrument(of.instrument)); });
  if (!told) return std::nullopt;
  ObservationResiduals residuals(model, observations, fit.loads, fit.spread, fit.weights, {},
                                 fit.values);
  residuals.Evaluate(residuals.Start(), true);
  const NormalEquations equations(residuals);

  // One parameter for each unknown of the robot; those in common have one value.
  CalibrationResult result;
  result.model = model.robot;
  result.delta = fit.values.robot;
  result.prior_sd = Eigen::VectorXd::Ones(model.robot.parameter_count());
  const std::vector<SourceOfParameter> sources = SourcesOfParameters(model);
  std::vector<int> entries;
  std::vector<double> prior;
  for (int i = 0; i < model.robot.parameter_count(); ++i) {
    const int unknown = model.unknown[Size(i)];
    if (unknown < 0) continue;
    const int entry = residuals.RobotEntry(unknown);
    if (std::find(entries.begin(), entries.end(), entry) != entries.end()) continue;
    const SourceOfParameter& of = sources[Size(i)];
    result.prior_sd[i] = fit.spread[of.source] * of.unit;
    result.posterior.parameters.push_back(i);
    entries.push_back(entry);
    prior.push_back(std::pow(residuals.scale()[entry] / result.prior_sd[i], 2));
  }
  const Eigen::VectorXd unit = residuals.scale()(entries).cwiseInverse();
  const Eigen::VectorXd own_prior = Eigen::VectorXd::Map(prior.data(), std::ssize(prior));
  result.posterior.data_information =
      unit.asDiagonal() *
      DataInformation(equations.information(), equations.Positions(entries), own_prior) *
      unit.asDiagonal();
  const std::vector<Source> common = CommonSources();
  result.prior_scale[PriorGroup::kLengths] = fit.spread[kLength] / common[kLength].sd;
  return FindWrongScale(result, {});
}

}  // namespace elastocal
