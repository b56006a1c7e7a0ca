// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/leg_load.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/robot/posture_loads.hpp"
#include "elastocal/robot/statics.hpp"
#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

using Eigen::Vector3d;

/// The TALOS leg under a waist of 60 kg with a payload on an arm. Each link of the leg weighs
/// `leg_mass`.
ErrorModel Humanoid(double leg_mass) {
  RobotTree tree = TalosLeg();
  for (int i = 1; i <= 6; ++i) {
    tree.links[i].mass = leg_mass;
    tree.links[i].com = {0.01, 0.02, -0.1};
  }
  tree.links[0].mass = 60.0;
  tree.links[0].com = {0.03, -0.05, 0.2};
  const int arm = AddJoint(tree, "arm", 0, Offset(0, 0, 0.5), {0, 1, 0});
  tree.links[arm].mass = 8.0;
  tree.links[arm].com = {0.3, 0, 0};
  AddFixedLink(tree, "sole", 6, FromXyzRpy({0.02, 0, -0.1}, {0, 0, 0.3}));
  return MakeErrorModel(tree, {}, {}, {.legs = {{"leg", 8}}, .torque_bias = true});
}

Eigen::VectorXd BentKnee() {
  Eigen::VectorXd q(7);
  q << 0.1, 0.05, -0.6, 1.1, -0.5, -0.05, 0.4;
  return q;
}

Geometry Nominal(const ErrorModel& model) {
  Geometry geometry = ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
  PlaceWaist(FromXyzRpy({1, 2, 0.9}, {0.05, -0.1, 0.7}), Vector6d::Zero(), geometry);
  return geometry;
}

/// Torques of the leg's joints by statics, with its sole on the floor.
Eigen::VectorXd StandingTorques(const ErrorModel& model, const LegPosture& posture,
                                const Vector3d& gravity_ref) {
  const Vector3d gravity_waist = posture.T_ref_link[0].linear().transpose() * gravity_ref;
  return StaticTorques(model.tree, BentKnee(), gravity_waist, model.legs[0].link).head<6>();
}

TEST(LegPosture, JacobianAgreesWithDifferences) {
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    const RobotTree tree = RandomRobot(kUsualRelations, random);
    const int foot = 1 + random.Index(static_cast<int>(tree.links.size()) - 1);
    if (tree.links[foot].body == 0) continue;
    ErrorModel model = MakeErrorModel(tree, {}, {}, {.legs = {{"leg", foot}}});
    const Eigen::VectorXd delta = random.NormalVector(model.parameter_count(), 0.05);
    const Geometry geometry = ApplyErrors(model, delta);
    const Eigen::VectorXd q = RandomPosture(tree, random);
    const LegPosture posture = PlaceLeg(model, geometry, q, 0);
    const double step = 1e-5;
    for (std::size_t k = 0; k < model.legs[0].joints.size(); ++k) {
      const Eigen::VectorXd e = step * Eigen::VectorXd::Unit(q.size(), model.legs[0].joints[k]);
      const Transform forward = PlaceLeg(model, geometry, q + e, 0).T_foot_waist;
      const Transform backward = PlaceLeg(model, geometry, q - e, 0).T_foot_waist;
      const Eigen::Matrix<double, 3, 4> slope =
          (forward.matrix() - backward.matrix()).topRows<3>() / (2.0 * step);
      const Vector6d motion = posture.J_waist_q.col(static_cast<Eigen::Index>(k));
      // The step's square is 1e-10, and lengths are up to some ten metres.
      EXPECT_LT((slope.col(3) - motion.head<3>()).norm(), 1e-8);
      EXPECT_LT(
          (slope.leftCols<3>() - Skew(motion.tail<3>()) * posture.T_foot_waist.linear()).norm(),
          1e-8);
    }
  }
}

