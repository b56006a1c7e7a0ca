// SPDX-License-Identifier: Apache-2.0
// Kinematics and Jacobian of joints and legs that give way under load.
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/robot/jacobian.hpp"
#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

using Eigen::Vector3d;

Eigen::VectorXd Errors(const ErrorModel& model,
                       const std::vector<std::pair<const char*, double>>& values) {
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  for (const auto& [name, value] : values) delta[FindParameter(model.parameters, name)] = value;
  return delta;
}

TEST(ElasticKinematics, TorsionByHandTurnsWithTheLoad) {
  // The elbow turns by a quarter of a turn, with 0.5 rad/(N.m) under pi N.m.
  const ErrorModel model = MakeErrorModel(PlanarArm(), {{"M", 3, {0, 0, 0}}}, {}, {.torsion = {1}});
  const Geometry geometry = ApplyErrors(model, Errors(model, {{"elbow.compliance_z", 0.5}}));
  JointLoads loads = JointLoads::Zero(3, 2);
  loads(2, 0) = 7.0;  // the shoulder is rigid
  loads(2, 1) = M_PI;
  const Eigen::Vector2d q(0, 0);
  EXPECT_LT((MarkerPositions(model, geometry, q, loads).col(0) - Vector3d(0.5, 0.3, 0)).norm(),
            1e-15);
  EXPECT_LT((MarkerPositions(model, geometry, q).col(0) - Vector3d(0.8, 0, 0)).norm(), 1e-15);
}

TEST(ElasticKinematics, BendingByHandTurnsAboutThePhysicalCentre) {
  // The common normal meets the elbow's axis at the height of the shoulder. The URDF origin is 0.2
  // m above.
  RobotTree tree = MakeRoot();
  const int upper = AddJoint(tree, "shoulder", 0, Transform::Identity(), {0, 0, 1});
  const int lower = AddJoint(tree, "elbow", upper, Offset(0.5, 0, 0.2), {0, 0, 1});
  const ErrorModel model = MakeErrorModel(
      tree, {{"M", lower, {0.3, 0, 0}}, {"C", lower, {0, 0, 0}}}, {}, {.bending = {1}});
  // The twisted axes of the elbow have z along its axis and x along the common normal, which is the
  // root's x.
  const Geometry geometry = ApplyErrors(
      model, Errors(model, {{"elbow.compliance_x", 0.1}, {"elbow.compliance_y", 0.25}}));
  JointLoads loads = JointLoads::Zero(3, 2);
  loads(1, 1) = 2.0 * M_PI;  // a quarter of a turn about y turns x downwards
  const Eigen::Matrix3Xd p = MarkerPositions(model, geometry, Eigen::Vector2d::Zero(), loads);
  EXPECT_LT((p.col(0) - Vector3d(0.5, 0, 0.2 - 0.3)).norm(), 1e-15);
  EXPECT_LT((p.col(1) - Vector3d(0.5, 0, 0.2)).norm(), 1e-15);
}

TEST(ElasticKinematics, TheRootLinkTurnsByHandAboutItsOriginAndForOneLimbAlone) {
  RobotTree tree = MakeRoot();
  const int left = AddJoint(tree, "left", 0, Offset(0, 0.1, -0.2), {0, 0, 1});
  const int right = AddJoint(tree, "right", 0, Offset(0, -0.1, -0.2), {0, 0, 1});
  const ErrorModel model = MakeErrorModel(tree, {{"L", left, {0, 0, 0}}, {"R", right, {0, 0, 0}}},
                                          {}, {.root_bending = {0, 1}});
  const Geometry geometry = ApplyErrors(
      model, Errors(model, {{"left.compliance_root_x", 0.25}, {"right.compliance_root_y", 0.25}}));
  JointLoads loads = JointLoads::Zero(3, 2);
  loads.about_root.setZero(3, 2);
  loads.about_root(0, 0) = 2.0 * M_PI;  // a quarter of a turn about x turns y to z and z to -y
  const Eigen::Matrix3Xd p = MarkerPositions(model, geometry, Eigen::Vector2d::Zero(), loads);
  EXPECT_LT((p.col(0) - Vector3d(0, 0.2, 0.1)).norm(), 1e-15);
  EXPECT_LT((p.col(1) - Vector3d(0, -0.1, -0.2)).norm(), 1e-15);
}

