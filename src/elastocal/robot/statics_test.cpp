// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/statics.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "elastocal/robot/posture_loads.hpp"
#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

using Eigen::Vector3d;

/// Energy that it takes to lift the links against gravity, J.
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
    // Energies are some 100 J. Rounding of 1e-14 over the step leaves 1e-8, and so does truncation.
    EXPECT_NEAR(torques[i], slope, 1e-6) << tree.joints[tree.coordinate_joint[i]].name;
  }
}

void GiveMasses(RobotTree& tree, Random& random) {
  for (Link& link : tree.links) {
    link.mass = random.Uniform(0.0, 5.0);
    link.com = random.NormalVector(3, 0.1);
  }
}

TEST(Statics, LargestTorquesAreThoseOfLoadsHeldOutSideways) {
  RobotTree tree = PlanarArm();  // 0.5 and 0.3 m
  tree.links[2].mass = 2.0;
  tree.links[3].mass = 1.0;
  const Eigen::VectorXd torques = LargestGravityTorques(tree);
  EXPECT_NEAR(torques[0], 9.81 * (2 * 0.5 + 1 * 0.8), 1e-12);
  EXPECT_NEAR(torques[1], 9.81 * 1 * 0.3, 1e-12);
}

TEST(Statics, PlanarArmByHand) {
  // An arm in the xy plane, with gravity along -y, 2 kg at the elbow and 1 kg at the tip.
  RobotTree tree = PlanarArm();
  tree.links[2].mass = 2.0;
  tree.links[3].mass = 1.0;
  const Vector3d gravity(0, -10, 0);  // downwards in the arm's plane
  const Eigen::VectorXd torques = GravityTorques(tree, Eigen::Vector2d::Zero(), gravity);
  EXPECT_NEAR(torques[0], 2 * 10 * 0.5 + 1 * 10 * 0.8, 1e-13);  // positive about z holds the arm up
  EXPECT_NEAR(torques[1], 1 * 10 * 0.3, 1e-13);
  // An upright arm needs no torque.
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

/// Energy at positions q, if `fixed_link` is held where it is at positions `at`.
double EnergyAbout(const RobotTree& tree, const Eigen::VectorXd& q, const Eigen::VectorXd& at,
                   const Vector3d& gravity, int fixed_link) {
  const Transform T_now_moved =
      LinkTransforms(tree, at)[fixed_link] * LinkTransforms(tree, q)[fixed_link].inverse();
  double energy = 0.0;
  const std::vector<Transform> T_root_link = LinkTransforms(tree, q);
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    energy -= tree.links[i].mass * gravity.dot(T_now_moved * (T_root_link[i] * tree.links[i].com));
  }
  return energy;
}

TEST(Statics, TorquesOnAnyFixedLinkAreTheSlopeOfPotentialEnergy) {
  Random random(2);
  for (int i = 0; i < 30; ++i) {
    RobotTree tree = RandomRobot(kUsualRelations, random);
    GiveMasses(tree, random);
    const Vector3d gravity = random.NormalVector(3, 6.0);
    const int fixed_link = random.Index(static_cast<int>(tree.links.size()));
    const Eigen::VectorXd q = RandomPosture(tree, random);
    const Eigen::VectorXd torques = StaticTorques(tree, q, gravity, fixed_link);
    const double step = 1e-4;
    for (int c = 0; c < q.size(); ++c) {
      Eigen::VectorXd forward = q, backward = q;
      forward[c] += step;
      backward[c] -= step;
      const double slope = (EnergyAbout(tree, forward, q, gravity, fixed_link) -
                            EnergyAbout(tree, backward, q, gravity, fixed_link)) /
                           (2.0 * step);
      // The tolerance is as above.
      EXPECT_NEAR(torques[c], slope, 1e-6);
    }
  }
}

TEST(GravityLoads, OfALeverByHand) {
  // The arm lies along x and lifts about -y. Half-way along the forearm is a mass of 2 kg; gravity
  // is 10.
  RobotTree tree = MakeRoot();
  const int upper = AddJoint(tree, "shoulder", 0, Transform::Identity(), {0, -1, 0});
  const int lower = AddJoint(tree, "elbow", upper, Offset(0.5, 0, 0), {0, -1, 0});
  tree.links[0].mass = 100.0;
  tree.links[upper].mass = 1.0;
  tree.links[lower].mass = 2.0;
  tree.links[lower].com = {0.15, 0, 0};
  const ErrorModel model =
      MakeErrorModel(tree, {{"M", lower, {0.3, 0, 0}}}, {}, {.torsion = {0, 1}});
  const Vector3d gravity(0, 0, -10);
  const Eigen::Vector2d q(0, 0);
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  const JointLoads held = GravityLoads(model, ApplyErrors(model, delta), q, gravity, 0);
  EXPECT_LT((held.col(0) - Vector3d(0, 0, -2 * 10 * 0.65)).norm(), 1e-13);
  EXPECT_LT((held.col(1) - Vector3d(0, 0, -2 * 10 * 0.15)).norm(), 1e-13);
  // If the hand is held instead, the elbow carries the root and the upper arm. They pull it down on
  // its other side, which turns the child the other way round.
  const JointLoads hanging = GravityLoads(model, ApplyErrors(model, delta), q, gravity, lower);
  EXPECT_LT((hanging.col(1) - Vector3d(0, 0, -(100 + 1) * 10 * 0.5)).norm(), 1e-12);
}