TEST(LegLoad, OfALeverByHand) {
  // A column on one hinge about y at its foot. The hinge's torque is the moment of what stands on
  // it, and that moment is all that it shows. Of the wrenches at the waist, 0.8 m above, that have
  // this moment, the least is a moment and a force in the ratio of their levers.
  RobotTree tree = MakeRoot();
  AddJoint(tree, "ankle", 0, Offset(0, 0, -0.8), {0, 1, 0});
  const ErrorModel model = MakeErrorModel(tree, {}, {}, {.legs = {{"leg", 1}}});
  const LegPosture posture = PlaceLeg(model, Nominal(model), Eigen::VectorXd::Zero(1), 0);
  Vector6d motion;
  motion << -0.8, 0, 0, 0, -1, 0;  // foot forwards and up: waist back and nose up
  EXPECT_LT((posture.J_waist_q.col(0) - motion).norm(), 1e-15);
  const LegLoad load =
      LoadFromTorques(posture, Eigen::VectorXd::Constant(1, 20.0), {.length_scale = 0.4});
  // tau = 0.8 F_x + M_y. The least (0.4 F_x)^2 + M_y^2 has 0.4 F_x = 2 M_y, so 5 M_y = 20.
  Vector6d expected;
  expected << 20, 0, 0, 0, 4, 0;
  EXPECT_LT((load.wrench - expected).norm(), 1e-12);
  EXPECT_NEAR(load.condition, 1.0, 1e-12);
}

TEST(LegLoad, AllSourcesAgreeWithoutMassInTheLeg) {
  const ErrorModel model = Humanoid(0.0);
  const Vector3d gravity(0, 0, -9.81);
  const LegPosture posture = PlaceLeg(model, Nominal(model), BentKnee(), 0);
  const Vector6d statics = LoadFromStatics(model, posture, gravity);
  const LegLoad load = LoadFromTorques(posture, StandingTorques(model, posture, gravity));
  EXPECT_EQ(load.status, LegLoadStatus::kReliable);
  // Hundreds of N, times the condition number and rounding.
  EXPECT_LT((load.wrench - statics).norm(), 1e-10);
  EXPECT_NEAR(statics.head<3>().norm(), 68.0 * 9.81, 1e-10);

  // The floor's reaction is the weight, upwards, at the centre of mass of the whole robot.
  const Transform& T_ref_ankle = posture.T_ref_link[6];
  Vector3d moment = Vector3d::Zero();
  for (int link : {0, 7}) {
    moment += model.tree.links[link].mass *
              (posture.T_ref_link[link] * model.tree.links[link].com - T_ref_ankle.translation())
                  .cross(gravity);
  }
  Vector6d measured;
  measured << -68.0 * (T_ref_ankle.linear().transpose() * gravity),
      -(T_ref_ankle.linear().transpose() * moment);
  EXPECT_LT((LoadFromWrench(model, posture, 6, measured, gravity) - statics).norm(), 1e-10);
}

TEST(LegLoad, PushesTheWaistDown) {
  // The sole is level: the load is the weight along -z of the foot, and the waist sinks.
  const ErrorModel model = Humanoid(0.0);
  Geometry geometry = Nominal(model);
  const LegPosture before = PlaceLeg(model, geometry, BentKnee(), 0);
  PlaceWaist(before.T_foot_waist, Vector6d::Zero(), geometry);  // the foot's frame is the reference
  const LegPosture posture = PlaceLeg(model, geometry, BentKnee(), 0);
  const Vector3d gravity(0, 0, -9.81);
  const LegLoad load = LoadFromTorques(posture, StandingTorques(model, posture, gravity));
  EXPECT_LT((load.wrench.head<3>() - Vector3d(0, 0, -68.0 * 9.81)).norm(), 1e-9);
  Vector6d compliance = Vector6d::Zero();
  compliance[2] = 1e-5;
  const WaistDeflection deflection = DeflectWaist(posture.T_foot_waist, compliance, load.wrench);
  EXPECT_NEAR(deflection.T_foot_waist.translation().z() - posture.T_foot_waist.translation().z(),
              -68.0 * 9.81 * 1e-5, 1e-12);
}

