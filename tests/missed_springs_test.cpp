// SPDX-License-Identifier: Apache-2.0
// A robot gives way, but its project holds it rigid.
#include "elastocal/mistakes/missed_springs.hpp"

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "tests/standing_humanoid.hpp"

namespace elastocal {
namespace {

TEST(MissedSprings, AreNamedWhereTheProjectHoldsTheRobotRigid) {
  StandingHumanoid robot(8);
  const Eigen::VectorXd truth = robot.DrawTruth(4);
  Measurements measured;
  measured.calibration = robot.Record(
      truth, {.marker_sd = 5e-5, .torque_sd = 0.1, .torque_sensors = robot.project.torque_sensors});
  const auto said = [&](double otherwise) {
    Measurements copy = measured;
    const RecordedModel of = MakeRecordedModel(robot.project, {}, copy, KnockSearch::kNone);
    const CalibrationResult fit =
        Calibrate(of.model, copy.calibration, of.base, ModelKinds(of.model).back(), {});
    return FindMissedSprings(robot.project, {}, measured, MarkerError(fit, copy.calibration, {}),
                             otherwise);
  };
  constexpr double kNothingElse = std::numeric_limits<double>::infinity();
  robot.project.elasticity = {};
  EXPECT_EQ(said(kNothingElse), "");
  robot.project.elasticity.torsion = std::vector<std::string>();
  robot.project.elasticity.bending = std::vector<std::string>();
  robot.project.elasticity.base = false;
  EXPECT_EQ(said(kNothingElse).find("the robot gives way under its weight"), 0u)
      << said(kNothingElse);
  EXPECT_EQ(said(1e-6), "") << "a fault that explains more";
}

}  // namespace
}  // namespace elastocal
