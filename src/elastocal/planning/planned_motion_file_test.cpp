// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/planned_motion_file.hpp"

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
  // Twelve digits are written.
  EXPECT_LT((read.q - planned.motion.q).cwiseAbs().maxCoeff(), 1e-11);
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