TEST(LegLoad, TheLegsOwnWeightIsALoadUnlessItIsTakenOff) {
  const ErrorModel model = Humanoid(3.0);
  const Vector3d gravity(1, -2, -9);
  const LegPosture posture = PlaceLeg(model, Nominal(model), BentKnee(), 0);
  const Eigen::VectorXd torques = StandingTorques(model, posture, gravity);
  const Vector6d statics = LoadFromStatics(model, posture, gravity);
  const Vector6d raw = LoadFromTorques(posture, torques).wrench;
  const Eigen::VectorXd own = LegWeightTorques(model, posture, gravity);
  EXPECT_LT((LoadFromTorques(posture, torques - own).wrench - statics).norm(), 1e-10);
  EXPECT_GT((raw - statics).norm(), 1.0);
  EXPECT_EQ(own[0], 0.0);  // there is no link between the first joint and the waist
}

// The two legs are under a pelvis that turns beneath the waist. The lifted leg is carried, though
// it hangs on a joint of the standing leg.
TEST(LegLoad, AnotherLegBehindASharedJointIsCarried) {
  RobotTree tree = MakeRoot();
  tree.links[0].mass = 40.0;
  tree.links[0].com = {0.03, -0.05, 0.2};
  const int pelvis = AddJoint(tree, "waist", 0, Offset(0, 0, -0.05), {0, 0, 1});
  tree.links[pelvis].mass = 7.0;
  std::vector<Elasticity::Leg> legs;
  for (const double side : {0.1, -0.1}) {
    const std::string name = side > 0.0 ? "left" : "right";
    int link = pelvis;
    const Vector3d axes[] = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}, {1, 0, 0}};
    for (int k = 0; k < 6; ++k) {
      const Transform T = k == 0 ? Offset(0, side, 0) : Offset(0, 0, k == 3 || k == 4 ? -0.4 : 0.0);
      link = AddJoint(tree, name + std::to_string(k), link, T, axes[k]);
      tree.links[link].mass = 2.0 + k;
      tree.links[link].com = {0.02, 0.01, -0.1};
    }
    legs.push_back({name, link});
  }
  const ErrorModel model = MakeErrorModel(tree, {}, {}, {.legs = legs});
  Eigen::VectorXd q(13);
  q << 0.3, 0.1, 0.05, -0.6, 1.1, -0.5, -0.05, 0.2, -0.1, -0.9, 1.3, -0.4, 0.1;
  const LegPosture posture = PlaceLeg(model, Nominal(model), q, 0);
  const Vector3d gravity_ref(0, 0, -9.81);
  const Vector3d gravity_waist = posture.T_ref_link[0].linear().transpose() * gravity_ref;
  const Eigen::VectorXd torques =
      StaticTorques(model.tree, q, gravity_waist, model.legs[0].link).head<7>();
  const Vector6d wrench = LoadFromStatics(model, posture, gravity_ref);
  const double right_leg = 2.0 + 3.0 + 4.0 + 5.0 + 6.0 + 7.0;
  EXPECT_NEAR(wrench.head<3>().norm(), (40.0 + right_leg) * 9.81, 1e-9);
  const LegLoad load =
      LoadFromTorques(posture, torques - LegWeightTorques(model, posture, gravity_ref));
  EXPECT_LT((load.wrench - wrench).norm(), 1e-9);
}

