// SPDX-License-Identifier: Apache-2.0
#include "elastocal/screening/up_by_torques.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/robot/statics.hpp"
#include "tests/standing_biped.hpp"

namespace elastocal {
namespace {

/// The biped hangs with its root link held, and z of the cameras is up. Its torque sensors have
/// gains, biases and noise.
Recording Hanging(const StandingBiped& robot) {
  Recording recording = robot.Empty({{.name = "a", .chains = {}, .support = {}}}, 30);
  Geometry geometry =
      ApplyErrors(robot.model, Eigen::VectorXd::Zero(robot.model.parameter_count()));
  const Transform T_ref_waist =
      Transform(Eigen::Translation3d(1.0, 2.0, 0.9)) * RotZ(0.5) * RotX(0.2);
  PlaceWaist(T_ref_waist, Vector6d::Zero(), geometry);
  Random random(3);
  const RobotTree& tree = robot.model.tree;
  const auto joints = static_cast<Eigen::Index>(tree.joints.size());
  recording.torques.resize(recording.posture_count(), joints);
  const Eigen::VectorXd gain =
      1.0 + 0.05 * random.NormalVector(static_cast<int>(joints), 1.0).array();
  const Eigen::VectorXd bias = random.NormalVector(static_cast<int>(joints), 3.0);
  for (int i = 0; i < recording.posture_count(); ++i) {
    recording.q.row(i) = random.NormalVector(tree.coordinate_count(), 0.5).transpose();
    recording.markers.row(i) =
        MarkerPositions(robot.model, geometry, recording.q.row(i).transpose())
            .reshaped()
            .transpose();
    const Eigen::VectorXd statics =
        StaticTorques(tree, recording.q.row(i).transpose(),
                      T_ref_waist.linear().transpose() * Eigen::Vector3d(0.0, 0.0, -9.81), 0);
    for (Eigen::Index k = 0; k < joints; ++k) {
      recording.torques(i, k) =
          gain[k] * statics[tree.joints[static_cast<std::size_t>(k)].coordinate] + bias[k] +
          random.Normal(0.3);
    }
  }
  return recording;
}

TEST(FindUpByTorques, SaysNothingOfTheRightAxis) {
  const StandingBiped robot;
  EXPECT_FALSE(FindUpByTorques(robot.model, Hanging(robot), 1.0).has_value());
}

TEST(FindUpByTorques, NamesTheAxisThatGravityIsAlong) {
  const StandingBiped robot;
  for (const Eigen::Vector3d& up : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, -1, 0)}) {
    Recording recording = Hanging(robot);
    recording.gravity = -9.81 * up;
    const auto found = FindUpByTorques(robot.model, recording, 1.0);
    ASSERT_TRUE(found.has_value());
    EXPECT_LT((found->up - Eigen::Vector3d(0, 0, 1)).norm(), 0.1);
    EXPECT_NEAR(found->angle, M_PI / 2.0, 0.1);
    EXPECT_NE(Describe(*found).find("`up: z`"), std::string::npos) << Describe(*found);
  }
}

TEST(FindUpByTorques, SensorsThatShowNoWeightSayNothing) {
  const StandingBiped robot;
  Recording recording = Hanging(robot);
  Random random(4);
  recording.torques = random.NormalVector(static_cast<int>(recording.torques.size()), 5.0)
                          .reshaped(recording.torques.rows(), recording.torques.cols());
  recording.gravity = {9.81, 0.0, 0.0};
  EXPECT_FALSE(FindUpByTorques(robot.model, recording, 1.0).has_value());
}

TEST(FindUpByTorques, OfARobotOnItsFeetTheFeetTell) {
  const StandingBiped robot;
  Recording recording = Hanging(robot);
  recording.gravity = {9.81, 0.0, 0.0};
  recording.trials.front().support = {robot.left};
  EXPECT_FALSE(FindUpByTorques(robot.model, recording, 1.0).has_value());
}

}  // namespace
}  // namespace elastocal
