// SPDX-License-Identifier: Apache-2.0
// Compares the embedded humanoid (models/talos) with the published description of the robot.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/robot_tree.hpp"
#include "elastocal/robot/statics.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

TEST(TalosModel, HoldsThePapersSetUp) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  EXPECT_EQ(project.tree.joints.size(), 30u);
  EXPECT_EQ(project.tree.coordinate_count(), 30);
  EXPECT_EQ(project.markers.size(), 63u);
  EXPECT_EQ(project.clusters.size(), 21u);
  EXPECT_EQ(project.reference_cluster, "WAIST");
  EXPECT_EQ(project.torque_sensors.size(), 24u);

  // Number of markers N_M of the chains for which the paper gives 4 R + 3 N_M parameters.
  const std::map<std::string, std::size_t> expected{
      {"head_trunk", 6}, {"leg_left", 9},        {"leg_right", 9},       {"arm_left", 18},
      {"arm_right", 18}, {"torso_arm_left", 21}, {"torso_arm_right", 21}};
  ASSERT_EQ(project.chains.size(), expected.size());
  for (const Chain& chain : project.chains) {
    EXPECT_EQ(ChainMarkers(project, chain).size(), expected.at(chain.name)) << chain.name;
  }
}

class TalosAgainstPublished : public testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path file = SharedFile("robots/talos/talos_full_v2.urdf");
    if (!std::filesystem::exists(file)) {
      GTEST_SKIP() << "the published description is not here: " << file;
    }
    published_ = ReadUrdf(file);
  }

  /// The same posture of the published robot, with its fingers at zero.
  Eigen::VectorXd PublishedPosture(const Eigen::VectorXd& q) const {
    Eigen::VectorXd published_q = Eigen::VectorXd::Zero(published_.coordinate_count());
    for (const Joint& joint : talos_.joints) {
      published_q[Published(joint).coordinate] = q[joint.coordinate];
    }
    return published_q;
  }

  const Joint& Published(const Joint& joint) const {
    return published_.joints[FindJoint(published_, joint.name)];
  }

  const RobotTree talos_ = ReadUrdf(SourceFile("models/talos/talos.urdf"));
  RobotTree published_;
  Random random_{1};
};

TEST_F(TalosAgainstPublished, Kinematics) {
  // The numbers are the same in another order of operations. 1e-9 m and rad are a million
  // roundings. The links are those of all 30 joints, both soles, both grippers and the inertial
  // sensor.
  for (int i = 0; i < 1000; ++i) {
    const Eigen::VectorXd q = RandomPosture(talos_, random_);
    const std::vector<Transform> T_root_link = LinkTransforms(talos_, q);
    const std::vector<Transform> expected = LinkTransforms(published_, PublishedPosture(q));
    for (std::size_t k = 0; k < talos_.links.size(); ++k) {
      const std::string& name = talos_.links[k].name;
      const Transform error = T_root_link[k].inverse() * expected[FindLink(published_, name)];
      EXPECT_LT(error.translation().norm(), 1e-9) << name;
      EXPECT_LT(RotationAngle(error.linear()), 1e-9) << name;
    }
  }
}

TEST_F(TalosAgainstPublished, Limits) {
  for (const Joint& joint : talos_.joints) {
    const JointLimits& expected = Published(joint).limits;
    EXPECT_DOUBLE_EQ(joint.limits.lower, expected.lower) << joint.name;
    EXPECT_DOUBLE_EQ(joint.limits.upper, expected.upper) << joint.name;
    EXPECT_DOUBLE_EQ(joint.limits.velocity, expected.velocity) << joint.name;
    EXPECT_DOUBLE_EQ(joint.limits.effort, expected.effort) << joint.name;
  }
}

TEST_F(TalosAgainstPublished, MassAndGravityTorques) {
  // Lumped masses and their centres have 12 digits, which is 1e-10 of some 100 N.m.
  EXPECT_NEAR(TotalMass(talos_), TotalMass(published_), 1e-6);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::VectorXd q = RandomPosture(talos_, random_);
    const Eigen::VectorXd torques = GravityTorques(talos_, q);
    const Eigen::VectorXd expected = GravityTorques(published_, PublishedPosture(q));
    for (const Joint& joint : talos_.joints) {
      EXPECT_NEAR(torques[joint.coordinate], expected[Published(joint).coordinate], 1e-6)
          << joint.name;
    }
  }
}

}  // namespace
}  // namespace elastocal