TEST(LegLoad, AForceSensorCarriesTheLinksAboveIt) {
  const ErrorModel model = Humanoid(3.0);
  const Vector3d gravity(1, -2, -9);
  const LegPosture posture = PlaceLeg(model, Nominal(model), BentKnee(), 0);
  for (int sensor : {1, 4, 6, 8}) {
    // The wrench at the sensor holds up all bodies except that of the sensor and those beyond it.
    const int first_below = std::min(sensor, 6);
    const Transform& T_ref_sensor = posture.T_ref_link[sensor];
    Vector3d force = Vector3d::Zero(), moment = Vector3d::Zero();
    for (int i : {0, 1, 2, 3, 4, 5, 6, 7}) {
      if (i >= first_below && i <= 6) continue;
      const Link& link = model.tree.links[i];
      force -= link.mass * gravity;
      moment -= link.mass *
                (posture.T_ref_link[i] * link.com - T_ref_sensor.translation()).cross(gravity);
    }
    Vector6d measured;
    measured << T_ref_sensor.linear().transpose() * force,
        T_ref_sensor.linear().transpose() * moment;
    const Vector6d load = LoadFromWrench(model, posture, sensor, measured, gravity);
    EXPECT_LT((load - LoadFromStatics(model, posture, gravity)).norm(), 1e-10) << sensor;
  }
  EXPECT_THROW(LoadFromWrench(model, posture, 7, Vector6d::Zero(), gravity), std::invalid_argument);
}

TEST(LegLoad, BendsTheRootLinkAsStaticsSays) {
  ErrorModel model = Humanoid(3.0);
  model = MakeErrorModel(model.tree, {}, {},
                         {.torsion = {0}, .root_bending = {0, 6}, .legs = {{"leg", 8}}});
  const Geometry geometry = Nominal(model);
  const Vector3d gravity(0.3, -0.2, -9.8);
  const JointLoads statics = GravityLoads(model, geometry, BentKnee(), gravity, 8);
  EXPECT_GT(statics.about_root.col(0).norm(), 10.0);
  MeasuredLoads measured;
  measured.torques = Eigen::VectorXd::Constant(7, NAN);
  measured.torques.head<6>() =
      StandingTorques(model, PlaceLeg(model, geometry, BentKnee(), 0), gravity);
  for (LoadSource source : {LoadSource::kStatics, LoadSource::kTorques}) {
    const PostureLoads loads =
        LoadPosture(model, geometry, BentKnee(), 0, measured, gravity, {.source = source});
    EXPECT_LT((loads.joints.about_root - statics.about_root).norm(), 1e-10);
  }
  // A motion loads the standing leg more than its weight does, and bends the root link more.
  measured.torques *= 1.5;
  const PostureLoads more = LoadPosture(model, geometry, BentKnee(), 0, measured, gravity, {});
  EXPECT_GT((more.joints.about_root.col(0) - statics.about_root.col(0)).norm(), 1.0);
  EXPECT_EQ(more.joints.about_root.col(6), statics.about_root.col(6));
}

TEST(LegLoad, AStraightLegIsFlagged) {
  const ErrorModel model = Humanoid(0.0);
  const auto condition = [&](double knee, LegLoadStatus status) {
    Eigen::VectorXd q = Eigen::VectorXd::Zero(7);
    q[2] = -std::atan2(0.325 * std::sin(knee), 0.38 + 0.325 * std::cos(knee));
    q[3] = knee;
    q[4] = -q[2] - knee;
    const LegLoad load =
        LoadFromTorques(PlaceLeg(model, Nominal(model), q, 0), Eigen::VectorXd::Ones(6));
    EXPECT_EQ(load.status, status) << knee;
    EXPECT_TRUE(load.wrench.allFinite());
    return load.condition;
  };
  EXPECT_NEAR(condition(2.0, LegLoadStatus::kReliable), 8.6, 0.1);
  EXPECT_NEAR(condition(0.86, LegLoadStatus::kReliable), 17.2, 0.1);
  EXPECT_NEAR(condition(0.1, LegLoadStatus::kBadlyConditioned), 145, 1);
  EXPECT_TRUE(std::isinf(condition(0.0, LegLoadStatus::kBadlyConditioned)));
}

