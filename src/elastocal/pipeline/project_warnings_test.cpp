// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/project_warnings.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

std::string Joint(const std::string& name, const std::string& parent, const std::string& limit,
                  const std::string& inertial) {
  return "<link name='" + name + "'>" + inertial + "</link><joint name='" + name +
         "_joint' type='revolute'><parent link='" + parent + "'/><child link='" + name +
         "'/><origin xyz='0 0 0.3'/><axis xyz='0 1 0'/><limit " + limit +
         " velocity='1' effort='1'/></joint>";
}

constexpr const char* kSolid =
    "<inertial><mass value='1'/><inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' "
    "iyz='0'/></inertial>";
constexpr const char* kImpossible =
    "<inertial><mass value='1'/><inertia ixx='0.1' iyy='0.1' izz='0.5' ixy='0' ixz='0' "
    "iyz='0'/></inertial>";

std::vector<std::string> Warnings(const std::string& tip_limit, const std::string& inertial,
                                  const std::string& positions, const std::string& more = "") {
  const ScratchFolder folder;
  folder.Write("arm.urdf", "<robot name='arm'><link name='base'/>" +
                               Joint("upper", "base", "lower='-1' upper='1'", kSolid) +
                               Joint("hand", "upper", tip_limit, inertial) + "</robot>");
  return ProjectWarnings(ReadProject(folder.Write(
      "project.yaml",
      "robot: {urdf: arm.urdf}\nchains: [{name: arm, tip: hand}]\nmarkers: {clusters: [{name: UP, "
      "link: upper, positions_mm: " +
          positions + "}]}\n" + more)));
}

bool Says(const std::vector<std::string>& warnings, const std::string& text) {
  return std::any_of(warnings.begin(), warnings.end(), [&](const std::string& warning) {
    return warning.find(text) != std::string::npos;
  });
}

TEST(ProjectWarnings, NameWhatCostsSomething) {
  const std::string free = "lower='-1' upper='1'";
  const std::string good = "[[0, 0, 0], [100, 0, 0], [30, 60, 0]]";
  const auto fine = Warnings(free, kSolid, good);
  ASSERT_EQ(fine.size(), 1U);  // the hand has no marker
  EXPECT_NE(fine[0].find("no marker moves with hand_joint"), std::string::npos) << fine[0];
  EXPECT_TRUE(Says(Warnings("lower='0' upper='0'", kSolid, good), "'hand_joint': its lower"));
  EXPECT_TRUE(Says(Warnings(free, kImpossible, good), "'hand': no body has"));
  EXPECT_TRUE(Says(Warnings(free, "", good), "'hand': it has no mass"));
  EXPECT_TRUE(Says(Warnings(free, kSolid, "[[0, 0, 0], [100, 0, 0], [50, 87, 0]]"), "alike"));
  EXPECT_TRUE(Says(Warnings(free, kSolid, "[[0, 0, 0], [100, 0, 0], [40, 1, 0]]"), "in a line"));
  EXPECT_TRUE(Says(Warnings(free, kSolid, "[[0, 0, 0], [1, 0, 0], [0, 0.7, 0]]"), "0.7 mm apart"));
  EXPECT_TRUE(
      Says(Warnings(free, kSolid, "[[5000, 0, 0], [5100, 0, 0], [5030, 60, 0]]"), "5100 mm from"));
}

TEST(ProjectWarnings, NameMarkersInsideOtherLinks) {
  // The hand's origin is 600 mm above the origin of the base, and 300 mm above that of the next
  // body.
  const std::string hand =
      "collision: {spheres: [{name: palm, link: hand, centre_mm: [0, 0, 0], radius_mm: 100}]}\n";
  const auto warned = [&](const std::string& third, const std::string& low) {
    const std::string markers = "[[0, 0, 0], [100, 0, 0], " + third +
                                "]}], single: [{name: LOW, link: base, position_mm: " + low;
    return Warnings("lower='-1' upper='1'", kSolid, markers, hand);
  };
  EXPECT_TRUE(Says(warned("[30, 60, 0]", "[0, 30, 600]"),
                   "'LOW': at rest it is 70 mm inside the sphere 'palm'"));
  EXPECT_FALSE(Says(warned("[30, 60, 0]", "[0, 60, 600]"), "'LOW'"));  // less than half the radius
  EXPECT_FALSE(Says(warned("[0, 30, 300]", "[0, 0, 0]"), "'UP_3'"));   // neighbours overlap
}

// The forearm clusters of the embedded humanoid have sides of 57.7 and 57.8 mm. There is nothing
// else to report.
TEST(ProjectWarnings, AllThatIsSaidOfTheEmbeddedHumanoidIsTrue) {
  const auto warnings = ProjectWarnings(ReadProject(SourceFile("models/talos/project.yaml")));
  ASSERT_EQ(warnings.size(), 2U);
  for (const std::string& warning : warnings) {
    EXPECT_NE(warning.find("FOREARM': two distances are alike, 57.7 and 57.8 mm"),
              std::string::npos)
        << warning;
  }
}

}  // namespace
}  // namespace elastocal
