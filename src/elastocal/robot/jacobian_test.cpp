// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/jacobian.hpp"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

/// Central differences of all marker positions, 3 N_M x parameters.
Eigen::MatrixXd Differences(const ErrorModel& model, const Eigen::VectorXd& delta,
                            const Eigen::VectorXd& q) {
  // Lengths are about a metre and angles about a radian. Truncation (the step's third power, 1e-15)
  // and rounding (1e-15), both over the step, leave 1e-10.
  const double step = 1e-5;
  Eigen::MatrixXd J(3 * model.marker_count(), model.parameter_count());
  for (int i = 0; i < model.parameter_count(); ++i) {
    Eigen::VectorXd forward = delta, backward = delta;
    forward[i] += step;
    backward[i] -= step;
    J.col(i) = (MarkerPositions(model, ApplyErrors(model, forward), q) -
                MarkerPositions(model, ApplyErrors(model, backward), q))
                   .reshaped() /
               (2.0 * step);
  }
  return J;
}

/// Compares column by column, relative to the norm of each.
void ExpectDerivatives(const ErrorModel& model, const Eigen::VectorXd& delta,
                       const Eigen::VectorXd& q) {
  GeneralizedJacobian jacobian(model);
  jacobian.Evaluate(ApplyErrors(model, delta), q);
  const Eigen::MatrixXd J = jacobian.Dense();
  const Eigen::MatrixXd expected = Differences(model, delta, q);
  for (int i = 0; i < model.parameter_count(); ++i) {
    EXPECT_LT((J.col(i) - expected.col(i)).norm(), 1e-7 * expected.col(i).norm())
        << model.parameters[i].name;
  }
}

class JacobianOfRandomRobots : public testing::TestWithParam<int> {};

TEST_P(JacobianOfRandomRobots, AgreesWithDifferencesAtNominalAndAway) {
  Random random(GetParam());
  const RobotTree tree = RandomRobot(kUsualRelations, random);
  ErrorModel model = MakeErrorModel(tree, RandomMarkers(tree, random));
  model.T_ref_waist = RandomTransform(random);
  const Eigen::VectorXd nominal = Eigen::VectorXd::Zero(model.parameter_count());
  ExpectDerivatives(model, nominal, RandomPosture(tree, random));
  for (int i = 0; i < 3; ++i) {
    const Eigen::VectorXd delta = random.NormalVector(model.parameter_count(), 0.1);
    ExpectDerivatives(model, delta, RandomPosture(tree, random));
  }
}