TEST(PostureLoads, AreThoseOfTheDeflectedArmByHand) {
  // The arm of 13 N.m at the shoulder and 3 N.m at the elbow is lifted by 45 degrees. Its elastic
  // shoulder sinks, which brings the masses further out.
  RobotTree tree = MakeRoot();
  const int upper = AddJoint(tree, "shoulder", 0, Transform::Identity(), {0, -1, 0});
  const int lower = AddJoint(tree, "elbow", upper, Offset(0.5, 0, 0), {0, -1, 0});
  tree.links[lower].mass = 2.0;
  tree.links[lower].com = {0.15, 0, 0};
  const ErrorModel model =
      MakeErrorModel(tree, {{"M", lower, {0.3, 0, 0}}}, {}, {.torsion = {0, 1}});
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  delta[FindParameter(model.parameters, "shoulder.compliance_z")] = 1e-3;
  const Geometry geometry = ApplyErrors(model, delta);
  const Vector3d gravity(0, 0, -10);
  const Eigen::Vector2d q(M_PI / 4, 0);

  const PostureLoads by_statics = LoadPosture(model, geometry, q, -1, {}, gravity, {});
  const double sunk = M_PI / 4 - 1e-3 * 13 * std::cos(M_PI / 4);
  EXPECT_NEAR(by_statics.joints(2, 0), -13 * std::cos(sunk), 1e-12);
  EXPECT_NEAR(by_statics.joints(2, 1), -3 * std::cos(sunk), 1e-12);

  // A sensor at the shoulder says how far that sinks.
  MeasuredLoads measured;
  measured.torques = Eigen::Vector2d(50, std::numeric_limits<double>::quiet_NaN());
  const PostureLoads by_sensor = LoadPosture(model, geometry, q, -1, measured, gravity, {});
  EXPECT_NEAR(by_sensor.joints(2, 0), -50, 1e-12);
  EXPECT_NEAR(by_sensor.joints(2, 1), -3 * std::cos(M_PI / 4 - 1e-3 * 50), 1e-12);
}

/// Height of the tip of a horizontal link of 0.3 m behind its elastic joint, if the motor's sensor
/// reports this torque.
double TipHeight(const Vector3d& axis, double measured_torque) {
  RobotTree tree = MakeRoot();
  const int link = AddJoint(tree, "joint", 0, Transform::Identity(), axis);
  const ErrorModel model = MakeErrorModel(tree, {{"M", link, {0.3, 0, 0}}}, {}, {.torsion = {0}});
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  delta[FindParameter(model.parameters, "joint.compliance_z")] = 1e-3;
  JointLoads loads = JointLoads::Zero(3, 1);
  UseMeasuredTorques(Eigen::VectorXd::Constant(1, measured_torque), loads);
  return MarkerPositions(model, ApplyErrors(model, delta), Eigen::VectorXd::Zero(1), loads)(2, 0);
}

TEST(MeasuredTorques, ALinkSagsUnderWhatItsMotorHoldsUp) {
  // A positive torque lifts about -y, a negative one about y. Both of 10 N.m balance a weight.
  EXPECT_NEAR(TipHeight({0, -1, 0}, 10.0), -0.3 * std::sin(0.01), 1e-15);
  EXPECT_NEAR(TipHeight({0, 1, 0}, -10.0), -0.3 * std::sin(0.01), 1e-15);
}

TEST(MeasuredTorques, ReplaceTheMomentAboutTheAxisWhereThereAreSome) {
  JointLoads loads(3, 2);
  loads << 1, 2, 3, 4, 5, 6;
  UseMeasuredTorques(Eigen::Vector2d(NAN, 7.0), loads);
  JointLoads expected(3, 2);
  expected << 1, 2, 3, 4, 5, -7;
  EXPECT_EQ(loads, expected);
}

class LoadsOfRandomRobots : public testing::TestWithParam<int> {
 protected:
  LoadsOfRandomRobots() {
    RobotTree tree = RandomRobot(kUsualRelations, random_);
    GiveMasses(tree, random_);
    fixed_link_ = random_.Index(static_cast<int>(tree.links.size()));
    Elasticity elasticity;
    for (int k = 0; k < static_cast<int>(tree.joints.size()); ++k) {
      elasticity.torsion.push_back(k);
      if (tree.joints[k].type != JointType::kRevolute) continue;
      elasticity.bending.push_back(k);
      if (tree.joints[k].parent_body == 0) elasticity.root_bending.push_back(k);
    }
    model_ = MakeErrorModel(tree, RandomMarkers(tree, random_), {}, elasticity);
    model_.T_ref_waist = RandomTransform(random_);
    gravity_ref_ = random_.NormalVector(3, 6.0);
    q_ = RandomPosture(tree, random_);
  }
  Random random_{GetParam() + 100u};
  ErrorModel model_;
  int fixed_link_ = 0;
  Vector3d gravity_ref_;
  Eigen::VectorXd q_;
};

