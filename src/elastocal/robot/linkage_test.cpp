// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/linkage.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/robot/jacobian.hpp"
#include "elastocal/robot/subtree.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/linked_leg.hpp"

namespace elastocal {
namespace {

const std::vector<RodQuantity> kAll = {
    RodQuantity::kLength,  RodQuantity::kZero,    RodQuantity::kRadius,
    RodQuantity::kAnchorX, RodQuantity::kAnchorY, RodQuantity::kAnchorZ,
    RodQuantity::kCentreX, RodQuantity::kCentreY, RodQuantity::kCentreZ};
const std::vector<RodQuantity> kOfActuator = {RodQuantity::kLength, RodQuantity::kAnchorX,
                                              RodQuantity::kCentreZ};

/// The leg with all quantities of all rods uncertain.
RobotTree UncertainLeg() {
  RobotTree tree = LinkedLeg();
  for (Linkage& linkage : tree.linkages) {
    for (Rod& rod : linkage.rods) {
      rod.uncertain.clear();
      for (const RodQuantity quantity : rod.actuator ? kOfActuator : kAll) {
        rod.uncertain.push_back({quantity, 1e-3});
      }
    }
  }
  return tree;
}

Eigen::VectorXd SomeErrors(const Linkage& linkage, std::uint64_t seed) {
  return Random(seed).NormalVector(linkage.error_count(), 1e-3);
}

// The crank is as long as the lever and the rod as the distance of the axes. In this parallelogram,
// the joint turns like the motor.
TEST(Linkage, OfAParallelogramTurnsAsTheMotor) {
  RobotTree tree = LinkedLeg(false);
  Rod rod;
  rod.motor = "knee_motor";
  rod.from_link = FindLink(tree, "thigh");
  rod.to_link = FindLink(tree, "shank");
  rod.axis = Eigen::Vector3d::UnitY();
  rod.pin = {0.05, 0.0, 0.0};
  rod.anchor = {0.05, 0.0, 0.0};  // the knee's axis is 0.4 m below the hip's
  AddLinkage({"knee", {FindJoint(tree, "knee")}, {rod}, Eigen::VectorXd::Zero(1)}, tree);
  const Linkage& knee = tree.linkages[0];
  EXPECT_NEAR(knee.rods[0].length, 0.4, 1e-15);
  for (double angle : {-0.6, -0.1, 0.0, 0.3, 0.9}) {
    const Eigen::VectorXd at = Eigen::VectorXd::Constant(1, angle);
    EXPECT_NEAR((*MotorPositions(tree, knee, at))[0], angle, 1e-12);
    EXPECT_NEAR((*JointsFromMotors(tree, knee, at))[0], angle, 1e-12);
    EXPECT_NEAR(CloseLinkage(tree, knee, at, {}, at)->by_motors(0, 0), 1.0, 1e-12);
  }
}

TEST(Linkage, MotorsAndJointsBelongToEachOther) {
  const RobotTree tree = LinkedLeg();
  Random random(1);
  for (const Linkage& linkage : tree.linkages) {
    for (int i = 0; i < 200; ++i) {
      const Eigen::VectorXd q = RandomPosture(tree, random);
      const Eigen::VectorXd joints = q(CoordinatesOf(tree, linkage));
      const auto motors = MotorPositions(tree, linkage, joints);
      ASSERT_TRUE(motors.has_value());
      const auto back = JointsFromMotors(tree, linkage, *motors);
      ASSERT_TRUE(back.has_value()) << linkage.name;
      EXPECT_LT((*back - joints).norm(), 1e-10) << linkage.name;
    }
  }
}

// The differences are over 2e-6. Their error is the step's square times the third derivative (some
// 1e3), so 4e-9.
TEST(Linkage, DerivativesAreThoseOfDifferences) {
  constexpr double kStep = 1e-6;
  const RobotTree tree = UncertainLeg();
  Random random(2);
  for (const Linkage& linkage : tree.linkages) {
    const Eigen::VectorXd start = RandomPosture(tree, random)(CoordinatesOf(tree, linkage));
    const Eigen::VectorXd motors = *MotorPositions(tree, linkage, start);
    const Eigen::VectorXd errors = SomeErrors(linkage, 3);
    const auto positions = [&](const Eigen::VectorXd& m, const Eigen::VectorXd& e) {
      return CloseLinkage(tree, linkage, m, e, start)->positions;
    };
    const Closure closure = *CloseLinkage(tree, linkage, motors, errors, start);
    EXPECT_GT((closure.positions - start).norm(), 1e-3);
    for (int k = 0; k < linkage.error_count(); ++k) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(linkage.error_count(), k);
      const Eigen::VectorXd by =
          (positions(motors, errors + step) - positions(motors, errors - step)) / (2.0 * kStep);
      EXPECT_LT((closure.by_errors.col(k) - by).norm(), 1e-6) << linkage.name << k;
    }
    for (int k = 0; k < motors.size(); ++k) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(motors.size(), k);
      const Eigen::VectorXd by =
          (positions(motors + step, errors) - positions(motors - step, errors)) / (2.0 * kStep);
      EXPECT_LT((closure.by_motors.col(k) - by).norm(), 1e-6) << linkage.name << k;
    }
  }
}

