// SPDX-License-Identifier: Apache-2.0
#include "elastocal/description/calibrated_urdf.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/description/move_urdf.hpp"
#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/files/output_files.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "tests/drawn_calibration.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

class CalibratedUrdfOf : public ::testing::TestWithParam<std::string> {
 protected:
  std::string urdf_ = ReadFile(SourceFile(GetParam()));
  RobotTree tree_ = ParseUrdf(urdf_, "urdf");
};

/// The poses of all links relative to the waist differ by less than rounding along ten joints.
void ExpectSamePoses(const CalibrationResult& calibration, const RobotTree& written,
                     const std::map<std::string, double>& encoder_offsets) {
  const ErrorModel& model = calibration.model;
  const Geometry geometry = ApplyErrors(model, calibration.delta);
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::VectorXd q = RandomPosture(model.tree, random);
    Eigen::VectorXd q_written = q;
    for (const auto& [joint, offset] : encoder_offsets) {
      q_written[model.tree.joints[FindJoint(model.tree, joint)].coordinate] += offset;
    }
    const auto T_ref_body = BodyTransforms(model, geometry, q);
    const auto T_root_link = LinkTransforms(written, q_written);
    for (std::size_t i = 0; i < written.links.size(); ++i) {
      const Transform expected = T_ref_body[0].inverse() * T_ref_body[written.links[i].body] *
                                 model.tree.links[i].T_body_link;
      EXPECT_LT((expected.matrix() - T_root_link[i].matrix()).cwiseAbs().maxCoeff(), 1e-12)
          << written.links[i].name;
    }
  }
}

TEST_P(CalibratedUrdfOf, EqualsTheCalibratedModel) {
  const CalibrationResult calibration = WithErrors(tree_, 1);
  const CalibratedUrdf calibrated =
      MakeCalibratedUrdf(urdf_, "urdf", calibration, ZeroOffsets::kOrigin);
  EXPECT_TRUE(calibrated.encoder_offsets.empty());
  ExpectSamePoses(calibration, ParseUrdf(calibrated.text, "written"), {});
}

TEST_P(CalibratedUrdfOf, NoErrorsNoChange) {
  CalibrationResult calibration = WithErrors(tree_, 1);
  calibration.delta.setZero();
  const CalibratedUrdf calibrated =
      MakeCalibratedUrdf(urdf_, "urdf", calibration, ZeroOffsets::kOrigin);
  EXPECT_EQ(calibrated.text, urdf_);
  EXPECT_TRUE(calibrated.warnings.empty());
}

TEST_P(CalibratedUrdfOf, XacroOffsetsAddUpToTheCalibratedOrigins) {
  const CalibratedUrdf calibrated =
      MakeCalibratedUrdf(urdf_, "urdf", WithErrors(tree_, 2), ZeroOffsets::kOrigin);
  const std::string xacro = MakeXacroOffsets(calibrated);
  for (const auto& [joint, origin] : calibrated.calibrated) {
    const auto& nominal = calibrated.nominal.at(joint);
    // A small change of the origin changes each component by little.
    EXPECT_LT((origin.xyz - nominal.xyz).norm(), 0.05) << joint;
    EXPECT_LT((origin.rpy - nominal.rpy).cwiseAbs().maxCoeff(), 0.3) << joint;
    const std::string property = "name=\"" + joint + "_yaw_offset\" value=\"";
    const std::size_t at = xacro.find(property);
    ASSERT_NE(at, std::string::npos) << joint;
    EXPECT_EQ(std::stod(xacro.substr(at + property.size())), origin.rpy.z() - nominal.rpy.z());
  }
}

TEST_P(CalibratedUrdfOf, EncoderOffsetsCompleteTheOrigins) {
  const CalibrationResult calibration = WithErrors(tree_, 3);
  const CalibratedUrdf calibrated =
      MakeCalibratedUrdf(urdf_, "urdf", calibration, ZeroOffsets::kEncoder);
  EXPECT_EQ(calibrated.encoder_offsets.size(), static_cast<std::size_t>(tree_.coordinate_count()));
  const std::string xacro = MakeXacroOffsets(calibrated);
  for (int k : tree_.coordinate_joint) {
    const Joint& joint = tree_.joints[k];
    const char* zero = joint.type == JointType::kRevolute ? ".theta" : ".r";
    const int parameter = FindParameter(calibration.model.parameters, joint.name + zero);
    EXPECT_EQ(calibrated.encoder_offsets.at(joint.name), calibration.delta[parameter]);
    EXPECT_NE(xacro.find("name=\"" + joint.name + "_offset\""), std::string::npos);
  }
  ExpectSamePoses(calibration, ParseUrdf(calibrated.text, "written"), calibrated.encoder_offsets);
}