TEST(LegLoad, AMissingTorqueMakesItIncomplete) {
  const ErrorModel model = Humanoid(0.0);
  Eigen::VectorXd torques = Eigen::VectorXd::Ones(6);
  torques[2] = NAN;
  const LegLoad load = LoadFromTorques(PlaceLeg(model, Nominal(model), BentKnee(), 0), torques);
  EXPECT_EQ(load.status, LegLoadStatus::kIncomplete);
  EXPECT_TRUE(load.wrench.array().isNaN().all());
  EXPECT_TRUE(load.wrench_by_torque.allFinite());
}

/// The first three rows are the translation, the others the rotation, as in WaistDeflection.
Vector6d Motion(const Transform& from, const Transform& to) {
  Vector6d motion;
  const Eigen::Matrix3d S = (to.linear() - from.linear()) * from.linear().transpose();
  motion << to.translation() - from.translation(), 0.5 * (S(2, 1) - S(1, 2)),
      0.5 * (S(0, 2) - S(2, 0)), 0.5 * (S(1, 0) - S(0, 1));
  return motion;
}

TEST(WaistDeflection, DerivativesAgreeWithDifferences) {
  const ErrorModel model = Humanoid(3.0);
  const Vector3d gravity(1, -2, -9);
  const LegPosture posture = PlaceLeg(model, Nominal(model), BentKnee(), 0);
  const Eigen::VectorXd torques = StandingTorques(model, posture, gravity);
  const LegLoad load = LoadFromTorques(posture, torques);
  Vector6d compliance;
  compliance << 2e-5, 1e-5, 3e-5, 4e-5, 2e-4, 1e-4;
  const WaistDeflection deflection = DeflectWaist(posture.T_foot_waist, compliance, load.wrench);
  const auto at = [&](const Vector6d& c, const Vector6d& wrench) {
    return DeflectWaist(posture.T_foot_waist, c, wrench).T_foot_waist;
  };
  const auto slope = [&](const auto& pose, double step) -> Vector6d {
    const Transform& middle = deflection.T_foot_waist;
    return (Motion(middle, pose(step)) - Motion(middle, pose(-step))) / (2.0 * step);
  };
  for (int i = 0; i < 6; ++i) {
    const Vector6d e = Vector6d::Unit(i);
    const Vector6d by_compliance =
        slope([&](double h) { return at(compliance + h * e, load.wrench); }, 1e-7);
    // A step rotates by 1e-5: relative to the wrench of 700, its square is 1e-10 and rounding over
    // it 1e-11.
    EXPECT_LT((by_compliance - deflection.by_compliance.col(i)).norm(), 1e-9 * 700) << i;
    const Vector6d by_wrench =
        slope([&](double h) { return at(compliance, load.wrench + h * e); }, 0.1);
    EXPECT_LT((by_wrench - deflection.by_wrench.col(i)).norm(), 1e-12) << i;
    const Vector6d by_bias = slope(
        [&](double h) { return at(compliance, LoadFromTorques(posture, torques - h * e).wrench); },
        0.1);
    EXPECT_LT((by_bias + deflection.by_wrench * load.wrench_by_torque.col(i)).norm(), 1e-11) << i;
  }
}

TEST(WaistDeflection, TurnsAboutTheWaistInFootAxes) {
  Vector6d compliance = Vector6d::Zero(), wrench = Vector6d::Zero();
  compliance[4] = 1e-3;
  wrench[4] = 500.0 * M_PI;  // a quarter of a turn about y of the foot
  const Transform T_foot_waist = FromXyzRpy({0.1, 0.2, 0.9}, {0, 0, M_PI / 2});
  const Transform T = DeflectWaist(T_foot_waist, compliance, wrench).T_foot_waist;
  EXPECT_EQ(T.translation(), T_foot_waist.translation());
  // The waist's y is the foot's -x. A turn about y brings x to -z.
  EXPECT_LT((T.linear().col(1) - Vector3d(0, 0, 1)).norm(), 1e-15);
}

}  // namespace
}  // namespace elastocal
