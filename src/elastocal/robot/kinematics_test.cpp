// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/kinematics.hpp"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

// Accumulated rounding along up to nine joints, some with common normals of 10 m.
constexpr double kKinematicsRounding = 1e-13;

/// Value of the error called `name`; zero where the model has none.
double Error(const ErrorModel& model, const Eigen::VectorXd& delta, const std::string& name) {
  for (int i = 0; i < model.parameter_count(); ++i) {
    if (model.parameters[i].name == name) return delta[i];
  }
  return 0.0;
}

/// Pose of a body by eq. 1 to 3 as they are printed, with errors taken by their names.
Transform BodyByTheFormulas(const ErrorModel& model, const Eigen::VectorXd& delta,
                            const Eigen::VectorXd& q, int body) {
  if (body == 0) {
    const auto e = [&](const char* name) {
      return Error(model, delta, "waist.T0." + std::string(name));
    };
    return model.T_ref_waist * RotZ(e("gamma")) * TrZ(e("b")) * RotX(M_PI / 2 + e("alpha")) *
           TrX(e("d")) * RotZ(e("theta")) * TrZ(e("r")) * RotX(-M_PI / 2);
  }
  const Joint& joint = model.tree.joints[body - 1];
  const JointPlacement& p = model.placements[body - 1];
  const auto e = [&](const char* name) { return Error(model, delta, joint.name + "." + name); };
  const double position = JointPosition(joint, q);
  const double angle = joint.type == JointType::kRevolute ? position : 0.0;
  // The parent's MDH frame is reached from its body frame by the inverse of T_joint_body.
  Transform T = BodyByTheFormulas(model, delta, q, joint.parent_body);
  if (joint.parent_body > 0) {
    T = T * model.placements[joint.parent_body - 1].T_joint_body.inverse();
  }
  return T * p.T_parent_pre * RotZ(p.gamma + e("gamma")) * TrZ(p.b + e("b")) *
         RotY(p.beta + e("beta")) * RotX(p.alpha + e("alpha")) * TrX(p.d + e("d")) *
         RotZ(p.theta + e("theta") + angle) * TrZ(p.r + e("r") + position - angle) * p.T_joint_body;
}

Eigen::Vector3d MarkerByTheFormulas(const ErrorModel& model, const Eigen::VectorXd& delta,
                                    const Eigen::VectorXd& q, const Marker& marker) {
  const Link& link = model.tree.links[marker.link];
  const auto e = [&](const char* xyz) {
    return Error(model, delta, "marker." + marker.name + "." + xyz);
  };
  const Eigen::Vector3d p = marker.p_link_marker + Eigen::Vector3d(e("x"), e("y"), e("z"));
  return BodyByTheFormulas(model, delta, q, link.body) * link.T_body_link * p;
}

/// A random robot at a random place, with an error for each of its parameters.
struct RandomModel {
  explicit RandomModel(int seed) : random(seed) {
    const RobotTree tree = RandomRobot(kUsualRelations, random);
    model = MakeErrorModel(tree, RandomMarkers(tree, random));
    model.T_ref_waist = RandomTransform(random);
    delta = random.NormalVector(model.parameter_count(), 0.05);
  }
  Random random;
  ErrorModel model;
  Eigen::VectorXd delta;
};

TEST(Kinematics, PlanarArmByHand) {
  const ErrorModel model = MakeErrorModel(PlanarArm(), {{"M", 3, {0, 0, 0}}});
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  delta[FindParameter(model.parameters, "elbow.theta")] = M_PI / 2;
  delta[FindParameter(model.parameters, "elbow.d")] = 0.1;
  delta[FindParameter(model.parameters, "elbow.r")] = 0.02;
  delta[FindParameter(model.parameters, "marker.M.y")] = 0.03;
  const Eigen::Matrix3Xd p =
      MarkerPositions(model, ApplyErrors(model, delta), Eigen::Vector2d::Zero());
  EXPECT_LT((p.col(0) - Eigen::Vector3d(0.6 - 0.03, 0.3, 0.02)).norm(), kKinematicsRounding);
}

TEST(Kinematics, WaistErrorsAreSixIndependentDisplacements) {
  // Gamma and b turn about and move along z, alpha and d along x, theta and r along the
  // intermediate z, which is -y of the waist.
  const ErrorModel model = MakeErrorModel(MakeRoot(), {{"M", 0, {0.1, 0.2, 0.3}}});
  const double e = 1e-6;
  const Eigen::Vector3d p(0.1, 0.2, 0.3), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const Eigen::Vector3d displacements[] = {z.cross(p), z, x.cross(p), x, -y.cross(p), -y};
  for (int i = 0; i < 6; ++i) {
    Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
    delta[i] = e;
    const Eigen::Vector3d moved =
        MarkerPositions(model, ApplyErrors(model, delta), Eigen::VectorXd());
    // The remainder is of second order, e^2 = 1e-12.
    EXPECT_LT((moved - p - e * displacements[i]).norm(), 1e-12) << model.parameters[i].name;
  }
}

class KinematicsOfRandomRobots : public testing::TestWithParam<int> {};

