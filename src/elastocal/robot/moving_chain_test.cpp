// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/moving_chain.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/robot/collision.hpp"
#include "tests/random_robot.hpp"

namespace elastocal {
namespace {

constexpr double kStep = 1e-6;
// Central differences of smooth functions of order one (m, rad) have 1e-12 of truncation and 1e-10
// of rounding. Torques reach 100 N.m.
constexpr double kNear = 1e-8, kNearTorque = 1e-6;

/// A random robot with masses, one joint of which follows another.
RobotTree LoadedRobot(Random& random) {
  RobotTree tree = RandomRobot(kUsualRelations, random);
  const int last = static_cast<int>(tree.links.size()) - 1;
  AddJoint(tree, "follower", last, Offset(0.1, 0.2, -0.1), {0.3, 0.5, 0.8});
  MakeLastJointMimic(tree, 0, -0.7, 0.2);
  for (Link& link : tree.links) {
    link.mass = random.Uniform(0.5, 5.0);
    link.com = random.NormalVector(3, 0.1);
  }
  return tree;
}

class MovingChainOfRandomRobot : public testing::TestWithParam<int> {
 protected:
  MovingChainOfRandomRobot()
      : random_(static_cast<std::uint64_t>(GetParam())),
        tree_(LoadedRobot(random_)),
        tip_(static_cast<int>(tree_.links.size()) - 1),
        chain_(tree_, ChainCoordinates(tree_, 0, tip_), RandomPosture(tree_, random_)),
        x_(RandomPosture(tree_, random_)(chain_.coordinates())) {}

  Random random_;
  RobotTree tree_;
  int tip_;
  MovingChain chain_;
  Eigen::VectorXd x_;
};

TEST_P(MovingChainOfRandomRobot, DerivativesEqualDifferences) {
  const Eigen::Vector3d p_tip(0.1, -0.2, 0.3);
  chain_.Move(x_);
  const Transform T = chain_.link_poses()[tip_];
  const Eigen::Matrix3Xd J = chain_.PointJacobian(tip_, T * p_tip);
  const Eigen::Matrix3Xd J_turn = chain_.RotationJacobian(tip_);
  std::vector<Eigen::RowVectorXd> torque_gradients;
  for (int c = 0; c < tree_.coordinate_count(); ++c) {
    torque_gradients.push_back(chain_.GravityTorqueGradient(c));
  }
  for (int i = 0; i < chain_.size(); ++i) {
    std::vector<double> torques[2];
    Transform poses[2];
    for (int side : {0, 1}) {
      Eigen::VectorXd x = x_;
      x[i] += side == 0 ? -kStep : kStep;
      chain_.Move(x);
      poses[side] = chain_.link_poses()[tip_];
      for (int c = 0; c < tree_.coordinate_count(); ++c) {
        torques[side].push_back(chain_.GravityTorque(c));
      }
    }
    EXPECT_LT((J.col(i) - (poses[1] * p_tip - poses[0] * p_tip) / (2 * kStep)).norm(), kNear);
    const Eigen::Matrix3d turn = poses[1].linear() * poses[0].linear().transpose();
    const Eigen::Vector3d w =
        Eigen::Vector3d(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1)) /
        (4 * kStep);
    EXPECT_LT((J_turn.col(i) - w).norm(), kNear);
    for (int c = 0; c < tree_.coordinate_count(); ++c) {
      EXPECT_NEAR(
          torque_gradients[static_cast<std::size_t>(c)][i],
          (torques[1][static_cast<std::size_t>(c)] - torques[0][static_cast<std::size_t>(c)]) /
              (2 * kStep),
          kNearTorque);
    }
  }
}

TEST_P(MovingChainOfRandomRobot, TorquesAreThoseOfStatics) {
  chain_.Move(x_);
  const Eigen::VectorXd expected = GravityTorques(tree_, chain_.FullPosture(x_));
  for (int c = 0; c < tree_.coordinate_count(); ++c) {
    EXPECT_NEAR(chain_.GravityTorque(c), expected[c], 1e-11);
  }
}

TEST_P(MovingChainOfRandomRobot, LoadGradientEqualsDifferences) {
  const Eigen::Vector3d gravity(1.0, -2.0, -9.0), point(0.1, 0.2, -0.3), direction(0.5, -0.7, 0.4);
  // One component for each joint, fixed to the link before it, and one for the whole robot.
  const auto components = [&] {
    std::vector<LoadComponent> all = {{-1, point, direction}};
    for (std::size_t k = 0; k < tree_.joints.size(); ++k) {
      const Transform& T =
          chain_.link_poses()[static_cast<std::size_t>(tree_.joints[k].parent_link)];
      all.push_back({static_cast<int>(k), T * point, T.linear() * direction});
    }
    return all;
  };
  const auto sum = [&](const Eigen::VectorXd& x) {
    chain_.Move(x);
    const std::vector<CarriedLoad> carried = CarriedLoads(tree_, chain_.link_poses(), 0);
    CarriedLoad whole;
    for (std::size_t i = 0; i < tree_.links.size(); ++i) {
      whole.mass += tree_.links[i].mass;
      whole.moment += tree_.links[i].mass * (chain_.link_poses()[i] * tree_.links[i].com);
    }
    double value = 0.0;
    for (const LoadComponent& c : components()) {
      const CarriedLoad& load = c.joint < 0 ? whole : carried[static_cast<std::size_t>(c.joint)];
      const bool slides = c.joint >= 0 && tree_.joints[static_cast<std::size_t>(c.joint)].type ==
                                              JointType::kPrismatic;
      value += slides ? load.mass * c.direction.dot(gravity)
                      : c.direction.dot((load.moment - load.mass * c.point).cross(gravity));
    }
    return value;
  };
  chain_.Move(x_);
  const Eigen::VectorXd gradient = chain_.LoadGradient(components(), gravity);
  for (int i = 0; i < chain_.size(); ++i) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(chain_.size(), i);
    EXPECT_NEAR(gradient[i], (sum(x_ + step) - sum(x_ - step)) / (2 * kStep), kNearTorque);
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, MovingChainOfRandomRobot, testing::Range(1, 9));

TEST(ChainCoordinates, CountsAFollowerOnceAndLeavesOutWhatIsBefore) {
  RobotTree tree = MakeRoot();
  const int first = AddJoint(tree, "a", 0, Offset(0, 0, 1), {0, 0, 1});
  const int second = AddJoint(tree, "b", first, Offset(0, 0, 1), {1, 0, 0});
  const int third = AddJoint(tree, "c", second, Offset(0, 0, 1), {1, 0, 0});
  MakeLastJointMimic(tree, 1, 2.0, 0.0);
  EXPECT_EQ(ChainCoordinates(tree, 0, third), (std::vector<int>{0, 1}));
  EXPECT_EQ(ChainCoordinates(tree, first, third), (std::vector<int>{1}));
}

TEST(SphereDistances, AreBetweenSurfaces) {
  RobotTree tree = MakeRoot();
  AddJoint(tree, "a", 0, Offset(0, 0, 1), {0, 0, 1});
  const std::vector<CollisionSphere> spheres = {{"low", 0, {0.3, 0, 0}, 0.1},
                                                {"high", 1, {0.3, 0.4, 0}, 0.2}};
  const std::vector<Transform> poses = LinkTransforms(tree, Eigen::VectorXd::Zero(1));
  // The centres are (0.3, 0, 0) and (0.3, 0.4, 1).
  EXPECT_NEAR(SphereDistances(spheres, {{0, 1}}, poses)[0], std::sqrt(1.16) - 0.3, 1e-15);
}

}  // namespace
}  // namespace elastocal
