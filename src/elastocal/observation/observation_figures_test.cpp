// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/observation_figures.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/touching_biped.hpp"

namespace elastocal {
namespace {

// A model that halves the errors of 40 touches gains, even if one touch, where both models err by a
// hundred standard deviations, looks a little worse with it.
TEST(GainInSds, IsNotDecidedByOneGrossObservation) {
  const ObservedRobot model = MakeTouchingBiped();
  Random random(3);
  const Observations seen =
      SimulateTouches(model, RandomTruth(model, 1, random), 40, 1, Eigen::Vector3d::Zero(), random);
  const Spread spread = FirstSpread(model.setup.sources);
  std::vector<Eigen::VectorXd> before, after;
  for (const Observation& of : seen.all) {
    const Eigen::VectorXd sds =
        model.instrument(of.instrument).Weights(spread).diagonal().cwiseInverse();
    before.emplace_back(sds.cwiseProduct(random.NormalVector(3, 2.0)));
    after.emplace_back(sds.cwiseProduct(random.NormalVector(3, 1.0)));
  }
  const double clean = GainInSds(model, seen, before, after, spread);
  // Root mean squares are about 1.84 and 0.92 by touch, with deviations of 0.78 and 0.39.
  EXPECT_NEAR(clean, 0.92 / (0.87 / std::sqrt(40.0)), 2.0);
  const double sd = 1.0 / model.instrument(seen.all[7].instrument).Weights(spread)(0, 0);
  before[7] = Eigen::Vector3d(100.0 * sd, 0.0, 0.0);
  after[7] = Eigen::Vector3d(101.0 * sd, 0.0, 0.0);
  EXPECT_GT(GainInSds(model, seen, before, after, spread), 0.8 * clean);
}

}  // namespace
}  // namespace elastocal