INSTANTIATE_TEST_SUITE_P(Robots, CalibratedUrdfOf,
                         ::testing::Values("models/talos/talos.urdf", "tests/robots/arm6.urdf",
                                           "tests/robots/mini_humanoid.urdf"),
                         [](const auto& robot) { return std::to_string(robot.index); });

// The right hip is not in the model, but the left hip's encoder drives it. Its origin must turn
// back.
TEST(CalibratedUrdf, AMimicJointWithoutMarkersStaysWhereItIs) {
  const std::string urdf = ReadFile(SourceFile("tests/robots/mini_humanoid.urdf"));
  const RobotTree tree = ParseUrdf(urdf, "urdf");
  const Joint& leader = tree.joints[FindJoint(tree, "left_hip_yaw_pitch")];
  CalibrationResult calibration;
  calibration.model = MakeErrorModel(tree, {{"M", leader.child_link, {0.1, 0.02, 0.03}}});
  calibration.delta.setZero(calibration.model.parameter_count());
  calibration.delta[FindParameter(calibration.model.parameters, "left_hip_yaw_pitch.theta")] = 0.01;
  const CalibratedUrdf calibrated =
      MakeCalibratedUrdf(urdf, "urdf", calibration, ZeroOffsets::kEncoder);
  EXPECT_EQ(calibrated.encoder_offsets,
            (std::map<std::string, double>{{"left_hip_yaw_pitch", 0.01}}));
  ASSERT_EQ(calibrated.calibrated.size(), 1u);
  const UrdfOrigin& origin = calibrated.calibrated.at("right_hip_yaw_pitch");
  // The origin turns back about the axis (0, 1, 1). The rest is of second order, 0.01^2.
  const Eigen::Vector3d expected = -0.01 * Eigen::Vector3d(0.0, M_SQRT1_2, M_SQRT1_2);
  EXPECT_LT((origin.rpy - expected).norm(), 1e-4);
  EXPECT_EQ(origin.xyz, calibrated.nominal.at("right_hip_yaw_pitch").xyz);
}

// Names in xacro consist of letters, digits and '_'.
TEST(CalibratedUrdf, XacroPropertiesOfJointsWithOtherNamesDiffer) {
  CalibratedUrdf calibrated;
  for (const char* joint : {"a-b", "a.b", "a_b", "2 z", "hip", "hip_roll"}) {
    calibrated.nominal[joint] = calibrated.calibrated[joint] = UrdfOrigin();
    calibrated.encoder_offsets[joint] = 0.5;
  }
  calibrated.calibrated["a_b"].xyz.x() += 3.0;
  const std::string xacro = MakeXacroOffsets(calibrated);
  const auto count = [&](const std::string& words) {
    int found = 0;
    for (std::size_t at = 0; (at = xacro.find(words, at)) != std::string::npos; ++at) ++found;
    return found;
  };
  EXPECT_EQ(count("name=\"a_b_x_offset\" value=\"3\""), 1) << xacro;
  for (const char* name : {"a_b", "a_b_2", "a_b_3", "_2_z", "hip", "hip_roll_2"}) {
    EXPECT_EQ(count("name=\"" + std::string(name) + "_offset\""), 1) << xacro;
  }
  EXPECT_EQ(count("name=\"hip_roll_offset\" value=\"0\""), 1) << xacro;  // of the joint hip
  EXPECT_EQ(count("<!-- joint 'a.b': a_b_3_... -->"), 1) << xacro;
}

