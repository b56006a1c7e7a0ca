// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/corrections.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/robot/jacobian.hpp"
#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

Eigen::VectorXd Shapes(const RobotTree& tree, const std::vector<Correction>& corrections,
                       const Eigen::VectorXd& q, double load, const PostureHistory& history) {
  const auto joints = static_cast<Eigen::Index>(tree.joints.size());
  return EvaluateShapes(tree, corrections, q, Eigen::VectorXd::Constant(joints, load), history);
}

TEST(Corrections, ShapesHaveTheirHandValues) {
  RobotTree tree = PlanarArm();
  for (Joint& joint : tree.joints) {
    joint.limits = {-1.0, 2.0, 1.0, 10.0};
  }
  const std::vector<Correction> all = PossibleCorrections(tree, 100.0);
  const Eigen::VectorXd q = Eigen::Vector2d(0.3, 0.7);
  PostureHistory history;
  history.approach = Eigen::Vector2d(1.0, -1.0);
  history.hours = 101.5;
  history.root_moment = {5.0, -7.0, 0.0};
  const Eigen::VectorXd shapes = Shapes(tree, all, q, -4.0, history);
  const auto of = [&](const std::string& name) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].name == name) return shapes[static_cast<Eigen::Index>(i)];
    }
    ADD_FAILURE() << name;
    return 0.0;
  };
  EXPECT_DOUBLE_EQ(of("elbow.eccentricity_sin"), std::sin(0.7));
  EXPECT_DOUBLE_EQ(of("elbow.ellipticity_cos"), std::cos(1.4));
  EXPECT_DOUBLE_EQ(of("shoulder.gear"), 0.3 - 0.5);
  EXPECT_DOUBLE_EQ(of("shoulder.coupling_elbow"), 0.7 - 0.5);
  EXPECT_DOUBLE_EQ(of("elbow.hysteresis"), -1.0);
  EXPECT_NEAR(of("elbow.backlash"), -1.0, 1e-12);  // far above a fiftieth of the effort
  EXPECT_DOUBLE_EQ(of("elbow.stiffening"), -0.16);
  EXPECT_DOUBLE_EQ(of("waist.suspension_rx"), 5.0);
  EXPECT_DOUBLE_EQ(of("waist.suspension_x"), -7.0);
  EXPECT_DOUBLE_EQ(of("waist.drift_y"), 1.5);
}

TEST(Corrections, DriftNeedsTimesAndMimicJointsHaveNone) {
  RobotTree tree = PlanarArm();
  MakeLastJointMimic(tree, 0, 2.0, 0.1);
  for (const Correction& correction : PossibleCorrections(tree, std::nullopt)) {
    EXPECT_NE(correction.shape, CorrectionShape::kHours) << correction.name;
    EXPECT_NE(correction.joint, 1) << correction.name;
  }
}

// A gear that turns by a hundredth less than its encoder says.
TEST(Corrections, AGearTurnsTheJointByItsShare) {
  RobotTree tree = PlanarArm();
  for (Joint& joint : tree.joints) joint.limits = {-1.0, 1.0, 1.0, 10.0};
  Elasticity elasticity;
  elasticity.corrections = CorrectionsOf(PossibleCorrections(tree, std::nullopt), {"elbow.gear"});
  const ErrorModel model =
      MakeErrorModel(tree, {{"M", FindLink(tree, "tip"), Eigen::Vector3d::Zero()}}, {}, elasticity);
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  delta[FindParameter(model.parameters, "elbow.gear")] = -0.01;
  JointLoads loads = JointLoads::Zero(3, 2);
  const Eigen::Vector2d q(0.0, 0.8);
  loads.shapes = Shapes(tree, elasticity.corrections, q, 0.0, {});
  const Eigen::Vector3d found = MarkerPositions(model, ApplyErrors(model, delta), q, loads);
  const double turned = 0.99 * 0.8;
  EXPECT_LT(
      (found - Eigen::Vector3d(0.5 + 0.3 * std::cos(turned), 0.3 * std::sin(turned), 0.0)).norm(),
      1e-15);
}

class CorrectionsOfRandomRobots : public testing::TestWithParam<int> {};

// All columns, those of the root link's displacement too, on robots that are bent and corrected.
TEST_P(CorrectionsOfRandomRobots, ColumnsAgreeWithDifferences) {
  Random random(GetParam());
  const RobotTree tree = RandomRobot(kUsualRelations, random);
  Elasticity elasticity;
  elasticity.corrections = PossibleCorrections(tree, 0.0);
  for (int k = 0; k < static_cast<int>(tree.joints.size()); ++k) elasticity.torsion.push_back(k);
  ErrorModel model = MakeErrorModel(tree, RandomMarkers(tree, random), {}, elasticity);
  model.T_ref_waist = RandomTransform(random);
  const Eigen::VectorXd delta = random.NormalVector(model.parameter_count(), 0.03);
  const Eigen::VectorXd q = RandomPosture(tree, random);
  JointLoads loads = JointLoads::Zero(3, static_cast<Eigen::Index>(tree.joints.size()));
  loads.shapes = random.NormalVector(static_cast<Eigen::Index>(elasticity.corrections.size()), 1.0);
  for (double& load : loads.reshaped()) load = random.Normal(0.3);
  GeneralizedJacobian jacobian(model);
  jacobian.Evaluate(ApplyErrors(model, delta), q, loads);
  const Eigen::MatrixXd J = jacobian.Dense();
  const double step = 1e-5;  // leaves 1e-10, see jacobian_test.cpp
  int corrections = 0;
  for (int i = 0; i < model.parameter_count(); ++i) {
    Eigen::VectorXd forward = delta, backward = delta;
    forward[i] += step;
    backward[i] -= step;
    const Eigen::VectorXd expected =
        (MarkerPositions(model, ApplyErrors(model, forward), q, loads) -
         MarkerPositions(model, ApplyErrors(model, backward), q, loads))
            .reshaped() /
        (2.0 * step);
    EXPECT_LT((J.col(i) - expected).norm(), 1e-7 * (expected.norm() + 1e-3))
        << model.parameters[i].name;
    corrections += model.parameters[i].kind == ParameterKind::kCorrection ? 1 : 0;
  }
  EXPECT_GT(corrections, 6);
}

INSTANTIATE_TEST_SUITE_P(Seeds, CorrectionsOfRandomRobots, testing::Range(1, 6));

}  // namespace
}  // namespace elastocal
