// SPDX-License-Identifier: Apache-2.0
// How the robot of a project moves and bends.
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/project/project_sections.hpp"
#include "elastocal/robot/statics.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// A project with the arm of the tests and one marker.
Project ParseArm(const std::string& more = "") {
  return ParseProject(
      "robot: {urdf: arm6.urdf}\nmarkers: {single: [{name: M, link: tool, position_mm: [1, 2, "
      "3]}]}\n" +
          more,
      SourceFile("tests/robots/p.yaml"));
}

TEST(ProjectModel, NarrowsTheRangeOfAJoint) {
  const Project project = ParseArm("design: {range_deg: {elbow_joint: [-5000, 20]}}");
  const Project whole = ParseArm();
  const int elbow =
      project.tree.joints[static_cast<std::size_t>(FindJoint(project.tree, "elbow_joint"))]
          .coordinate;
  EXPECT_NEAR(project.motion.upper[elbow], 20.0 * M_PI / 180.0, 1e-12);
  EXPECT_EQ(project.motion.lower[elbow], whole.motion.lower[elbow]);
  EXPECT_LE(project.motion.rest[elbow], project.motion.upper[elbow]);
}

// The lift of an HSR is such a joint: gravity takes 87 of its 100 N, but designed postures use only
// 85 %.
TEST(ProjectModel, ARobotHoldsItsPostureOfRest) {
  const Project usual = ParseArm();
  const int lift = FindJoint(usual.tree, "elbow_joint");
  const int c = usual.tree.joints[Size(lift)].coordinate;
  const Eigen::VectorXd torques = GravityTorques(usual.tree, usual.motion.rest);
  ASSERT_GT(std::abs(torques[c]), 1.0);
  ASSERT_LT(std::abs(torques[c]), 0.8 * usual.tree.joints[Size(lift)].limits.effort);
  const auto with_effort = [&](double effort) {
    Project project = usual;
    project.tree.warnings.clear();
    project.tree.joints[Size(lift)].limits.effort = effort;
    CarryRest(project);
    return project;
  };
  const double enough = std::abs(torques[c]) / 0.79;
  EXPECT_EQ(with_effort(enough).tree.joints[Size(lift)].limits.effort, enough);
  EXPECT_TRUE(with_effort(enough).tree.warnings.empty());
  const Project weak = with_effort(std::abs(torques[c]) / 0.87);
  EXPECT_NEAR(weak.tree.joints[Size(lift)].limits.effort, std::abs(torques[c]) / 0.8, 1e-9);
  ASSERT_EQ(weak.tree.warnings.size(), 1u);
  EXPECT_NE(weak.tree.warnings[0].find("joint 'elbow_joint': gravity takes"), std::string::npos);
}

TEST(ProjectModel, AJointThatCountsTurnsIsMovedAboutItsPositionOfRest) {
  const ScratchFolder folder;
  const std::string joint =
      "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='revolute'>"
      "<parent link='a'/><child link='b'/><limit lower='-6.28318' upper='6.28318' effort='1' "
      "velocity='1'/></joint></robot>";
  folder.Write("r.urdf", joint);
  const auto parse = [&](const std::string& design) {
    return ReadProject(folder.Write(
        "p.yaml",
        "robot: {urdf: r.urdf}\nmarkers: {single: [{name: M, link: b, position_mm: [1, 2, "
        "3]}]}\ndesign: {limit_margin: 0, " +
            design + "}\n"));
  };
  const Project usual = parse("rest_deg: {j: 0}");
  EXPECT_DOUBLE_EQ(usual.motion.lower[0], -M_PI);
  const Project turned = parse("rest_deg: {j: 200}");
  EXPECT_NEAR(turned.motion.lower[0], 0.0, 1e-4);  // as far as its limit allows
  EXPECT_NEAR(turned.motion.upper[0], 2.0 * M_PI, 1e-4);
  EXPECT_DOUBLE_EQ(turned.motion.rest[0], 200.0 * M_PI / 180.0);
  ExpectInputError([&] { parse("rest_deg: {j: 200}, range_deg: {j: [10, 20]}"); },
                   {"p.yaml:3: ", "10 to 20"});
  const Project narrow = parse("range_deg: {j: [190, 270]}");  // this range selects the turn too
  EXPECT_DOUBLE_EQ(narrow.motion.lower[0], 190.0 * M_PI / 180.0);
  EXPECT_DOUBLE_EQ(narrow.motion.upper[0], 270.0 * M_PI / 180.0);
}

TEST(ProjectModel, SingleMarkersOfOneLinkAreACluster) {
  const ScratchFolder folder;
  folder.Write("r.urdf",
               "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='revolute'>"
               "<parent link='a'/><child link='b'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' "
               "effort='1' velocity='1'/></joint></robot>");
  const Project project = ReadProject(folder.Write("p.yaml", R"(
robot: {urdf: r.urdf}
markers:
  clusters: [{name: C, link: b, positions_mm: [[100, 0, 0], [0, 90, 0], [0, 0, 80]]}]
  single:
    - {name: M, link: b, position_mm: [50, 60, 70]}
    - {name: N, link: a, position_mm: [50, 60, 70]}
    - {name: O, link: b, position_mm: [150, 60, 70]}
)"));
  const std::vector<MarkerCluster> clusters = RigidClusters(project);
  ASSERT_EQ(clusters.size(), 2u);
  EXPECT_EQ(clusters[0].name, "C");
  EXPECT_EQ(clusters[1].name, "b");
  EXPECT_EQ(clusters[1].markers, (std::vector<int>{3, 5}));
  Project other = project;
  other.clusters[0].name = "b";
  EXPECT_EQ(RigidClusters(other)[1].name, "b_single");
}

TEST(ProjectModel, JointsOfARecordingBendWhereTheyTwist) {
  const auto bending = [](const std::string& more, const std::vector<Trial>& trials) {
    const ErrorModel model = MakeProjectModel(ParseArm(more), trials);
    std::set<std::string> joints;
    for (const Parameter& parameter : model.parameters) {
      if (parameter.kind == ParameterKind::kBending) {
        joints.insert(model.tree.joints[static_cast<std::size_t>(parameter.joint)].name);
      }
    }
    return joints;
  };
  const std::vector<Trial> held(1);
  const std::set<std::string> all = bending("", held);
  EXPECT_TRUE(all.contains("elbow_joint"));
  EXPECT_FALSE(all.contains("rail_joint"));  // it slides
  EXPECT_GE(all.size(), 5u);
  EXPECT_EQ(bending("elasticity: {torsion: [elbow_joint]}", held),
            std::set<std::string>{"elbow_joint"});
  EXPECT_TRUE(bending("elasticity: {bending: []}", held).empty());
  EXPECT_TRUE(bending("", {}).empty());  // for a table, the data decide
  EXPECT_TRUE(bending("elasticity: {torsion: [elbow_joint]}", {}).empty());
}

}  // namespace
}  // namespace elastocal
