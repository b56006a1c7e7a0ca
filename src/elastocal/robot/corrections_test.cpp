// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/corrections.hpp"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "elastocal/robot/inverse_dynamics.hpp"
#include "elastocal/robot/jacobian.hpp"
#include "elastocal/robot/posture_loads.hpp"
#include "elastocal/robot/statics.hpp"
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
  EXPECT_NEAR(of("elbow.backlash"), -1.0, 1e-12);  // the load is far above a fiftieth of the effort
  EXPECT_DOUBLE_EQ(of("elbow.stiffening"), -0.16);
  EXPECT_DOUBLE_EQ(of("waist.suspension_rx"), 5.0);
  EXPECT_DOUBLE_EQ(of("waist.suspension_x"), -7.0);
  EXPECT_DOUBLE_EQ(of("waist.drift_y"), 1.5);
}

// The ball screw with splines of a SCARA lifts its tool while it turns it.
TEST(Corrections, ASlideAndAJointThatTurnsAreCoupled) {
  RobotTree tree = PlanarArm();
  for (Joint& joint : tree.joints) joint.limits = {-1.0, 2.0, 1.0, 10.0};
  tree.joints[1].type = JointType::kPrismatic;
  const std::vector<Correction> all = PossibleCorrections(tree, std::nullopt);
  const std::vector<Correction> lifted = CorrectionsOf(all, {"elbow.coupling_shoulder"});
  const std::vector<Correction> turned = CorrectionsOf(all, {"shoulder.coupling_elbow"});
  ASSERT_EQ(lifted.size(), 1u);
  ASSERT_EQ(turned.size(), 1u);
  EXPECT_STREQ(UnitName(lifted[0].unit), "m/rad");
  EXPECT_STREQ(UnitName(turned[0].unit), "rad/m");
  const Eigen::VectorXd q = Eigen::Vector2d(0.3, 0.7);
  EXPECT_DOUBLE_EQ(Shapes(tree, lifted, q, 0.0, {})[0], 0.3 - 0.5);
  EXPECT_DOUBLE_EQ(Shapes(tree, turned, q, 0.0, {})[0], 0.7 - 0.5);
  tree.joints[0].type = JointType::kPrismatic;  // two slides have nothing to do with each other
  EXPECT_TRUE(
      CorrectionsOf(PossibleCorrections(tree, std::nullopt), {"elbow.coupling_shoulder"}).empty());
}

TEST(Corrections, DriftNeedsTimesAndMimicJointsHaveNone) {
  RobotTree tree = PlanarArm();
  MakeLastJointMimic(tree, 0, 2.0, 0.1);
  for (const Correction& correction : PossibleCorrections(tree, std::nullopt)) {
    EXPECT_NE(correction.shape, CorrectionShape::kHours) << correction.name;
    EXPECT_NE(correction.joint, 1) << correction.name;
  }
}

// The gear turns a hundredth less than its encoder says.
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

void WeighLinks(RobotTree& tree, Random& random) {
  for (Link& link : tree.links) {
    link.mass = random.Uniform(0.5, 2.0);
    link.com = random.NormalVector(3, 0.1);
  }
}

/// Adds mass and first moment (in the link's frame, kg.m) to the link on a joint.
void AddWeight(RobotTree& tree, int joint, double mass, const Eigen::Vector3d& moment) {
  Link& link = tree.links[tree.joints[joint].child_link];
  link.com = (link.mass * link.com + moment) / (link.mass + mass);
  link.mass += mass;
}

/// Centre of mass of a joint's link and all that is fixed to it, in that link's frame, m.
Eigen::Vector3d CentreOfBody(const RobotTree& tree, int joint) {
  return BodyInertias(tree)[joint + 1].com;
}