TEST_P(LoadsOfRandomRobots, AboutTheAxisAreTheOppositeOfTheTorques) {
  const Eigen::VectorXd nominal = Eigen::VectorXd::Zero(model_.parameter_count());
  const JointLoads loads =
      GravityLoads(model_, ApplyErrors(model_, nominal), q_, gravity_ref_, fixed_link_);
  const Eigen::VectorXd torques = StaticTorques(
      model_.tree, q_, model_.T_ref_waist.linear().transpose() * gravity_ref_, fixed_link_);
  for (int k : model_.active_joints) EXPECT_NEAR(loads(2, k), -torques[k], 1e-9) << k;
}

/// Energy of the calibrated robot with the fixed link held.
double ElasticEnergy(const ErrorModel& model, const Eigen::VectorXd& delta,
                     const Eigen::VectorXd& q, const JointLoads& loads, const Vector3d& gravity,
                     const Transform& T_ref_fixed, int fixed_link) {
  const auto T = CalibratedLinkTransforms(model, ApplyErrors(model, delta), q, loads);
  double energy = 0.0;
  for (std::size_t i = 0; i < T.size(); ++i) {
    const Link& link = model.tree.links[i];
    energy -= link.mass * gravity.dot(T_ref_fixed * (T[fixed_link].inverse() * (T[i] * link.com)));
  }
  return energy;
}

TEST_P(LoadsOfRandomRobots, TurnJointsTheWayThatLowersTheRobot) {
  // This holds for all three axes of every joint, with errors in all parameters. The work of
  // gravity in a small elastic rotation e about an axis is load * e. With a unit load instead of
  // the true one, the compliance is that rotation.
  Eigen::VectorXd delta = random_.NormalVector(model_.parameter_count(), 0.02);
  for (int i = 0; i < delta.size(); ++i) {
    if (IsCompliance(model_.parameters[i].kind)) delta[i] = 0.0;
  }
  const Geometry geometry = ApplyErrors(model_, delta);
  const JointLoads loads = GravityLoads(model_, geometry, q_, gravity_ref_, fixed_link_);
  const Transform T_ref_fixed = CalibratedLinkTransforms(model_, geometry, q_)[fixed_link_];
  JointLoads ones = JointLoads::Ones(3, loads.cols());
  ones.about_root.setOnes(3, loads.cols());
  const double step = 1e-4;
  for (int i = 0; i < delta.size(); ++i) {
    const Parameter& p = model_.parameters[i];
    if (!IsCompliance(p.kind)) continue;
    Eigen::VectorXd forward = delta, backward = delta;
    forward[i] += step;
    backward[i] -= step;
    const auto energy = [&](const Eigen::VectorXd& moved) {
      return ElasticEnergy(model_, moved, q_, ones, gravity_ref_, T_ref_fixed, fixed_link_);
    };
    const double work = -(energy(forward) - energy(backward)) / (2.0 * step);
    // Energies are hundreds of J. Truncation leaves 1e-6, and rounding 1e-13 / 1e-4.
    const double load =
        p.axis < kRootAxis ? loads(p.axis, p.joint) : loads.about_root(p.axis - kRootAxis, p.joint);
    EXPECT_NEAR(load, work, 1e-5) << p.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, LoadsOfRandomRobots, testing::Range(1, 31));

TEST(GravityLoads, OneStepOfDeflectionIsEnough) {
  // Deflection changes the loads by its own size, some 1e-3. A second step would change them by the
  // square of this.
  RobotTree tree = TalosLeg();
  Random random(1);
  GiveMasses(tree, random);
  const ErrorModel model = MakeErrorModel(tree, {{"M", 6, {0, 0, 0}}}, {},
                                          {.torsion = {0, 1, 2, 3, 4, 5}, .bending = {1, 2}});
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  for (int i = 0; i < delta.size(); ++i) {
    if (IsCompliance(model.parameters[i].kind)) delta[i] = 5e-5;
  }
  const Geometry geometry = ApplyErrors(model, delta);
  const Eigen::VectorXd q = RandomPosture(tree, random);
  const Vector3d gravity(3, 0, -9);
  const JointLoads rigid = GravityLoads(model, geometry, q, gravity, 0);
  const JointLoads once = GravityLoads(model, geometry, q, gravity, 0, rigid);
  const JointLoads twice = GravityLoads(model, geometry, q, gravity, 0, once);
  EXPECT_GT((once - rigid).norm(), 1e-5 * rigid.norm());
  EXPECT_LT((once - rigid).norm(), 1e-2 * rigid.norm());
  EXPECT_LT((twice - once).norm(), 1e-5 * rigid.norm());
}

TEST(Statics, TotalMassIsThatOfAllLinks) {
  RobotTree tree = PlanarArm();
  for (int i = 0; i < 4; ++i) tree.links[i].mass = i + 0.5;
  EXPECT_DOUBLE_EQ(TotalMass(tree), 8.0);
}

}  // namespace
}  // namespace elastocal