TEST(ElasticKinematics, ASlidingJointGivesWayAlongItsAxis) {
  RobotTree tree = MakeRoot();
  AddJoint(tree, "lift", 0, Transform::Identity(), {0, 0, 1}, JointType::kPrismatic);
  const ErrorModel model = MakeErrorModel(tree, {{"M", 1, {0.1, 0, 0}}}, {}, {.torsion = {0}});
  const Geometry geometry = ApplyErrors(model, Errors(model, {{"lift.compliance_z", 1e-3}}));
  const Eigen::Matrix3Xd p =
      MarkerPositions(model, geometry, Eigen::VectorXd::Constant(1, 0.4), Vector3d(50, 60, -20));
  EXPECT_LT((p.col(0) - Vector3d(0.1, 0, 0.38)).norm(), 1e-15);
}

/// A random robot with all parts elastic, two legs, and loads of up to some 100 N.m.
struct ElasticRobot {
  explicit ElasticRobot(int seed) : random(seed) {
    const RobotTree tree = RandomRobot(kUsualRelations, random);
    Elasticity elasticity;
    elasticity.torque_bias = true;
    for (int k = 0; k < static_cast<int>(tree.joints.size()); ++k) {
      if (random.Index(4) > 0) elasticity.torsion.push_back(k);
      const bool revolute = tree.joints[k].type == JointType::kRevolute;
      if (revolute && random.Index(4) > 0) elasticity.bending.push_back(k);
    }
    for (int k = 0; k < static_cast<int>(tree.joints.size()); ++k) {
      const bool on_root = tree.joints[k].parent_body == 0;
      if (on_root && tree.joints[k].type == JointType::kRevolute) {
        elasticity.root_bending.push_back(k);
      }
    }
    for (const char* name : {"left", "right"}) {
      int link = 0;
      while (tree.links[link].body == 0) link = random.Index(static_cast<int>(tree.links.size()));
      elasticity.legs.push_back({name, link});
    }
    model = MakeErrorModel(tree, RandomMarkers(tree, random), {}, elasticity);
    model.T_ref_waist = RandomTransform(random);
    loads = random.NormalVector(3 * static_cast<int>(tree.joints.size()), 50.0)
                .reshaped(3, tree.joints.size());
    loads.about_root = -2.0 * Eigen::Matrix3Xd(loads.colwise().reverse());
    delta = random.NormalVector(model.parameter_count(), 0.05);
    for (int i = 0; i < delta.size(); ++i) {
      if (IsCompliance(model.parameters[i].kind)) delta[i] = random.Uniform(0.0, 1e-4);
    }
    q = RandomPosture(tree, random);
  }
  Random random;
  ErrorModel model;
  JointLoads loads;
  Eigen::VectorXd delta, q;
};

/// Pose of a body with the elastic rotation of the formula: on the joint's fixed side, about the
/// origin of the calibrated URDF joint.
Transform BodyByTheFormula(const ElasticRobot& robot, const std::vector<Transform>& rigid,
                           int body) {
  if (body == 0) return rigid[0];
  const int k = body - 1;
  const Joint& joint = robot.model.tree.joints[k];
  const Transform T_parent_body = rigid[joint.parent_body].inverse() * rigid[body];
  Transform T_ref_parent = BodyByTheFormula(robot, rigid, joint.parent_body);
  Vector3d c = Vector3d::Zero();
  Vector3d c_root = Vector3d::Zero();
  double theta = robot.model.placements[k].theta;
  for (int i = 0; i < robot.delta.size(); ++i) {
    const Parameter& p = robot.model.parameters[i];
    if (p.joint != k) continue;
    if (IsCompliance(p.kind)) (p.axis < kRootAxis ? c : c_root)[p.axis % 3] = robot.delta[i];
    if (p.kind == ParameterKind::kTheta) theta += robot.delta[i];
  }
  T_ref_parent.rotate(RotationFromVector(c_root.cwiseProduct(robot.loads.about_root.col(k))));
  const Transform T_ref_rigid = T_ref_parent * T_parent_body;
  const double position = JointPosition(joint, robot.q);
  const bool revolute = joint.type == JointType::kRevolute;
  const Eigen::Matrix3d R_ref_joint =
      (T_ref_rigid * robot.model.placements[k].T_joint_body.inverse()).linear();
  const Eigen::Matrix3d R_ref_twisted =
      R_ref_joint * RotZ(-theta - (revolute ? position : 0.0)).linear();
  const Vector3d phi = c.cwiseProduct(robot.loads.col(k));
  Transform T_ref_body = T_ref_rigid;
  if (revolute) {
    // The origin of the body's frame is the centre of rotation, so it stays.
    T_ref_body.linear() =
        R_ref_twisted * RotationFromVector(phi) * R_ref_twisted.transpose() * T_ref_rigid.linear();
  } else {
    T_ref_body.translation() += phi.z() * R_ref_twisted.col(2);
  }
  return T_ref_body;
}

