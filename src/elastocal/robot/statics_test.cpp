#include "elastocal/robot/statics.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

using Eigen::Vector3d;

/// Energy that lifting the links against gravity has cost, J.
double PotentialEnergy(const RobotTree& tree, const Eigen::VectorXd& q, const Vector3d& gravity) {
  const std::vector<Transform> T_root_link = LinkTransforms(tree, q);
  double energy = 0.0;
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    energy -= tree.links[i].mass * gravity.dot(T_root_link[i] * tree.links[i].com);
  }
  return energy;
}

void ExpectTorquesAreTheSlopeOfEnergy(const RobotTree& tree, const Vector3d& gravity,
                                      Random& random) {
  const Eigen::VectorXd q = RandomPosture(tree, random);
  const Eigen::VectorXd torques = GravityTorques(tree, q, gravity);
  const double step = 1e-4;
  for (int i = 0; i < q.size(); ++i) {
    Eigen::VectorXd forward = q, backward = q;
    forward[i] += step;
    backward[i] -= step;
    const double slope =
        (PotentialEnergy(tree, forward, gravity) - PotentialEnergy(tree, backward, gravity)) /
        (2.0 * step);
    // Some 100 J: rounding 1e-14 over the step leaves 1e-8, the step's square as much.
    EXPECT_NEAR(torques[i], slope, 1e-6) << tree.joints[tree.coordinate_joint[i]].name;
  }
}

void GiveMasses(RobotTree& tree, Random& random) {
  for (Link& link : tree.links) {
    link.mass = random.Uniform(0.0, 5.0);
    link.com = random.NormalVector(3, 0.1);
  }
}

TEST(Statics, PlanarArmByHand) {
  // Lying arm that lifts about -y: 2 kg at the elbow, 1 kg at the tip.
  RobotTree tree = PlanarArm();
  tree.links[2].mass = 2.0;
  tree.links[3].mass = 1.0;
  const Vector3d gravity(0, -10, 0);  // down in the arm's plane
  const Eigen::VectorXd torques = GravityTorques(tree, Eigen::Vector2d::Zero(), gravity);
  EXPECT_NEAR(torques[0], 2 * 10 * 0.5 + 1 * 10 * 0.8, 1e-13);  // holds it up: positive about z
  EXPECT_NEAR(torques[1], 1 * 10 * 0.3, 1e-13);
  // Standing up, nothing is to hold.
  EXPECT_LT(GravityTorques(tree, Eigen::Vector2d(M_PI / 2, 0), gravity).norm(), 1e-13);
}

TEST(Statics, SlidingAndMimicJointsByHand) {
  RobotTree tree = MakeRoot();
  const int lift =
      AddJoint(tree, "lift", 0, Transform::Identity(), {0, 0, 1}, JointType::kPrismatic);
  const int second =
      AddJoint(tree, "second", lift, Offset(0, 0, 1), {0, 0, -1}, JointType::kPrismatic);
  MakeLastJointMimic(tree, 0, -3.0, 0.0);  // rises three times as fast above the lift
  tree.links[lift].mass = 5.0;
  tree.links[second].mass = 2.0;
  const Eigen::VectorXd forces = GravityTorques(tree, Eigen::VectorXd::Zero(1));
  ASSERT_EQ(forces.size(), 1);
  EXPECT_NEAR(forces[0], 9.81 * (5.0 + 2.0 * (1 + 3)), 1e-12);
}

TEST(Statics, TorquesAreTheSlopeOfPotentialEnergy) {
  Random random(1);
  RobotTree rail_arm = RailArm();  // sliding, mimic and branch
  GiveMasses(rail_arm, random);
  ExpectTorquesAreTheSlopeOfEnergy(rail_arm, kGravity, random);
  ExpectTorquesAreTheSlopeOfEnergy(rail_arm, {3, -4, -8}, random);
  for (int i = 0; i < 20; ++i) {
    RobotTree tree = RandomRobot(kUsualRelations, random);
    GiveMasses(tree, random);
    ExpectTorquesAreTheSlopeOfEnergy(tree, kGravity, random);
  }
}

TEST(Statics, TotalMassIsThatOfAllLinks) {
  RobotTree tree = PlanarArm();
  for (int i = 0; i < 4; ++i) tree.links[i].mass = i + 0.5;
  EXPECT_DOUBLE_EQ(TotalMass(tree), 8.0);
}

}  // namespace
}  // namespace elastocal
