// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/lumped_compliance.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/rotation_vector.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

constexpr double kTorsion = 2e-5;  // rad/(N.m)

/// A thigh of 0.4 m hangs from a hip about y. The foot at its end carries the waist.
ErrorModel Pendulum() {
  RobotTree tree = MakeRoot();
  AddJoint(tree, "hip", 0, Offset(0, 0, 0), {0, 1, 0});
  AddFixedLink(tree, "foot", 1, Offset(0, 0, -0.4));
  return MakeErrorModel(
      tree, {}, {}, {.torsion = {0}, .bending = {0}, .root_bending = {0}, .legs = {{"leg", 2}}});
}

// The hip is in the waist's origin. A force there does not bend it, and a moment about y turns it.
TEST(LumpedCompliance, OfALegByHand) {
  const ErrorModel model = Pendulum();
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  delta[FindParameter(model.parameters, "hip.compliance_z")] = kTorsion;
  delta[FindParameter(model.parameters, "hip.compliance_root_x")] = 7e-6;
  delta[FindParameter(model.parameters, "leg.compliance_z")] = 3e-6;
  const Matrix6d compliance =
      LumpedCompliance(model, ApplyErrors(model, delta), Eigen::VectorXd::Zero(1), 0);
  Matrix6d expected = Matrix6d::Zero();
  expected(2, 2) = 3e-6;
  expected(3, 3) = 7e-6;
  expected(4, 4) = kTorsion;
  EXPECT_LT((compliance - expected).norm(), 1e-18);
}

// A wrench on the waist of the TALOS leg must move it as far as the loaded kinematics do.
TEST(LumpedCompliance, IsWhatLoadedKinematicsDo) {
  RobotTree tree = TalosLeg();
  AddFixedLink(tree, "sole", 6, Offset(0, 0, -0.1));
  const std::vector<int> joints = {0, 1, 2, 3, 4, 5};
  const ErrorModel model =
      MakeErrorModel(tree, {}, {}, {.torsion = joints, .bending = {}, .legs = {{"leg", 7}}});
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  for (int joint : joints) {
    delta[FindParameter(model.parameters, tree.joints[joint].name + ".compliance_z")] =
        1e-6 * (1 + joint);
  }
  const Geometry geometry = ApplyErrors(model, delta);
  Eigen::VectorXd q(6);
  q << 0.1, 0.05, -0.6, 1.1, -0.5, -0.05;
  const LegPosture rigid = PlaceLeg(model, geometry, q, 0);
  const Matrix6d compliance = LumpedCompliance(model, geometry, q, 0);
  for (int i = 0; i < 6; ++i) {
    // The motors balance the wrench, tau = -J^T F. The load about their axes is the opposite.
    const Vector6d wrench = Vector6d::Unit(i);
    JointLoads loads = JointLoads::Zero(3, 6);
    loads.row(2) = (rigid.J_waist_q.transpose() * wrench).transpose();
    const LegPosture loaded = PlaceLeg(model, geometry, q, 0, loads);
    Vector6d motion;
    motion.head<3>() = loaded.T_foot_waist.translation() - rigid.T_foot_waist.translation();
    motion.tail<3>() =
        RotationVector(loaded.T_foot_waist.linear() * rigid.T_foot_waist.linear().transpose());
    // The remainder is of second order in rotations of 1e-5.
    EXPECT_LT((motion - compliance * wrench).norm(), 1e-9) << i;
  }
}

}  // namespace
}  // namespace elastocal