class ElasticRandomRobots : public testing::TestWithParam<int> {};

TEST_P(ElasticRandomRobots, BodiesAreWhereTheFormulaPutsThem) {
  const ElasticRobot robot(GetParam());
  const Geometry geometry = ApplyErrors(robot.model, robot.delta);
  const auto rigid = BodyTransforms(robot.model, geometry, robot.q);
  const auto elastic = BodyTransforms(robot.model, geometry, robot.q, robot.loads);
  for (int k : robot.model.active_joints) {
    const Transform expected = BodyByTheFormula(robot, rigid, k + 1);
    // The rotations go there and back along up to nine joints. A wrong centre or axis would change
    // the result by 1e-3.
    EXPECT_LT((elastic[k + 1].matrix() - expected.matrix()).norm(), 1e-10) << k;
  }
}

TEST_P(ElasticRandomRobots, WithoutLoadsOrComplianceTheyAreRigid) {
  ElasticRobot robot(GetParam());
  const Geometry geometry = ApplyErrors(robot.model, robot.delta);
  JointLoads none = JointLoads::Zero(3, robot.loads.cols());
  none.about_root.setZero(3, robot.loads.cols());
  const Eigen::Matrix3Xd rigid = MarkerPositions(robot.model, geometry, robot.q);
  EXPECT_LT((MarkerPositions(robot.model, geometry, robot.q, none) - rigid).norm(), 1e-14);
  for (int i = 0; i < robot.delta.size(); ++i) {
    if (IsCompliance(robot.model.parameters[i].kind)) robot.delta[i] = 0.0;
  }
  EXPECT_EQ(
      MarkerPositions(robot.model, ApplyErrors(robot.model, robot.delta), robot.q, robot.loads),
      rigid);
}

using LoadsOfRootJoints = GeneralizedJacobian::LoadsOfRootJoints;

/// Positions of the markers, then of the feet as four points each. The differences are taken of
/// these.
Eigen::VectorXd Points(const ElasticRobot& robot, const Eigen::VectorXd& delta,
                       LoadsOfRootJoints root_joints) {
  const Geometry geometry = ApplyErrors(robot.model, delta);
  const JointLoads loads =
      root_joints == LoadsOfRootJoints::kConstant
          ? robot.loads
          : TurnedLoads(robot.model, ApplyErrors(robot.model, robot.delta), geometry, robot.loads);
  const Eigen::Matrix3Xd markers = MarkerPositions(robot.model, geometry, robot.q, loads);
  const auto T_ref_link = CalibratedLinkTransforms(robot.model, geometry, robot.q, loads);
  Eigen::VectorXd points(3 * robot.model.marker_count() + 12 * robot.model.leg_count());
  points.head(markers.size()) = markers.reshaped();
  for (int leg = 0; leg < robot.model.leg_count(); ++leg) {
    const Transform& T = T_ref_link[robot.model.legs[leg].link];
    points.segment<12>(markers.size() + 12 * leg) = T.matrix().topRows<3>().reshaped();
  }
  return points;
}

