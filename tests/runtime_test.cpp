// SPDX-License-Identifier: Apache-2.0
// Compares the robot at run time with the estimator's model, with statics and with hand values.
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/robot/inverse_dynamics.hpp"
#include "elastocal/robot/leg_load.hpp"
#include "elastocal/robot/legs.hpp"
#include "elastocal/robot/standing.hpp"
#include "elastocal/robot/statics.hpp"
#include "elastocal/runtime/core_correction.h"
#include "tests/expect_input_error.hpp"
#include "tests/runtime_fixture.hpp"

namespace elastocal {
namespace {

TEST_F(Runtime, WithoutErrorsIsTheUrdf) {
  Compensator robot = Make(RuntimeContent::kNominal);
  const Eigen::VectorXd q = Posture(1);
  EXPECT_EQ(robot.Forward(q, kNoTorque, 0), 0u);
  const std::vector<Transform> expected = LinkTransforms(project_.tree, q);
  for (int i = 0; i < static_cast<int>(expected.size()); ++i) {
    EXPECT_LT(Distance(robot.link_pose(i), expected[static_cast<std::size_t>(i)]), kRounding);
  }
  EXPECT_EQ(robot.Correct(q, kNoTorque, 1), 0u);
  EXPECT_LT((robot.rigid_positions() - q).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT(robot.root_displacement().norm(), 1e-12);
  EXPECT_EQ(robot.Command(q, kNoTorque, 1), 0u);
  EXPECT_LT((robot.command() - q).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_F(Runtime, GeometryAloneIsTheCalibratedUrdf) {
  Compensator robot = Make(RuntimeContent::kGeometry);
  const Eigen::VectorXd q = Posture(2);
  robot.Forward(q, kNoTorque, 1);
  const std::vector<Transform> expected = CalibratedLinkTransforms(robot_.model, geometry_, q);
  for (int i = 0; i < static_cast<int>(expected.size()); ++i) {
    EXPECT_LT(Distance(robot.link_pose(i), expected[static_cast<std::size_t>(i)]), kRounding);
  }
}

TEST_F(Runtime, DeflectsAsTheEstimatorsModelDoes) {
  Compensator robot = Make();
  const Eigen::VectorXd q = Posture(3);
  for (int leg : {-1, 0, 1}) {
    const int fixed = leg < 0 ? 0 : Legs()[static_cast<std::size_t>(leg)].foot_link;
    const auto gravity = [&](const std::vector<Transform>& poses) -> Eigen::Vector3d {
      return leg < 0 ? kGravity : Gravity(poses, leg);
    };
    const std::vector<Transform> rigid = CalibratedLinkTransforms(robot_.model, geometry_, q);
    const JointLoads first = GravityLoads(robot_.model, geometry_, q, gravity(rigid), fixed);
    const std::vector<Transform> bent = CalibratedLinkTransforms(robot_.model, geometry_, q, first);
    const JointLoads loads = GravityLoads(robot_.model, geometry_, q, gravity(bent), fixed, first);
    const std::vector<Transform> expected =
        CalibratedLinkTransforms(robot_.model, geometry_, q, loads);
    EXPECT_EQ(robot.Forward(q, kNoTorque, leg < 0 ? 0u : 1u << leg), 0u);
    double largest = 0.0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_LT(Distance(robot.link_pose(static_cast<int>(i)), expected[i]), kRounding);
      largest = std::max(largest, Distance(robot.link_pose(static_cast<int>(i)), rigid[i]));
    }
    EXPECT_GT(largest, 3e-4);  // some deflection was to be expected
  }
}

// A robot may hang on a wall while it is calibrated, and cameras may call another axis up.
TEST_F(Runtime, AHeldRootHasTheGravityOfItsCalibration) {
  Compensator upright = Make();
  stored_.T_ref_waist = Transform(RotX(-M_PI / 2.0));  // upright in a frame with y upwards
  stored_.gravity = {0.0, -9.81, 0.0};
  EXPECT_NEAR(MakeRuntimeModel(project_, stored_).gravity[2], -9.81, 1e-2);
  stored_.gravity = kGravity;  // the same robot on its back
  const RuntimeModel model = MakeRuntimeModel(project_, stored_);
  const Eigen::Vector3d gravity(model.gravity[0], model.gravity[1], model.gravity[2]);
  EXPECT_NEAR(gravity.y(), 9.81, 1e-2);

  const Eigen::VectorXd q = Posture(3);
  const JointLoads first = GravityLoads(robot_.model, geometry_, q, gravity, 0);
  const JointLoads loads = GravityLoads(robot_.model, geometry_, q, gravity, 0, first);
  const std::vector<Transform> expected =
      CalibratedLinkTransforms(robot_.model, geometry_, q, loads);
  Compensator robot(model);
  EXPECT_EQ(robot.Forward(q, kNoTorque, 0), 0u);
  upright.Forward(q, kNoTorque, 0);
  double largest = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const int link = static_cast<int>(i);
    EXPECT_LT(Distance(robot.link_pose(link), expected[i]), kRounding);
    largest = std::max(largest,
                       (robot.link_pose(link).matrix() - upright.link_pose(link).matrix()).norm());
  }
  EXPECT_GT(largest, 3e-4);
}

TEST_F(Runtime, AHeldRootOfTrialsHasTheirGravity) {
  stored_.held_root = HeldRoot{.up = {0.6, 0.0, 0.8}, .differs = 0.01};
  const std::vector<double> gravity = MakeRuntimeModel(project_, stored_).gravity;
  EXPECT_NEAR(gravity[0], -0.6 * 9.81, 1e-12);
  EXPECT_NEAR(gravity[2], -0.8 * 9.81, 1e-12);
  EXPECT_EQ(GravityThatDiffers(stored_), "");
  stored_.held_root->differs = 0.2;
  EXPECT_NE(GravityThatDiffers(stored_).find("up to 11 deg"), std::string::npos);
}

TEST_F(Runtime, LegsGiveWayAsEquation6Says) {
  Compensator robot = Make();
  const Eigen::VectorXd q = Posture(4);
  for (int leg : {0, 1}) {
    robot.Forward(q, kNoTorque, 1u << leg);
    const Leg on = Legs()[static_cast<std::size_t>(leg)];
    LegPosture posture;
    posture.leg = leg;
    for (std::size_t i = 0; i < project_.tree.links.size(); ++i) {
      Transform T = Transform::Identity();
      T.matrix() = robot.link_pose(static_cast<int>(i)).matrix();
      posture.T_ref_link.push_back(T);
    }
    posture.T_foot_waist = posture.T_ref_link[static_cast<std::size_t>(on.foot_link)].inverse();
    const Vector6d load = LoadFromStatics(robot_.model, posture, Gravity(posture.T_ref_link, leg));
    const Transform expected =
        DeflectWaist(posture.T_foot_waist, geometry_.leg_compliance[static_cast<std::size_t>(leg)],
                     load)
            .T_foot_waist;
    // The load is that of the posture before the last deflection, which changes it by some 1e-3.
    EXPECT_LT(Distance(robot.root_pose(), expected), 2e-6);
    EXPECT_GT(Distance(robot.root_pose(), posture.T_foot_waist), 1e-4);
  }
}

TEST_F(Runtime, TwoFeetCarryWhatInverseDynamicsSays) {
  // The robot is rigid, so that both have the same posture.
  Compensator robot = Make(RuntimeContent::kNominal);
  Eigen::VectorXd q = project_.motion.rest;
  robot.Forward(q, kNoTorque, 3);
  const std::vector<BodyInertia> inertias = BodyInertias(project_.tree);
  const std::vector<Transform> T_root_link = LinkTransforms(project_.tree, q);
  const Eigen::Vector3d com = CentreOfMass(project_.tree, inertias, q);
  const double weight = 9.81 * TotalMass(project_.tree);
  std::vector<Sole> soles;
  std::vector<Transform> T_world_sole;
  for (const Leg& leg : Legs()) {
    for (const Sole& sole : project_.soles) {
      if (sole.link != leg.foot_link) continue;
      soles.push_back(sole);
      T_world_sole.push_back(T_root_link[static_cast<std::size_t>(sole.link)]);
    }
  }
  const Eigen::Vector3d force(0.0, 0.0, weight);
  const std::vector<LinkWrench> wrenches =
      ShareWrench(soles, T_world_sole, force, com.cross(force));
  RobotState state;
  state.q = q;
  state.velocity = state.acceleration = Eigen::VectorXd::Zero(q.size());
  const Eigen::VectorXd torques =
      InverseDynamics(project_.tree, inertias, state, kGravity, wrenches).torques;
  // The loads are those of the last Forward. The torque about the axis is their opposite.
  RuntimeModel model = MakeRuntimeModel(project_, stored_, RuntimeContent::kNominal);
  for (ec_joint& joint : model.calibrated) joint.compliance[2] = joint.prismatic ? 0.0 : 1e-9;
  Compensator loaded(std::move(model));
  loaded.Correct(q, kNoTorque, 3);
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double load = (loaded.rigid_positions()[i] - q[i]) / 1e-9;
    EXPECT_NEAR(load, -torques[i], 1e-3 + 1e-4 * std::abs(torques[i]));
  }
}

TEST_F(Runtime, CommandPutsTheRealRobotWhereTheNominalOneIs) {
  Compensator robot = Make();
  for (StandingFeet feet : {0u, 1u, 2u, 3u}) {
    const Eigen::VectorXd q = Posture(5 + feet);
    EXPECT_EQ(DescribeStatus(robot.Command(q, kNoTorque, feet)), "");
    const Eigen::VectorXd command = robot.command();
    const std::vector<Transform> wanted = LinkTransforms(project_.tree, q);
    const auto largest = [&](const Eigen::VectorXd& positions) {
      robot.Forward(positions, kNoTorque, feet);
      double distance = 0.0;
      for (const char* name : {"arm_left", "arm_right", "leg_left", "leg_right"}) {
        const Chain& chain = project_.chains[static_cast<std::size_t>(FindChain(project_, name))];
        const auto tip = static_cast<std::size_t>(chain.tip_link);
        const std::vector<Leg> legs = Legs();
        Eigen::Isometry3d got = robot.link_pose(chain.tip_link);
        for (std::size_t i = 0; i < legs.size(); ++i) {
          // With one foot on the floor, the compliance of that leg as a whole counts.
          if (feet == 1u << i && legs[i].foot_link == chain.tip_link) {
            got = robot.root_pose().inverse();
          }
        }
        distance = std::max(distance, (got.translation() - wanted[tip].translation()).norm());
      }
      return distance;
    };
    EXPECT_GT(largest(q), 3e-3) << feet;
    // With two feet, link_pose does not contain the leg's lumped compliance.
    EXPECT_LT(largest(command), feet == 3 ? 2e-3 : 1e-4) << feet;
  }
}

// With commands, feet and root link are where the plan has them. A nominal robot at the commanded
// positions has its feet elsewhere, and so the root link on them.
TEST_F(Runtime, OnTwoFeetTheRootIsWhereTheCommandsPutIt) {
  Compensator robot = Make();
  const Eigen::VectorXd q = project_.motion.rest;
  ASSERT_EQ(DescribeStatus(robot.Command(q, kNoTorque, 3)), "");
  const Eigen::VectorXd command = robot.command();
  const auto foot = static_cast<std::size_t>(Legs()[0].foot_link);
  const auto other = static_cast<std::size_t>(Legs()[1].foot_link);
  const std::vector<Transform> planned = LinkTransforms(project_.tree, q);
  robot.Forward(command, kNoTorque, 3);
  EXPECT_LT(Distance(robot.root_pose(), planned[foot].inverse()), 1e-4);
  const std::vector<Transform> nominal = LinkTransforms(project_.tree, command);
  EXPECT_GT((nominal[foot].inverse() * nominal[other]).translation().norm() -
                (planned[foot].inverse() * planned[other]).translation().norm(),
            1e-3);
}

TEST_F(Runtime, CorrectGivesARigidRobotThePlacesOfTheElasticOne) {
  Compensator robot = Make();
  Compensator rigid = Make(RuntimeContent::kGeometry);
  const Eigen::VectorXd q = Posture(9);
  for (StandingFeet feet : {1u, 2u}) {
    ASSERT_EQ(robot.Correct(q, kNoTorque, feet), 0u);
    const Eigen::VectorXd positions = robot.rigid_positions();
    const Vector6d displacement = robot.root_displacement();
    robot.Forward(q, kNoTorque, feet);
    rigid.Forward(positions, kNoTorque, feet);
    // The tolerance is what a Gauss-Newton step leaves, see EC_SMALL_STEP.
    EXPECT_LT((robot.root_pose().matrix() - rigid.root_pose().matrix()).cwiseAbs().maxCoeff(),
              2e-6);
    rigid.Forward(q, kNoTorque, feet);
    EXPECT_LT(
        (robot.root_pose().translation() - rigid.root_pose().translation() - displacement.head<3>())
            .norm(),
        1e-9);
    EXPECT_GT(displacement.head<3>().norm(), 5e-4);
  }
}

TEST_F(Runtime, MeasuredTorquesTakeThePlaceOfStatics) {
  Compensator robot = Make();
  const Eigen::VectorXd q = Posture(10);
  const std::size_t k = static_cast<std::size_t>(FindJoint(project_.tree, "arm_left_4_joint"));
  Eigen::VectorXd torque =
      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(project_.tree.joints.size()),
                                std::numeric_limits<double>::quiet_NaN());
  torque[static_cast<Eigen::Index>(k)] = 7.0;
  robot.Correct(q, torque, 0);
  const Eigen::VectorXd with = robot.rigid_positions();
  torque[static_cast<Eigen::Index>(k)] = 8.0;
  robot.Correct(q, torque, 0);
  const double compliance = geometry_.joints[k].compliance.z();
  // The torque balances the load, so 1 N.m more turns the joint back.
  EXPECT_NEAR((robot.rigid_positions() - with)[project_.tree.joints[k].coordinate], -compliance,
              1e-3 * compliance);
}

TEST_F(Runtime, BadInputKeepsTheLastGoodOne) {
  Compensator robot = Make();
  const Eigen::VectorXd q = Posture(11);
  Eigen::VectorXd bad = q;
  bad[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(robot.Command(bad, kNoTorque, 1), unsigned{EC_BAD_POSITION} | EC_NOTHING_YET);
  EXPECT_TRUE(robot.command().allFinite());
  EXPECT_EQ(robot.Command(q, kNoTorque, 1), 0u);
  const Eigen::VectorXd good = robot.command();
  EXPECT_EQ(robot.Command(bad, kNoTorque, 1), unsigned{EC_BAD_POSITION});
  EXPECT_EQ(robot.command(), good);
  EXPECT_EQ(robot.Command(q.head(3), kNoTorque, 1), unsigned{EC_BAD_POSITION});
  EXPECT_EQ(robot.command(), good);
  EXPECT_EQ(robot.Command(q, kNoTorque, 4), unsigned{EC_BAD_SUPPORT});
  EXPECT_EQ(robot.command(), good);

  Eigen::VectorXd torque =
      Eigen::VectorXd::Ones(static_cast<Eigen::Index>(project_.tree.joints.size()));
  EXPECT_EQ(robot.Command(q, torque, 1), 0u);
  const Eigen::VectorXd with_torque = robot.command();
  torque[2] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(robot.Command(q, torque, 1), unsigned{EC_BAD_TORQUE});
  EXPECT_EQ(robot.command(), with_torque);

  // The garbage is finite, but its products are not.
  Eigen::VectorXd garbage = q;
  garbage[3] = 1e300;
  EXPECT_EQ(robot.Command(garbage, torque.setOnes(), 1), unsigned{EC_BAD_POSITION});
  EXPECT_EQ(robot.command(), with_torque);
  robot.Forward(q, torque, 1);
  EXPECT_EQ(robot.Forward(garbage, torque, 1), unsigned{EC_BAD_POSITION});
}

TEST_F(Runtime, NoInputGivesAWildCommand) {
  const CompensatorOptions options{.largest_correction_rad = 0.01};
  Compensator robot(MakeRuntimeModel(project_, stored_), options);
  const Eigen::VectorXd q = Posture(12);
  EXPECT_NE(robot.Command(q, kNoTorque, 1) & EC_CORRECTION_CUT, 0u);
  EXPECT_LE((robot.command() - q).cwiseAbs().maxCoeff(), 0.01 + 1e-12);
  const Eigen::VectorXd torque =
      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(project_.tree.joints.size()), 1e9);
  EXPECT_NE(robot.Correct(q, torque, 1) & EC_DEFLECTION_CUT, 0u);
  EXPECT_LE((robot.rigid_positions() - q).cwiseAbs().maxCoeff(), 0.01 + 1e-12);
  Eigen::VectorXd at_limit = q;
  at_limit[5] = project_.tree.joints[static_cast<std::size_t>(project_.tree.coordinate_joint[5])]
                    .limits.upper;
  robot.Command(at_limit, kNoTorque, 1);
  EXPECT_LE(robot.command()[5], at_limit[5]);
}

TEST_F(Runtime, LowPassFollowsATorqueWithItsTimeConstant) {
  const CompensatorOptions options{.torque_time_constant_s = 0.1, .period_s = 0.001};
  Compensator robot(MakeRuntimeModel(project_, stored_), options);
  const Eigen::VectorXd q = Posture(13);
  const auto count = static_cast<Eigen::Index>(project_.tree.joints.size());
  const int k = FindJoint(project_.tree, "arm_left_4_joint");
  const int coordinate = project_.tree.joints[static_cast<std::size_t>(k)].coordinate;
  robot.Correct(q, Eigen::VectorXd::Zero(count), 0);
  const double begin = robot.rigid_positions()[coordinate];
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(count);
  torque[k] = 10.0;
  for (int i = 0; i < 100; ++i) robot.Correct(q, torque, 0);
  const double after = robot.rigid_positions()[coordinate];
  const double all = -10.0 * geometry_.joints[static_cast<std::size_t>(k)].compliance.z();
  EXPECT_NEAR((after - begin) / all, 1.0 - std::exp(-1.0), 0.01);
}

TEST(RuntimeByHand, OneSpringTurnsByMomentTimesCompliance) {
  // A bar of 1 m and 2 kg along x turns about y. Gravity pulls its centre of mass at 0.5 m down,
  // with 2 * 9.81 * 0.5 N.m about +y.
  RuntimeModel model;
  model.joint_names = model.coordinate_names = {"hinge"};
  ec_joint joint{};
  joint.multiplier = 1.0;
  // In the twisted frame with z along y, x stays and y becomes -z.
  const double R[9] = {1, 0, 0, 0, 0, 1, 0, -1, 0};
  const double back[9] = {1, 0, 0, 0, 0, -1, 0, 1, 0};
  for (int i = 0; i < 9; ++i) {
    joint.twisted.R[i] = R[i];
    joint.body.R[i] = back[i];
  }
  joint.compliance[2] = 1e-4;
  model.nominal = model.calibrated = {joint};
  model.mass = {0.0, 2.0};
  model.moment = {0, 0, 0, 1.0, 0, 0};
  model.leg_of_body = {-1, -1};
  model.link_names = {"tip"};
  ec_frame tip{};
  tip.body = 1;
  for (int i = 0; i < 3; ++i) tip.pose.R[4 * i] = 1.0;
  tip.pose.p[0] = 1.0;
  model.links = {tip};
  model.lower = {-2.0};
  model.upper = {2.0};
  Compensator robot(model);
  const double turn = 9.81e-4;
  robot.Correct(Eigen::VectorXd::Zero(1), kNoTorque, 0);
  EXPECT_NEAR(robot.rigid_positions()[0], turn, 1e-3 * turn * turn);
  robot.Forward(Eigen::VectorXd::Zero(1), kNoTorque, 0);
  EXPECT_NEAR(robot.link_pose(0).translation().z(), -std::sin(turn), 1e-9);
  // If the torque sensor shows 0, there is no load and no deflection.
  robot.Forward(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(1), 0);
  EXPECT_NEAR(robot.link_pose(0).translation().z(), 0.0, 1e-15);
}

}  // namespace
}  // namespace elastocal
