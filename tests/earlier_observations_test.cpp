// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "elastocal/observation/observation_fit.hpp"
#include "tests/instrumented_biped.hpp"

namespace elastocal {
namespace {

/// What a fit tells another one about the robot.
EarlierEstimate EarlierOf(const ObservedRobot& model, const ObservationFit& fit) {
  EarlierEstimate earlier;
  const std::vector<int> parameters = ParameterOfUnknown(model);
  for (int i : parameters) earlier.names.push_back(model.robot.parameters[i].name);
  earlier.mean = fit.values.robot(parameters);
  earlier.covariance = fit.covariance(fit.entry_of_unknown, fit.entry_of_unknown);
  return earlier;
}

/// A biped with rigid joints, errors and noise, which touches a table.
struct TouchingBiped {
  TouchingBiped(int touches, std::uint64_t seed)
      : random(seed),
        truth(RandomTruth(model, 1, random)),
        seen(SimulateTouches(model, truth, touches, 1, Eigen::Vector3d::Zero(), random)) {
    AddNoise(model, seen, random);
  }

  const ObservedRobot model = MakeTouchingBiped({"*.compliance_*"});
  Random random;
  const ObservedValues truth;
  Observations seen;
};

TEST(EarlierObservations, AnEarlierFitAsThePriorIsAsGoodAsItsObservations) {
  const TouchingBiped biped(50, 17);
  const ObservedRobot& model = biped.model;
  const ObservedValues& truth = biped.truth;
  const Observations& all = biped.seen;
  std::vector<int> first, then;
  for (int i = 0; i < all.posture_count(); ++i) (i < 40 ? first : then).push_back(i);
  // All but the robot is known, because a fit hands on nothing else.
  const ObservationFitOptions options{
      .freedom = {.mountings = false, .surroundings = false, .effects = false},
      .estimate_spread = false};
  const auto fit = [&](const ObservedRobot& robot, const Observations& observations) {
    ObservationFit start = StartFit(robot, observations);
    start.values.quantities = truth.quantities;
    start.values.effects = truth.effects;
    return FitObservations(robot, observations, start, options);
  };
  ObservedRobot again = model;
  again.earlier = EarlierOf(model, fit(model, SelectPostures(all, first)));
  const ObservationFit updated = fit(again, SelectPostures(all, then));
  const ObservationFit together = fit(model, all);
  EXPECT_TRUE(updated.settled);
  const Eigen::VectorXd sds = together.covariance.diagonal().cwiseSqrt();
  const Eigen::VectorXd sds_updated = updated.covariance.diagonal().cwiseSqrt();
  for (const int i : ParameterOfUnknown(model)) {
    const int entry = together.entry_of_unknown[model.unknown[i]];
    EXPECT_NEAR(updated.values.robot[i], together.values.robot[i], 0.05 * sds[entry])
        << model.robot.parameters[i].name;
    EXPECT_NEAR(sds_updated[entry], sds[entry], 0.01 * sds[entry]);
  }
}

TEST(EarlierObservations, WhatTheDataSayOfTheRobotDoesNotDependOnThePrior) {
  const TouchingBiped biped(40, 18);
  const ObservedRobot& model = biped.model;
  const Observations& seen = biped.seen;
  const ObservationFit fit = EstimateObserved(model, seen, {}).fit;
  ObservedRobot again = model;
  again.earlier = EarlierOf(model, fit);
  again.earlier.names.resize(20);  // the others have priors by kind
  again.earlier.mean.conservativeResize(20);
  again.earlier.covariance.conservativeResize(20, 20);
  const Eigen::MatrixXd information = RobotInformation(model, seen, fit);
  const Eigen::VectorXd unit = information.diagonal().cwiseMax(1e-12).cwiseSqrt().cwiseInverse();
  EXPECT_GT(information.norm(), 0.0);
  EXPECT_LT(
      (unit.asDiagonal() * (RobotInformation(again, seen, fit) - information) * unit.asDiagonal())
          .cwiseAbs()
          .maxCoeff(),
      1e-4);
}

}  // namespace
}  // namespace elastocal