void ExpectDerivatives(const ElasticRobot& robot, LoadsOfRootJoints root_joints) {
  const ErrorModel& model = robot.model;
  GeneralizedJacobian jacobian(model, root_joints);
  jacobian.Evaluate(ApplyErrors(model, robot.delta), robot.q, robot.loads);
  const Eigen::MatrixXd J = jacobian.Dense();
  for (int i = 0; i < model.parameter_count(); ++i) {
    const bool compliance = IsCompliance(model.parameters[i].kind);
    // A step of 2e-7 rad/(N.m) turns a joint by some 2e-5 rad. The differences are of fourth order,
    // because the error of second order is too large for some robots.
    const double step = compliance ? 2e-7 : 1e-5;
    const auto at = [&](double steps) {
      Eigen::VectorXd beside = robot.delta;
      beside[i] += steps * step;
      return Points(robot, beside, root_joints);
    };
    const Eigen::VectorXd slope =
        (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * step);
    const double size = compliance ? robot.loads.lpNorm<Eigen::Infinity>() : 1.0;
    const Eigen::Index rows = 3 * model.marker_count();
    EXPECT_LT((J.col(i) - slope.head(rows)).norm(), 3e-9 * size) << model.parameters[i].name;
    for (int leg = 0; leg < model.leg_count(); ++leg) {
      const std::vector<int>& columns = jacobian.LegColumns(leg);
      const auto column = std::find(columns.begin(), columns.end(), i);
      Vector6d screw = Vector6d::Zero();
      if (column != columns.end()) screw = jacobian.LegScrews(leg).col(column - columns.begin());
      const Transform& T = jacobian.LegPose(leg);
      const Vector3d a = screw.head<3>();
      Eigen::Matrix<double, 3, 4> motion;
      for (int j = 0; j < 3; ++j) motion.col(j) = a.cross(Vector3d(T.linear().col(j)));
      motion.col(3) = a.cross(Vector3d(T.translation())) + screw.tail<3>();
      EXPECT_LT((motion.reshaped() - slope.segment<12>(rows + 12 * leg)).norm(), 3e-9 * size)
          << model.legs[leg].name << ", " << model.parameters[i].name;
    }
  }
}

TEST_P(ElasticRandomRobots, DerivativesAgreeWithDifferences) {
  ExpectDerivatives(ElasticRobot(GetParam()), LoadsOfRootJoints::kConstant);
}

TEST_P(ElasticRandomRobots, DerivativesWhereLoadsTurnWithWhatRootJointsCarry) {
  ExpectDerivatives(ElasticRobot(GetParam()), LoadsOfRootJoints::kTurning);
}

TEST_P(ElasticRandomRobots, LegPosesAreThoseOfTheirLinks) {
  const ElasticRobot robot(GetParam());
  const Geometry geometry = ApplyErrors(robot.model, robot.delta);
  GeneralizedJacobian jacobian(robot.model);
  jacobian.Evaluate(geometry, robot.q, robot.loads);
  const auto T = CalibratedLinkTransforms(robot.model, geometry, robot.q, robot.loads);
  for (int leg = 0; leg < robot.model.leg_count(); ++leg) {
    const Transform& expected = T[robot.model.legs[leg].link];
    EXPECT_LT((jacobian.LegPose(leg).matrix() - expected.matrix()).norm(), 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, ElasticRandomRobots, testing::Range(1, 31));

TEST(ElasticKinematics, DerivativesByComplianceAreThereWhileItIsZero) {
  // The elbow's load lifts the tip by 0.3 m times 10 N.m times the compliance.
  const ErrorModel model = MakeErrorModel(PlanarArm(), {{"M", 3, {0, 0, 0}}}, {}, {.torsion = {1}});
  GeneralizedJacobian jacobian(model);
  JointLoads loads = JointLoads::Zero(3, 2);
  loads(2, 1) = 10.0;
  const Geometry nominal = ApplyErrors(model, Errors(model, {}));
  jacobian.Evaluate(nominal, Eigen::Vector2d::Zero(), loads);
  const int column = FindParameter(model.parameters, "elbow.compliance_z");
  EXPECT_LT((jacobian.Dense().col(column) - Vector3d(0, 3, 0)).norm(), 1e-14);
  jacobian.Evaluate(nominal, Eigen::Vector2d::Zero());
  EXPECT_TRUE(jacobian.Dense().col(column).isZero(0.0));
}

}  // namespace
}  // namespace elastocal