TEST(CalibratedUrdf, EveryEncoderHasAnOffsetWhateverWasEstimated) {
  const std::string urdf = ReadFile(SourceFile("tests/robots/mini_humanoid.urdf"));
  CalibrationResult calibration = WithErrors(ParseUrdf(urdf, "urdf"), 3);
  calibration.delta.setZero();
  calibration.delta[FindParameter(calibration.model.parameters, "head_yaw.theta")] = 0.01;
  const CalibratedUrdf calibrated =
      MakeCalibratedUrdf(urdf, "urdf", calibration, ZeroOffsets::kEncoder);
  EXPECT_EQ(calibrated.text, urdf);
  const std::string xacro = MakeXacroOffsets(calibrated);
  EXPECT_NE(xacro.find("name=\"head_yaw_offset\" value=\"0.01\""), std::string::npos);
  EXPECT_NE(xacro.find("name=\"head_pitch_offset\" value=\"0\""), std::string::npos);
  EXPECT_NE(xacro.find("name=\"left_hip_yaw_pitch_offset\" value=\"0\""), std::string::npos);
  EXPECT_EQ(xacro.find("right_hip_yaw_pitch"), std::string::npos);
}

TEST(CalibratedUrdf, OnlyOriginsOfJointsWithErrorsChange) {
  const std::string urdf = ReadFile(SourceFile("models/talos/talos.urdf"));
  CalibrationResult calibration = WithErrors(ParseUrdf(urdf, "urdf"), 3);
  calibration.delta.setZero();
  calibration.delta[FindParameter(calibration.model.parameters, "leg_left_3_joint.theta")] = 0.01;
  const CalibratedUrdf calibrated =
      MakeCalibratedUrdf(urdf, "urdf", calibration, ZeroOffsets::kOrigin);
  ASSERT_EQ(calibrated.calibrated.size(), 1u);
  // An offset of a joint about its own axis, which is the URDF's y, changes only the pitch.
  const UrdfOrigin& origin = calibrated.calibrated.at("leg_left_3_joint");
  EXPECT_LT((origin.rpy - Eigen::Vector3d(0.0, 0.01, 0.0)).norm(), 1e-15);
  EXPECT_LT((origin.xyz - calibrated.nominal.at("leg_left_3_joint").xyz).norm(), 1e-15);
  EXPECT_EQ(origin.rpy.x(), 0.0);  // not 1e-20 from rounding
  EXPECT_EQ(origin.rpy.z(), 0.0);
  EXPECT_TRUE(calibrated.warnings.empty());
}

TEST(CalibratedUrdf, BrokenWristAndParallelAxesAreWarnedOf) {
  const std::string urdf = ReadFile(SourceFile("models/talos/talos.urdf"));
  CalibrationResult calibration = WithErrors(ParseUrdf(urdf, "urdf"), 3);
  calibration.delta.setZero();
  const auto& parameters = calibration.model.parameters;
  calibration.delta[FindParameter(parameters, "arm_left_6_joint.d")] = 1e-3;
  calibration.delta[FindParameter(parameters, "leg_left_4_joint.beta")] = 0.01;
  const CalibratedUrdf calibrated =
      MakeCalibratedUrdf(urdf, "urdf", calibration, ZeroOffsets::kOrigin);
  ASSERT_EQ(calibrated.warnings.size(), 2u);
  std::string all = calibrated.warnings[0] + calibrated.warnings[1];
  EXPECT_NE(all.find("arm_left_5_joint, arm_left_6_joint, arm_left_7_joint"), std::string::npos);
  EXPECT_NE(all.find("1.000 mm"), std::string::npos) << all;
  EXPECT_NE(all.find("leg_left_3_joint, leg_left_4_joint"), std::string::npos);
  EXPECT_NE(all.find("0.573 deg"), std::string::npos) << all;
  // For a hand, less than half a millimetre does not matter, nor does half a millimetre over half a
  // metre.
  calibration.delta[FindParameter(parameters, "arm_left_6_joint.d")] = 0.4e-3;
  calibration.delta[FindParameter(parameters, "leg_left_4_joint.beta")] = 0.8e-3;
  EXPECT_TRUE(MakeCalibratedUrdf(urdf, "urdf", calibration, ZeroOffsets::kOrigin).warnings.empty());
}

