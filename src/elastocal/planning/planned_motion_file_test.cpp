// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/planned_motion_file.hpp"

#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>

#include "elastocal/io/motion_file.hpp"
#include "elastocal/math/random.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

TEST(PlannedMotionFile, IsReadAsItWasWritten) {
  Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  Random random(1);
  PlannedMotion planned;
  const int left = project.soles[0].link, right = project.soles[1].link;
  // Names may have separators and quotes.
  project.tree.links[static_cast<std::size_t>(left)].name = "sole, left";
  project.tree.joints[0].name = "first; \"joint\"";
  planned.motion.time_s = Eigen::Vector3d(0.0, 10.0, 20.0);
  planned.motion.support = {{left, right}, {right}, {left}};
  planned.motion.q.resize(3, project.tree.coordinate_count());
  for (int i = 0; i < 3; ++i) {
    planned.motion.q.row(i) = RandomPosture(project.tree, random).transpose();
  }
  planned.zmp = Eigen::MatrixXd::Random(3, 2);
  planned.torques = Eigen::MatrixXd::Random(3, planned.motion.q.cols());
  std::istringstream stream(FormatMotionTable(project.tree, planned));
  const JointMotion read = ReadMotion(stream, "motion.csv", project);
  EXPECT_EQ(read.time_s, planned.motion.time_s);
  EXPECT_EQ(read.support, planned.motion.support);
  // Positions are written with twelve digits.
  EXPECT_LT((read.q - planned.motion.q).cwiseAbs().maxCoeff(), 1e-11);
}

// Four decimals would make every third step of a millisecond shorter, and the joints faster.
TEST(PlannedMotionFile, StepsAreThoseOfThePlan) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  for (const double step : {1.0753e-3, 1.0 / 3000.0, 5e-5}) {
    PlannedMotion planned;
    planned.motion.time_s = Eigen::VectorXd::LinSpaced(201, 0.0, 200.0 * step).array() + 100.0;
    planned.motion.q = Eigen::MatrixXd::Zero(201, project.tree.coordinate_count());
    const std::string text = FormatMotionTable(project.tree, planned);
    EXPECT_TRUE(IsMotionTable(project.tree, text));
    std::istringstream stream(text);
    const Eigen::VectorXd read = ReadMotion(stream, "motion.csv", project).time_s;
    EXPECT_LT((read - planned.motion.time_s).cwiseAbs().maxCoeff(), 1e-9);
  }
}

// The controller does not command a wheel or finger that is on no chain and stands still.
TEST(JointTrajectory, HasTheJointsOfChainsAndThoseThatMove) {
  const Project project = ReadProject(SourceFile("models/talos/project.yaml"));
  const RobotTree& tree = project.tree;
  JointMotion motion;
  motion.time_s = Eigen::Vector3d(10.0, 10.5, 12.25);
  motion.q = Eigen::MatrixXd::Zero(3, tree.coordinate_count());
  const auto coordinate = [&](const std::string& joint) {
    return tree.joints[static_cast<std::size_t>(FindJoint(tree, joint))].coordinate;
  };
  const int torso = coordinate("torso_2_joint"), head = coordinate("head_1_joint"),
            leg = coordinate("leg_left_3_joint");
  motion.q.col(leg) << 0.0, 0.25, 0.5;
  Chain chain = project.chains.front();
  chain.tip_link = FindLink(tree, "head_1_link");
  const std::vector<int> coordinates = CommandedCoordinates(tree, {chain}, motion);
  EXPECT_EQ(coordinates.size(), 4u);  // two of the torso, one of the head, and one that moves
  for (const int c : {torso, head, leg}) {
    EXPECT_NE(std::ranges::find(coordinates, c), coordinates.end()) << c;
  }
  EXPECT_EQ(FormatJointTrajectory(tree, {leg}, motion, 2, RosVersion::kRos2),
            "header:\n  stamp: {sec: 0, nanosec: 0}\n  frame_id: ''\njoint_names:\n"
            "  - leg_left_3_joint\npoints:\n"
            "  - positions: [0]\n    velocities: [0.5]\n"
            "    time_from_start: {sec: 0, nanosec: 0}\n"
            "  - positions: [0.5]\n    velocities: [0.142857]\n"
            "    time_from_start: {sec: 2, nanosec: 250000000}\n");
  EXPECT_NE(FormatJointTrajectory(tree, {leg}, motion, 2, RosVersion::kRos1)
                .find("time_from_start: {secs: 2, nsecs: 250000000}"),
            std::string::npos);
}

TEST(JointTrajectory, NamesAreText) {
  RobotTree tree = ReadProject(SourceFile("models/talos/project.yaml")).tree;
  JointMotion motion;
  motion.time_s = Eigen::Vector2d(0.0, 1.0);
  motion.q.setZero(2, tree.coordinate_count());
  const auto expect = [&](const std::string& name, const std::string& written) {
    tree.joints[static_cast<std::size_t>(tree.coordinate_joint[0])].name = name;
    EXPECT_NE(FormatJointTrajectory(tree, {0}, motion, 1, RosVersion::kRos2)
                  .find("joint_names:\n  - " + written + "\n"),
              std::string::npos)
        << name;
  };
  expect("yes", "\"yes\"");
  expect("1", "\"1\"");
  expect("L Ankle: Pitch", "\"L Ankle: Pitch\"");
  expect("torso_1_joint", "torso_1_joint");
}

TEST(ProjectFile, ReadsSoles) {
  const Project talos = ReadProject(SourceFile("models/talos/project.yaml"));
  ASSERT_EQ(talos.soles.size(), 2u);
  EXPECT_NEAR(talos.soles[0].upper.x(), 0.105, 1e-15);
  const auto parse = [&](const std::string& soles) {
    return ParseProject(
        "robot: {urdf: talos.urdf}\nmarkers: {reference: W, clusters: [{name: W, "
        "link: base_link, positions_mm: [[0, 0, 0], [9, 0, 0], [0, 9, 0]]}, {name: H, "
        "link: head_2_link, positions_mm: [[0, 0, 0], [9, 0, 0], [0, 9, 0]]}]}\n"
        "standing: {soles: " +
            soles + "}\n",
        SourceFile("models/talos/project.yaml"));
  };
  const std::string left = "{link: left_sole_link, lower_mm: [-1, -1], upper_mm: [1, 1]}";
  EXPECT_EQ(parse("[" + left + "]").soles.size(), 1u);
  ExpectInputError([&] { parse("[" + left + ", " + left + "]"); }, {"no sole yet"});
  ExpectInputError([&] { parse("[]"); }, {"one or more soles"});
  ExpectInputError([&] { parse("[{link: left_sole_link, lower_mm: [1, -1], upper_mm: [1, 1]}]"); },
                   {"lower corner"});
  ExpectInputError([&] { parse("[{link: left_sole_lnk, lower_mm: [1, -1], upper_mm: [1, 1]}]"); },
                   {"left_sole_link"});
}

}  // namespace
}  // namespace elastocal
