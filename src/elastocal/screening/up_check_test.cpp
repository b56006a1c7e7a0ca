// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/up_check.hpp"

#include <gtest/gtest.h>

#include "elastocal/robot/kinematics.hpp"
#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

/// The nominal biped stands in its zero posture, upright along z of the cameras.
Recording Standing(const StandingBiped& robot) {
  Recording recording =
      robot.Empty({{.name = "a", .chains = {}, .support = {robot.left}},
                   {.name = "b", .chains = {}, .support = {robot.left, robot.right}}},
                  3);
  Geometry geometry =
      ApplyErrors(robot.model, Eigen::VectorXd::Zero(robot.model.parameter_count()));
  PlaceWaist(Transform(Eigen::Translation3d(1.0, 2.0, 0.9)) * RotZ(0.5), Vector6d::Zero(),
             geometry);
  for (int i = 0; i < recording.posture_count(); ++i) {
    recording.markers.row(i) =
        MarkerPositions(robot.model, geometry, recording.q.row(i).transpose())
            .reshaped()
            .transpose();
  }
  return recording;
}

TEST(FindWrongUp, ARobotThatStandsSaysNothing) {
  const StandingBiped robot;
  EXPECT_FALSE(FindWrongUp(robot.model, Standing(robot)).has_value());
}

TEST(FindWrongUp, NamesTheAxisThatIsUp) {
  const StandingBiped robot;
  for (const Eigen::Vector3d& up :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0, 0, -1)}) {
    Recording recording = Standing(robot);
    recording.gravity = -9.81 * up;
    const auto found = FindWrongUp(robot.model, recording);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->axis, "z");
    EXPECT_NE(Describe(*found).find("with `up: z` it is"), std::string::npos);
  }
}

TEST(FindWrongUp, ARobotWhoseRootIsHeldMayHangAnyWay) {
  const StandingBiped robot;
  Recording recording = Standing(robot);
  recording.gravity = {9.81, 0.0, 0.0};
  for (Trial& trial : recording.trials) trial.support.clear();
  EXPECT_FALSE(FindWrongUp(robot.model, recording).has_value());
}

}  // namespace
}  // namespace elastocal