TEST(CalibratedUrdf, CorrectionsThatMoveUnrecordedBranchesAreWarnedOf) {
  const std::string urdf = ReadFile(SourceFile("models/talos/talos.urdf"));
  const RobotTree tree = ParseUrdf(urdf, "urdf");
  CalibrationResult calibration;
  calibration.model =
      MakeErrorModel(tree, {{"M", FindLink(tree, "arm_left_4_link"), {0.1, 0.02, 0.03}}});
  calibration.delta.setZero(calibration.model.parameter_count());
  const auto set = [&](const char* name) {
    calibration.delta[FindParameter(calibration.model.parameters, name)] = 1e-3;
  };
  const auto warnings = [&] {
    return MakeCalibratedUrdf(urdf, "urdf", calibration, ZeroOffsets::kOrigin).warnings;
  };
  set("arm_left_1_joint.theta");
  set("arm_left_4_joint.theta");  // carries only the forearm
  EXPECT_TRUE(warnings().empty());
  set("torso_2_joint.theta");
  ASSERT_EQ(warnings().size(), 1u);
  EXPECT_NE(warnings()[0].find("torso_2_joint also moves what head_1_joint, arm_right_1_joint"),
            std::string::npos)
      << warnings()[0];
}

// The export must refuse a text other than the one from which the model was read.
TEST(CalibratedUrdf, ADifferenceToTheModelIsAnError) {
  std::string urdf = ReadFile(SourceFile("models/talos/talos.urdf"));
  const CalibrationResult calibration = WithErrors(ParseUrdf(urdf, "urdf"), 3);
  const std::size_t at = urdf.find("<axis xyz=\"0 1 0\"/>");
  ASSERT_NE(at, std::string::npos);
  urdf.replace(at, 19, "<axis xyz=\"0 1 1e-6\"/>");
  EXPECT_THROW(MakeCalibratedUrdf(urdf, "urdf", calibration, ZeroOffsets::kOrigin),
               std::runtime_error);
}

TEST(CalibratedUrdf, ADifferenceInABranchWithoutMarkersOrAFixedLinkIsAnError) {
  const std::string urdf = ReadFile(SourceFile("tests/robots/arm6.urdf"));
  const RobotTree tree = ParseUrdf(urdf, "urdf");
  CalibrationResult calibration;
  calibration.model = MakeErrorModel(tree, {{"M", tree.joints[0].child_link, {0.1, 0.02, 0.03}}});
  calibration.delta.setZero(calibration.model.parameter_count());
  const auto write_into = [&](const std::string& joint) {
    std::map<std::string, UrdfOrigin> origins = ReadOrigins(urdf, "urdf");
    origins.at(joint).xyz.x() += 1e-6;
    MakeCalibratedUrdf(ReplaceOrigins(urdf, "urdf", origins), "urdf", calibration,
                       ZeroOffsets::kOrigin);
  };
  EXPECT_THROW(write_into("finger_right_joint"), std::runtime_error);
  EXPECT_THROW(write_into("column_mount"), std::runtime_error);  // on the body that has the marker
}

TEST(MoveUrdf, OnlyRelativeNamesOfFilesChange) {
  const std::string before =
      "<robot name=\"r\"><!-- <mesh filename=\"c.stl\"/> -->\n<material name=\"m\"><texture "
      "filename = \"../t.png\"/></material><link name=\"a\"><visual><geometry>\n"
      "<mesh scale=\"1 1 1\" filename='meshes/a.stl'/><mesh filename=\"package://r/a.stl\"/>"
      "<mesh filename=\"file:///r/a.stl\"/><mesh filename=\"/r/a.stl\"/>"
      "<mesh filename=\"$(find r)/a.stl\"/></geometry></visual></link></robot>";
  std::string after = before;
  const std::string moved = MoveUrdf(before, "r.urdf", "robots/r", "out/a");
  after.replace(after.find("../t.png"), 8, "../../robots/t.png");
  after.replace(after.find("meshes/a.stl"), 12, "../../robots/r/meshes/a.stl");
  EXPECT_EQ(moved, after);
  EXPECT_EQ(MoveUrdf(before, "r.urdf", "robots/r", "robots/../robots/r"), before);
}

}  // namespace
}  // namespace elastocal