TEST_P(JacobianOfRandomRobots, BlocksColumnsAndDenseAreOne) {
  Random random(GetParam());
  const RobotTree tree = RandomRobot(kUsualRelations, random);
  const ErrorModel model = MakeErrorModel(tree, RandomMarkers(tree, random));
  const Geometry geometry = ApplyErrors(model, random.NormalVector(model.parameter_count(), 0.1));
  GeneralizedJacobian jacobian(model);
  const Eigen::VectorXd q = RandomPosture(tree, random);
  jacobian.Evaluate(geometry, q);
  const Eigen::Matrix3Xd positions = MarkerPositions(model, geometry, q);

  const Eigen::MatrixXd J = jacobian.Dense();
  for (int m = 0; m < model.marker_count(); ++m) {
    // The operations are the same in another order, with lengths of metres.
    EXPECT_LT((jacobian.Position(m) - positions.col(m)).norm(), 1e-13);
    // The marker depends on T0, on the joints on the way to it, and on its own position.
    std::set<int> carriers;
    for (int k : JointsToBody(tree, tree.links[model.markers[m].link].body)) carriers.insert(k);
    std::vector<int> columns;
    for (int i = 0; i < model.parameter_count(); ++i) {
      const Parameter& p = model.parameters[i];
      const bool moves =
          p.kind == ParameterKind::kWaistPose || p.marker == m || carriers.contains(p.joint);
      if (moves) {
        columns.push_back(i);
      } else {
        EXPECT_TRUE(J.block(3 * m, i, 3, 1).isZero(0.0)) << p.name;
      }
    }
    EXPECT_EQ(jacobian.Columns(m), columns);
    EXPECT_EQ(Eigen::MatrixXd(jacobian.Block(m)), J(Eigen::seqN(3 * m, 3), columns));
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, JacobianOfRandomRobots, testing::Range(1, 41));

TEST(Jacobian, EveryKindOfColumnIsAmongTheRandomRobots) {
  std::set<std::string> kinds;
  for (int seed = 1; seed < 41; ++seed) {
    Random random(seed);
    const RobotTree tree = RandomRobot(kUsualRelations, random);
    for (const Parameter& p : MakeErrorModel(tree, RandomMarkers(tree, random)).parameters) {
      const bool slides = p.joint >= 0 && tree.joints[p.joint].type == JointType::kPrismatic;
      kinds.insert(std::string(KindName(p.kind)) + (slides ? " of a sliding joint" : ""));
    }
  }
  EXPECT_EQ(kinds.size(), 9u + 7u);
}

TEST(Jacobian, TalosLegAndRailArm) {
  Random random(1);
  const RobotTree arm = RailArm();
  const ErrorModel rail_arm =
      MakeErrorModel(arm, {{"A", FindLink(arm, "flange"), {0.1, 0, 0}},
                           {"B", FindLink(arm, "finger_1_link"), {0, 0, 0.1}},
                           {"C", FindLink(arm, "finger_2_link"), {0, 0, 0.1}}});
  for (const ErrorModel& model : {TalosLegModel(), rail_arm}) {
    for (int i = 0; i < 20; ++i) {
      const Eigen::VectorXd delta = random.NormalVector(model.parameter_count(), 0.01);
      ExpectDerivatives(model, delta, RandomPosture(model.tree, random));
    }
  }
}

TEST(Jacobian, PlanarArmByHand) {
  // The upper arm is along x and the forearm along y, so the tip is at (0.5, 0.3).
  const ErrorModel model = MakeErrorModel(PlanarArm(), {{"M", 3, {0, 0, 0}}});
  GeneralizedJacobian jacobian(model);
  jacobian.Evaluate(ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count())),
                    Eigen::Vector2d(0, M_PI / 2));
  const auto column = [&](const char* name) {
    return Eigen::Vector3d(jacobian.Dense().col(FindParameter(model.parameters, name)));
  };
  EXPECT_LT((column("shoulder.theta") - Eigen::Vector3d(-0.3, 0.5, 0)).norm(), 1e-15);
  EXPECT_LT((column("elbow.theta") - Eigen::Vector3d(-0.3, 0, 0)).norm(), 1e-15);
  EXPECT_LT((column("elbow.alpha") - Eigen::Vector3d(0, 0, 0.3)).norm(), 1e-15);
  EXPECT_LT((column("elbow.beta") - Eigen::Vector3d(0, 0, -0.5)).norm(), 1e-15);
  EXPECT_LT((column("elbow.d") - Eigen::Vector3d(1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((column("elbow.r") - Eigen::Vector3d(0, 0, 1)).norm(), 1e-15);
  EXPECT_LT((column("marker.M.x") - Eigen::Vector3d(0, 1, 0)).norm(), 1e-15);
}

TEST(Jacobian, ASubsetOfChainsGivesTheSameBlocks) {
  Random random(5);
  const RobotTree tree = RandomRobot(kUsualRelations, random);
  const ErrorModel whole = MakeErrorModel(tree, RandomMarkers(tree, random));
  const Eigen::VectorXd q = RandomPosture(tree, random);
  const Eigen::VectorXd delta = random.NormalVector(whole.parameter_count(), 0.1);
  GeneralizedJacobian jacobian(whole);
  jacobian.Evaluate(ApplyErrors(whole, delta), q);
  for (int m = 0; m < whole.marker_count(); ++m) {
    const ErrorModel part = SelectMarkers(whole, {whole.markers[m].name});
    Eigen::VectorXd part_delta(part.parameter_count());
    for (int i = 0; i < part.parameter_count(); ++i) {
      part_delta[i] = delta[FindParameter(whole.parameters, part.parameters[i].name)];
    }
    GeneralizedJacobian part_jacobian(part);
    part_jacobian.Evaluate(ApplyErrors(part, part_delta), q);
    EXPECT_EQ(part_jacobian.Position(0), jacobian.Position(m));
    EXPECT_EQ(part_jacobian.Block(0), jacobian.Block(m));
    for (std::size_t i = 0; i < part_jacobian.Columns(0).size(); ++i) {
      EXPECT_EQ(part.parameters[part_jacobian.Columns(0)[i]].name,
                whole.parameters[jacobian.Columns(m)[i]].name);
    }
  }
}

}  // namespace
}  // namespace elastocal