// The generalized Jacobian of all markers, including one between the joints of a linkage, which the
// second of these joints does not move.
TEST(Linkage, MarkersMoveByItsErrors) {
  constexpr double kStep = 1e-6;
  const RobotTree tree = UncertainLeg();
  std::vector<Marker> markers = LinkedLegMarkers(tree);
  markers.push_back({"CROSS", FindLink(tree, "cross"), {0.01, 0.02, 0.0}});
  const ErrorModel model = MakeErrorModel(tree, markers);
  Random random(4);
  const Eigen::VectorXd delta = random.NormalVector(model.parameter_count(), 1e-3);
  const Eigen::VectorXd q = RandomPosture(tree, random);
  GeneralizedJacobian jacobian(model);
  jacobian.Evaluate(ApplyErrors(model, delta), q);
  const Eigen::MatrixXd J = jacobian.Dense();
  const auto positions = [&](const Eigen::VectorXd& d) {
    return Eigen::VectorXd(MarkerPositions(model, ApplyErrors(model, d), q).reshaped());
  };
  int of_linkages = 0;
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(model.parameter_count(), i);
    const Eigen::VectorXd by = (positions(delta + step) - positions(delta - step)) / (2.0 * kStep);
    EXPECT_LT((J.col(i) - by).norm(), 1e-6) << model.parameters[i].name;
    of_linkages += model.parameters[i].linkage >= 0 ? 1 : 0;
  }
  EXPECT_EQ(of_linkages, 9 + 9 + 3);
}

TEST(Linkage, StaysWithItsPartOfTheTree) {
  const RobotTree tree = LinkedLeg();
  const RobotTree shank = Subtree(tree, FindLink(tree, "shank"));
  ASSERT_EQ(shank.linkages.size(), 1u);
  const Linkage& ankle = shank.linkages[0];
  EXPECT_EQ(shank.joints[ankle.joints[0]].name, "ankle_pitch");
  EXPECT_EQ(shank.links[ankle.rods[0].from_link].name, "shank");
  const Eigen::Vector2d at(0.2, -0.1);
  EXPECT_LT(
      (*MotorPositions(shank, ankle, at) - *MotorPositions(tree, tree.linkages[1], at)).norm(),
      1e-14);
}

TEST(Linkage, SaysWhatDoesNotFit) {
  const RobotTree tree = LinkedLeg(false);
  const Linkage ankle = LinkedLeg().linkages[1];
  const auto refuse = [&](const Linkage& linkage, std::initializer_list<std::string> parts) {
    RobotTree copy = tree;
    ExpectInputError([&] { AddLinkage(linkage, copy); }, parts);
  };
  Linkage wrong = ankle;
  wrong.rods[1].length = 0.5;
  refuse(wrong, {"'ankle_inner'", "500 mm long and cannot reach", "between"});
  wrong = ankle;
  wrong.rods.pop_back();
  refuse(wrong, {"2 joints and 1 rods", "one rod for each joint"});
  wrong = ankle;
  wrong.rods[0].from_link = FindLink(tree, "thigh");
  refuse(wrong, {"'ankle_outer'", "joint 'knee'", "not of the linkage"});
  wrong = ankle;
  std::swap(wrong.rods[0].from_link, wrong.rods[0].to_link);
  refuse(wrong, {"link 'foot' does not carry link 'shank'"});
  wrong = ankle;
  wrong.rods[1] = wrong.rods[0];
  refuse(wrong, {"cannot move its joints"});
  RobotTree twice = LinkedLeg();
  ExpectInputError([&] { AddLinkage(ankle, twice); }, {"'ankle_pitch' belongs to linkage 'ankle'"});
}

// Far beyond the reach of the rods, there is no answer rather than a wrong one.
TEST(Linkage, DoesNotCloseOutOfReach) {
  const RobotTree tree = LinkedLeg();
  const Linkage& ankle = tree.linkages[1];
  EXPECT_FALSE(JointsFromMotors(tree, ankle, Eigen::Vector2d(3.0, -3.0)).has_value());
  EXPECT_FALSE(MotorPositions(tree, ankle, Eigen::Vector2d(1.5, 0.35)).has_value());
}

}  // namespace
}  // namespace elastocal