/// A heavier elbow turns the shoulder, and the marker with it.
TEST(Corrections, MassAndFirstMomentHaveTheirHandValues) {
  RobotTree tree = PlanarArm();
  const int shoulder = 0, elbow = 1;
  tree.links[tree.joints[elbow].child_link].mass = 1.0;
  tree.links[tree.joints[elbow].child_link].com = {0.1, 0.0, 0.0};
  Elasticity elasticity;
  elasticity.torsion = {shoulder};
  elasticity.corrections = PossibleCorrections(tree, std::nullopt);
  const ErrorModel model =
      MakeErrorModel(tree, {{"M", FindLink(tree, "tip"), Eigen::Vector3d::Zero()}}, {}, elasticity);
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  const auto set = [&](const std::string& name, double value) {
    delta[FindParameter(model.parameters, name)] = value;
  };
  const std::string link = tree.links[tree.joints[elbow].child_link].name;
  set(tree.joints[shoulder].name + ".compliance_z", 1e-3);
  set(link + ".mass", 0.2);
  set(link + ".moment_x", 0.05);
  const Geometry geometry = ApplyErrors(model, delta);
  const Eigen::Vector2d q(0.0, 0.0);
  const PostureLoads loads = LoadPosture(model, geometry, q, -1, {}, {0.0, -10.0, 0.0}, {});
  const double as_described = -10.0 * 0.6 * std::cos(1e-3 * 10.0 * 0.6);  // the shoulder has sunk
  EXPECT_NEAR(loads.joints(2, shoulder), as_described, 1e-12);
  const double load = as_described - 10.0 * (0.2 * 0.6 + 0.05);
  EXPECT_NEAR(CorrectedLoads(geometry, loads.joints)(2, shoulder), load, 1e-12);
  const Eigen::Vector3d found = MarkerPositions(model, geometry, q, loads.joints);
  const Eigen::Vector3d expected(0.8 * std::cos(1e-3 * load), 0.8 * std::sin(1e-3 * load), 0.0);
  EXPECT_LT((found - expected).norm(), 1e-14);
}

// If nothing gives way, or if torques are measured, markers do not show a mass.
TEST(Corrections, AMassNeedsASpringThatStaticsLoad) {
  RobotTree tree = PlanarArm();
  tree.links[tree.joints[1].child_link].mass = 1.0;
  Elasticity elasticity;
  elasticity.corrections = PossibleCorrections(tree, std::nullopt);
  const std::vector<Marker> markers{{"M", FindLink(tree, "tip"), Eigen::Vector3d::Zero()}};
  for (const Parameter& parameter : MakeErrorModel(tree, markers, {}, elasticity).parameters) {
    EXPECT_FALSE(parameter.name.ends_with(".mass")) << parameter.name;
    EXPECT_FALSE(parameter.name.starts_with("gravity")) << parameter.name;
  }
  elasticity.torsion = {0, 1};
  const ErrorModel model = MakeErrorModel(tree, markers, {}, elasticity);
  const Geometry geometry = ApplyErrors(model, Eigen::VectorXd::Zero(model.parameter_count()));
  MeasuredLoads measured;
  measured.torques = Eigen::Vector2d(3.0, NAN);
  const JointLoads loads =
      LoadPosture(model, geometry, Eigen::Vector2d(0.1, 0.2), -1, measured, {0.0, -10.0, 0.0}, {})
          .joints;
  const int tilt = model.parameters[FindParameter(model.parameters, "gravity.tilt_x")].correction;
  const int mass = model
                       .parameters[FindParameter(
                           model.parameters, tree.links[tree.joints[1].child_link].name + ".mass")]
                       .correction;
  EXPECT_EQ(loads.by_correction[mass](2, 0), 0.0);
  EXPECT_EQ(loads.by_correction[tilt](2, 0), 0.0);
}

class CorrectionsOfRandomRobots : public testing::TestWithParam<int> {};

