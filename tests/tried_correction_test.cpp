// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/tried_correction.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/faulty_arm.hpp"

namespace elastocal {
namespace {

using TriedCorrections = FaultyArm;

// The three postures of the short trial do not show the fault.
TEST_F(TriedCorrections, OfSomeTrialsAreTriedInAll) {
  recorded_.trials = {{"long", TrialKind::kCalibration, {project_.chains.front().name}},
                      {"short", TrialKind::kCalibration, {project_.chains.front().name}}};
  recorded_.trial.assign(48, 0);
  std::fill(recorded_.trial.end() - 3, recorded_.trial.end(), 1);
  const Eigen::MatrixXd truth = recorded_.q;
  recorded_.q.col(CoordinateOf("elbow_joint")) *= -1.0;
  const std::vector<TriedCorrection> tried = Suspicions(project_, model_, recorded_, 3);
  EXPECT_TRUE(std::ranges::any_of(tried, [&](const TriedCorrection& one) {
    return one.name == "sign:elbow_joint" && one.corrected.q.isApprox(truth);
  }));
}

}  // namespace
}  // namespace elastocal
