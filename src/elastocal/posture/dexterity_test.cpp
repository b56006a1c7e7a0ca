// SPDX-License-Identifier: Apache-2.0
#include "elastocal/posture/dexterity.hpp"

#include <string>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "tests/leg_problem.hpp"
#include "tests/random_robot.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

// Robots with joints that turn and slide in any relation, and one joint that follows another.
TEST(Dexterity, DerivativeEqualsDifferences) {
  constexpr double kStep = 1e-6;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    RobotTree tree = RandomRobot(kUsualRelations, random);
    for (int k = 0; k < 6; ++k) {
      AddJoint(tree, "more" + std::to_string(k), static_cast<int>(tree.links.size()) - 1,
               RandomTransform(random), random.NormalVector(3, 1.0).normalized(),
               k == 3 ? JointType::kPrismatic : JointType::kRevolute);
    }
    AddJoint(tree, "follower", static_cast<int>(tree.links.size()) - 1, Offset(0.1, 0.2, -0.1),
             {0.3, 0.5, 0.8});
    MakeLastJointMimic(tree, 0, -0.7, 0.2);
    const int tip = static_cast<int>(tree.links.size()) - 1;
    MovingChain chain(tree, ChainCoordinates(tree, 0, tip), RandomPosture(tree, random));
    ASSERT_GE(chain.size(), 6);
    const Dexterity dexterity(chain, tip, 0.5);
    EXPECT_EQ(dexterity.lower()[0], 0.5 * LeastSingularValue(chain, tip));
    const Eigen::VectorXd x = RandomPosture(tree, random)(chain.coordinates());
    Eigen::VectorXd value(1);
    Eigen::MatrixXd gradient(1, chain.size());
    chain.Move(x);
    dexterity.Evaluate(chain, value, gradient);
    EXPECT_NEAR(value[0], LeastSingularValue(chain, tip), 1e-12);
    for (int i = 0; i < chain.size(); ++i) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(chain.size(), i);
      chain.Move(x + step);
      const double ahead = LeastSingularValue(chain, tip);
      chain.Move(x - step);
      EXPECT_NEAR(gradient(0, i), (ahead - LeastSingularValue(chain, tip)) / (2.0 * kStep), 1e-5)
          << seed;
    }
  }
}

// A straight knee leaves five directions. The more it bends, the better is the sixth.
TEST(Dexterity, AStretchedLegHasNone) {
  const RobotTree tree = TalosLeg();
  const int foot = static_cast<int>(tree.links.size()) - 1;
  MovingChain chain(tree, ChainCoordinates(tree, 0, foot), Eigen::VectorXd::Zero(6));
  EXPECT_LT(LeastSingularValue(chain, foot), 1e-7);
  double last = 0.0;
  for (double knee : {0.1, 0.3, 0.6}) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(6);
    x.segment<3>(2) << -0.5 * knee, knee, -0.5 * knee;
    chain.Move(x);
    const double now = LeastSingularValue(chain, foot);
    EXPECT_GT(now, last + 0.01);
    last = now;
  }
}

}  // namespace
}  // namespace elastocal
