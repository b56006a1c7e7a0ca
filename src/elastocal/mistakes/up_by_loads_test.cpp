// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/up_by_loads.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/robot/statics.hpp"
#include "tests/talos_left_arm.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// Thirty postures of the arm with errors of its zeros. Axis `up` of the frame points up, and the
/// joints give way by `compliance` [rad/(N.m)].
Measurements Record(const Project& given, const Eigen::Vector3d& up, double compliance) {
  Project project = given;
  project.elasticity.torsion = std::vector<std::string>{"*"};
  ErrorModel model = MakeProjectModel(project, {});
  model.T_ref_waist = Transform(RotationBetween(Eigen::Vector3d::UnitZ(), up));
  Random random(3);
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(model.parameter_count());
  for (int i = 0; i < model.parameter_count(); ++i) {
    const ParameterKind kind = model.parameters[static_cast<std::size_t>(i)].kind;
    if (kind == ParameterKind::kTheta) truth[i] = random.Normal(0.01);
    if (IsCompliance(kind)) truth[i] = compliance;
  }
  const Geometry geometry = ApplyErrors(model, truth);
  Measurements measured;
  Recording& table = measured.calibration;
  table.source = "table";
  for (const Marker& marker : model.markers) table.marker_names.push_back(marker.name);
  table.q.resize(30, model.tree.coordinate_count());
  table.markers.resize(30, 3 * model.marker_count());
  for (int i = 0; i < 30; ++i) {
    const Eigen::VectorXd q = RandomPosture(model.tree, random);
    const JointLoads loads = GravityLoads(model, geometry, q, -9.81 * up, 0);
    table.q.row(i) = q.transpose();
    table.markers.row(i) = MarkerPositions(model, geometry, q, loads).reshaped().transpose() +
                           random.NormalVector(3 * model.marker_count(), 2e-4).transpose();
  }
  return measured;
}

class UpByLoadsTest : public testing::Test {
 protected:
  /// The axis that is found although z is stated to be up; empty if none is found.
  /// `calibrated`: error of the robot when it is calibrated with z up, m.
  std::string Found(const Eigen::Vector3d& up, double compliance, double calibrated = 1.0) const {
    const auto found = FindUpByLoads(project_, {}, Record(project_, up, compliance), calibrated);
    return found ? found->axis : "";
  }

  const Project project_ = ParseProject(kTalosLeftArm, SourceFile("project.yaml"));
};

TEST_F(UpByLoadsTest, AWrongAxisIsTold) {
  EXPECT_EQ(Found(Eigen::Vector3d::UnitY(), 1e-4), "y");
  EXPECT_EQ(Found(-Eigen::Vector3d::UnitX(), 1e-4), "-x");
}

// Both errors are mostly noise. With y up, springs explain something; with z up, nothing. No axis
// is named if causes explain as much with z up.
TEST_F(UpByLoadsTest, AWrongAxisIsToldBesideNoise) {
  EXPECT_EQ(Found(Eigen::Vector3d::UnitY(), 2e-5), "y");
  EXPECT_EQ(Found(Eigen::Vector3d::UnitY(), 1.5e-5), "y");  // only noise remains
  EXPECT_EQ(Found(Eigen::Vector3d::UnitY(), 2e-5, 0.3e-3), "");
  EXPECT_EQ(Found(Eigen::Vector3d::UnitZ(), 2e-5), "");
}

TEST_F(UpByLoadsTest, TheRightAxisAndARigidRobotAreNotAccused) {
  EXPECT_EQ(Found(Eigen::Vector3d::UnitZ(), 1e-4), "");
  EXPECT_EQ(Found(Eigen::Vector3d::UnitY(), 0.0), "");
}

// No axis explains the gain of a joint or an eccentric encoder disc. Axes -z and -x have smaller
// errors than z, but many times the noise.
TEST_F(UpByLoadsTest, AnAxisThatIsMerelyBetterIsNone) {
  Measurements gain = Record(project_, Eigen::Vector3d::UnitZ(), 2e-5);
  gain.calibration.q.col(1) *= 1.05;
  EXPECT_FALSE(FindUpByLoads(project_, {}, gain, 1.0));
  Measurements disc = Record(project_, Eigen::Vector3d::UnitZ(), 2e-5);
  disc.calibration = SelectPostures(disc.calibration, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
  disc.calibration.q.col(1) += 0.35 * disc.calibration.q.col(1).array().sin().matrix();
  EXPECT_FALSE(FindUpByLoads(project_, {}, disc, 1.0));
}

// Ten postures of one marker have fewer equations than the springs have unknowns.
TEST_F(UpByLoadsTest, TooFewEquationsSayNothing) {
  Measurements few = Record(project_, Eigen::Vector3d::UnitY(), 1e-4);
  few.calibration = SelectPostures(few.calibration, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
  few.calibration.markers.rightCols(6).setConstant(std::nan(""));
  EXPECT_FALSE(FindUpByLoads(project_, {}, few, 1.0));
}

TEST_F(UpByLoadsTest, OnlyStaticsOfAHeldRobotAreJudged) {
  Measurements free = Record(project_, Eigen::Vector3d::UnitY(), 1e-4);
  free.calibration.free_root = true;
  EXPECT_FALSE(FindUpByLoads(project_, {}, free, 1.0));
  Measurements sensed = Record(project_, Eigen::Vector3d::UnitY(), 1e-4);
  sensed.calibration.torques.setZero(30, project_.tree.joints.size());
  EXPECT_FALSE(FindUpByLoads(project_, {}, sensed, 1.0));
}

}  // namespace
}  // namespace elastocal