// Checks all columns, including those of the root link's displacement, for elastic robots with
// corrections.
TEST_P(CorrectionsOfRandomRobots, ColumnsAgreeWithDifferences) {
  Random random(GetParam());
  RobotTree tree = RandomRobot(kUsualRelations, random);
  WeighLinks(tree, random);
  const std::vector<Marker> markers = RandomMarkers(tree, random);
  Elasticity elasticity;
  elasticity.corrections = PossibleCorrections(tree, 0.0, {markers.front().name});
  for (int k = 0; k < static_cast<int>(tree.joints.size()); ++k) elasticity.torsion.push_back(k);
  ErrorModel model = MakeErrorModel(tree, markers, {}, elasticity);
  model.T_ref_waist = RandomTransform(random);
  const Eigen::VectorXd delta = random.NormalVector(model.parameter_count(), 0.03);
  const Eigen::VectorXd q = RandomPosture(tree, random);
  JointLoads loads = JointLoads::Zero(3, static_cast<Eigen::Index>(tree.joints.size()));
  loads.shapes = random.NormalVector(static_cast<Eigen::Index>(elasticity.corrections.size()), 1.0);
  for (double& load : loads.reshaped()) load = random.Normal(0.3);
  const Eigen::Vector3d gravity(0.3, -0.5, 0.8);
  loads.by_correction = LoadsByCorrections(model, ApplyErrors(model, delta), q, gravity);
  GeneralizedJacobian jacobian(model);
  jacobian.Evaluate(ApplyErrors(model, delta), q, loads);
  const Eigen::MatrixXd J = jacobian.Dense();
  const double step = 1e-5;  // the error is 1e-10, see jacobian_test.cpp
  std::map<CorrectionTarget, int> corrections;
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
    if (model.parameters[i].kind != ParameterKind::kCorrection) continue;
    ++corrections[TargetOf(elasticity.corrections[model.parameters[i].correction])];
  }
  EXPECT_GE(corrections[CorrectionTarget::kRoot], 6);
  EXPECT_GT(corrections[CorrectionTarget::kLoads], 2);
  EXPECT_GT(corrections[CorrectionTarget::kJoint], 0);
  EXPECT_EQ(corrections[CorrectionTarget::kMarker], 3);
}

// The derivatives are those of the loads of a robot with heavier bodies, or of one that stands
// askew.
TEST_P(CorrectionsOfRandomRobots, LoadsAgreeWithThoseOfTheOtherRobot) {
  Random random(100 + GetParam());
  RobotTree tree = RandomRobot(kUsualRelations, random);
  WeighLinks(tree, random);
  Elasticity elasticity;
  elasticity.corrections = PossibleCorrections(tree, std::nullopt);
  for (int k = 0; k < static_cast<int>(tree.joints.size()); ++k) elasticity.torsion.push_back(k);
  ErrorModel model = MakeErrorModel(tree, RandomMarkers(tree, random), {}, elasticity);
  model.T_ref_waist = RandomTransform(random);
  const Geometry geometry = ApplyErrors(model, random.NormalVector(model.parameter_count(), 0.03));
  const Eigen::VectorXd q = RandomPosture(tree, random);
  const Eigen::Vector3d gravity(0.3, -5.0, 8.0);
  const JointLoads loads = GravityLoads(model, geometry, q, gravity, 0);
  const auto derivatives = LoadsByCorrections(model, geometry, q, gravity);
  int loaded = 0;
  for (std::size_t i = 0; i < derivatives.size(); ++i) {
    if (derivatives[i].cols() == 0) continue;
    const Correction& correction = elasticity.corrections[i];
    ErrorModel other = model;
    Eigen::Matrix3Xd expected;
    if (correction.shape == CorrectionShape::kGravityTilt) {
      const Eigen::Vector3d axis = WaistPose(geometry).linear().col(correction.axis);
      const double step = 1e-4;  // the relative error is 1e-8
      expected = (GravityLoads(model, geometry, q, Eigen::AngleAxisd(step, axis) * gravity, 0) -
                  GravityLoads(model, geometry, q, Eigen::AngleAxisd(-step, axis) * gravity, 0)) /
                 (2.0 * step);
    } else {
      const bool mass = correction.shape == CorrectionShape::kMass;
      const Eigen::Vector3d moment = mass ? CentreOfBody(tree, correction.source)
                                          : Eigen::Vector3d(Eigen::Vector3d::Unit(correction.axis));
      AddWeight(other.tree, correction.source, mass ? 1.0 : 0.0, moment);
      expected = GravityLoads(other, geometry, q, gravity, 0) - loads;
    }
    EXPECT_LT((derivatives[i] - expected).norm(), 1e-7 * (1.0 + expected.norm()))
        << correction.name;
    loaded += derivatives[i].norm() > 1e-6 ? 1 : 0;  // a moment does not load a joint that slides
  }
  EXPECT_GT(loaded, 4);
}

INSTANTIATE_TEST_SUITE_P(Seeds, CorrectionsOfRandomRobots, testing::Range(1, 6));

}  // namespace
}  // namespace elastocal