TEST_P(KinematicsOfRandomRobots, NominalPositionsAreTheUrdfs) {
  RandomModel m(GetParam());
  const Geometry nominal = ApplyErrors(m.model, Eigen::VectorXd::Zero(m.delta.size()));
  for (int i = 0; i < 10; ++i) {
    const Eigen::VectorXd q = RandomPosture(m.model.tree, m.random);
    const std::vector<Transform> T_root_link = LinkTransforms(m.model.tree, q);
    const Eigen::Matrix3Xd positions = MarkerPositions(m.model, nominal, q);
    for (int k = 0; k < m.model.marker_count(); ++k) {
      const Marker& marker = m.model.markers[k];
      const Eigen::Vector3d expected =
          m.model.T_ref_waist * T_root_link[marker.link] * marker.p_link_marker;
      EXPECT_LT((positions.col(k) - expected).norm(), kKinematicsRounding) << marker.name;
    }
  }
}

TEST_P(KinematicsOfRandomRobots, ErrorsGoWhereTheFormulasPutThem) {
  RandomModel m(GetParam());
  const Geometry geometry = ApplyErrors(m.model, m.delta);
  const Eigen::VectorXd q = RandomPosture(m.model.tree, m.random);
  const Eigen::Matrix3Xd positions = MarkerPositions(m.model, geometry, q);
  for (int k = 0; k < m.model.marker_count(); ++k) {
    const Eigen::Vector3d expected = MarkerByTheFormulas(m.model, m.delta, q, m.model.markers[k]);
    EXPECT_LT((positions.col(k) - expected).norm(), kKinematicsRounding) << m.model.markers[k].name;
  }
  const std::vector<Transform> T_ref_body = BodyTransforms(m.model, geometry, q);
  ASSERT_EQ(static_cast<int>(T_ref_body.size()), m.model.tree.body_count());
  for (int body = 0; body < m.model.tree.body_count(); ++body) {
    const Transform expected = BodyByTheFormulas(m.model, m.delta, q, body);
    EXPECT_LT((T_ref_body[body].matrix() - expected.matrix()).norm(), kKinematicsRounding) << body;
  }
}

TEST_P(KinematicsOfRandomRobots, LinksOffTheChainsAreCarriedAtTheirPositions) {
  // A model with a marker on one body alone still places all other links.
  RandomModel m(GetParam());
  const ErrorModel part =
      MakeErrorModel(m.model.tree, {{"M", m.random.Index(m.model.tree.body_count()), {0, 0, 0}}});
  const Eigen::VectorXd nominal = Eigen::VectorXd::Zero(part.parameter_count());
  const Eigen::VectorXd q = RandomPosture(part.tree, m.random);
  const auto T = CalibratedLinkTransforms(part, ApplyErrors(part, nominal), q);
  const auto expected = LinkTransforms(part.tree, q);
  ASSERT_EQ(T.size(), expected.size());
  for (std::size_t i = 0; i < T.size(); ++i) {
    EXPECT_LT((T[i].matrix() - expected[i].matrix()).norm(), kKinematicsRounding) << i;
  }
}

TEST_P(KinematicsOfRandomRobots, PlaceWaistIsWhatApplyErrorsDoes) {
  RandomModel m(GetParam());
  const Eigen::VectorXd q = RandomPosture(m.model.tree, m.random);
  const Eigen::Matrix3Xd expected = MarkerPositions(m.model, ApplyErrors(m.model, m.delta), q);
  Eigen::VectorXd elsewhere = m.delta;
  elsewhere.head<6>() = m.random.NormalVector(6, 1.0);
  Geometry geometry = ApplyErrors(m.model, elsewhere);
  PlaceWaist(m.model.T_ref_waist, m.delta.head<6>(), geometry);
  EXPECT_EQ(MarkerPositions(m.model, geometry, q), expected);
}

INSTANTIATE_TEST_SUITE_P(Seeds, KinematicsOfRandomRobots, testing::Range(1, 31));

TEST(Kinematics, MimicJointsMoveWithTheirLeader) {
  RobotTree tree = RailArm();
  const ErrorModel model =
      MakeErrorModel(tree, {{"F", FindLink(tree, "finger_2_link"), {0, 0, 0}}});
  const Geometry nominal = ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
  Random random(1);
  const Eigen::VectorXd q = RandomPosture(tree, random);
  const Transform expected = LinkTransforms(tree, q)[FindLink(tree, "finger_2_link")];
  EXPECT_LT((MarkerPositions(model, nominal, q).col(0) - expected.translation()).norm(),
            kKinematicsRounding);
}

TEST(Kinematics, BodiesOffTheChainsAreIdentity) {
  const ErrorModel model = MakeErrorModel(TalosLeg(), {{"M", 2, {0, 0, 0}}});
  const Geometry nominal = ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
  const std::vector<Transform> T = BodyTransforms(model, nominal, Eigen::VectorXd::Ones(6));
  EXPECT_FALSE(T[2].matrix().isIdentity(0.1));
  EXPECT_TRUE(T[3].matrix().isIdentity(0.0));
}

}  // namespace
}  // namespace elastocal
