// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/shared_support.hpp"

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "tests/biped.hpp"

namespace elastocal {
namespace {

using Eigen::Vector3d;

Transform MovedBy(const Vector6d& screw, const Transform& T) {
  Transform moved = T;
  const Eigen::Matrix3d R = RotationFromVector(screw.head<3>());
  moved.linear() = R * T.linear();
  moved.translation() = R * T.translation() + screw.tail<3>();
  return moved;
}

std::vector<StandingFoot> RandomFeet(Random& random) {
  std::vector<StandingFoot> feet(3);
  const double shares[] = {0.5, 0.2, 0.3};
  const Transform root = RotAxis(Vector3d(1, 2, 3).normalized(), 0.4) * Offset(0.1, 0.2, 0.9);
  for (std::size_t i = 0; i < 3; ++i) {
    feet[i].share = shares[i];
    Vector6d off = random.NormalVector(6, 0.02);
    feet[i].T_floor_foot = MovedBy(random.NormalVector(6, 0.2), Transform::Identity());
    feet[i].T_root_foot = MovedBy(off, root.inverse() * feet[i].T_floor_foot);
  }
  return feet;
}

TEST(SharedSupport, MotionOfTheRootAgreesWithDifferences) {
  Random random(1);
  std::vector<StandingFoot> feet = RandomFeet(random);
  const RootOnFeet root = PlaceRootOnFeet(feet);
  const double step = 1e-5;  // its square, and rounding over it, leave 1e-10
  for (std::size_t f = 0; f < 3; ++f) {
    for (int i = 0; i < 6; ++i) {
      std::vector<StandingFoot> plus = feet;
      std::vector<StandingFoot> minus = feet;
      plus[f].T_root_foot = MovedBy(step * Vector6d::Unit(i), feet[f].T_root_foot);
      minus[f].T_root_foot = MovedBy(-step * Vector6d::Unit(i), feet[f].T_root_foot);
      const Transform a = PlaceRootOnFeet(plus).T_floor_root;
      const Transform b = PlaceRootOnFeet(minus).T_floor_root;
      Vector6d motion;
      motion << RotationVector(a.linear() * b.linear().transpose()),
          a.translation() - b.translation();
      motion /= 2.0 * step;
      EXPECT_LT((root.by_foot[f].col(i) - motion).norm(), 1e-8) << "foot " << f << ", " << i;
    }
  }
}

TEST(SharedSupport, FeetThatAgreePlaceTheRootExactlyAndClose) {
  Random random(2);
  std::vector<StandingFoot> feet = RandomFeet(random);
  const Transform root = MovedBy(random.NormalVector(6, 0.3), Transform::Identity());
  for (StandingFoot& foot : feet) foot.T_root_foot = root.inverse() * foot.T_floor_foot;
  EXPECT_TRUE(PlaceRootOnFeet(feet).T_floor_root.isApprox(root, 1e-14));
  EXPECT_LT(FootClosure(feet).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(SharedSupport, OneFootWithAllWeightIsTheSupportLegOfStatics) {
  const Biped biped = MakeBiped();
  const std::vector<int> links = {FindLink(biped.tree, "left_sole"),
                                  FindLink(biped.tree, "right_sole")};
  const ErrorModel model = MakeErrorModel(biped.tree, biped.markers);
  const Geometry geometry = ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
  Random random(3);
  const Eigen::VectorXd q = random.NormalVector(biped.tree.coordinate_count(), 0.3);
  const std::vector<Transform> T = LinkTransforms(biped.tree, q);
  std::vector<StandingFoot> feet(2);
  for (std::size_t i = 0; i < 2; ++i) {
    feet[i].T_root_foot = T[links[i]];
    feet[i].T_floor_foot = T[links[i]];  // the root is level
    feet[i].share = i == 0 ? 1.0 : 0.0;
  }
  const JointLoads shared = SharedSupportLoads(model, geometry, q, links, feet);
  const JointLoads alone = GravityLoads(model, geometry, q, kGravity, links[0]);
  EXPECT_LT((shared - alone).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_GT(alone.cwiseAbs().maxCoeff(), 10.0);
}

TEST(SharedSupport, WeightsSharesOfTheFeet) {
  // Two vertical legs carry half the weight each. The moment about a hip is that of the floor's
  // force at the foot, moved by the offset of the centre of mass, less that of the leg's own
  // weight.
  const Biped biped = MakeBiped();
  const std::vector<int> links = {FindLink(biped.tree, "left_sole"),
                                  FindLink(biped.tree, "right_sole")};
  const ErrorModel model = MakeErrorModel(biped.tree, biped.markers);
  const Geometry geometry = ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(biped.tree.coordinate_count());
  const std::vector<Transform> T = LinkTransforms(biped.tree, q);
  std::vector<StandingFoot> feet(2);
  for (std::size_t i = 0; i < 2; ++i) feet[i].T_root_foot = feet[i].T_floor_foot = T[links[i]];
  const JointLoads loads = SharedSupportLoads(model, geometry, q, links, feet);
  double mass = 0.0;
  Vector3d moment = Vector3d::Zero();
  for (std::size_t i = 0; i < biped.tree.links.size(); ++i) {
    mass += biped.tree.links[i].mass;
    moment += biped.tree.links[i].mass * (T[i] * biped.tree.links[i].com);
  }
  // The legs hang under their hips at x = -0.02, where their own weight has no moment about y.
  const double ahead = moment.x() / mass + 0.02;
  const int hip = FindJoint(biped.tree, "left_3");
  EXPECT_NEAR(loads(2, hip), -0.5 * mass * 9.81 * ahead, 1e-9);
}

}  // namespace
}  // namespace elastocal
