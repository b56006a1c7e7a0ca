// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/root_attitude.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/drafting/body_shapes.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/test_files.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

struct ReadRobot {
  std::string urdf;
  RobotTree tree;
  RobotShapes shapes;
};

ReadRobot Read(const std::string& urdf) {
  ReadRobot robot{urdf, ParseUrdf(urdf, "robot.urdf"), {}};
  robot.shapes = ReadBodyShapes(robot.tree, urdf, "robot.urdf", {});
  return robot;
}

std::optional<RootAttitude> AttitudeOf(const ReadRobot& robot) {
  return FindRootAttitude(robot.tree, robot.shapes, {});
}

std::vector<std::string> LimbNames(const ReadRobot& robot) {
  std::vector<std::string> names;
  for (const Limb& limb : FindLimbs(robot.tree, robot.shapes, {}).limbs) names.push_back(limb.name);
  return names;
}

/// The URDF with names of which no word tells a side or a limb; its feet reach as far back as
/// ahead, so that knees alone tell what is ahead.
std::string Nameless(std::string urdf) {
  for (const std::string word : {"left", "right", "arm", "leg", "gripper", "sole"}) {
    const std::string other(word.rbegin(), word.rend());
    for (std::size_t at = 0; (at = urdf.find(word, at)) != std::string::npos; at += word.size()) {
      urdf.replace(at, word.size(), other);
    }
  }
  return urdf;
}

// The embedded humanoid as CAD programs may export it: it looks along y or between the axes, stands
// along y or hangs along z, and the root link may be beside its middle.
TEST(RootAttitude, OfAHumanoidThatLooksElsewhere) {
  const ReadRobot plain = Read(Nameless(ReadFile(SourceFile("models/talos/talos.urdf"))));
  EXPECT_FALSE(AttitudeOf(plain));
  for (const Transform& T_root_plain :
       {RotZ(M_PI / 2.0), RotZ(-M_PI / 2.0), RotZ(0.7), RotX(-M_PI / 2.0), RotX(M_PI / 2.0),
        RotX(-M_PI / 2.0) * RotZ(M_PI / 2.0), RotX(M_PI) * RotZ(M_PI / 2.0),
        Offset(0.0, 0.3, 0.0)}) {
    const ReadRobot cad = Read(AddRootLink(plain.urdf, plain.tree, {T_root_plain, "cad"}));
    const auto attitude = AttitudeOf(cad);
    ASSERT_TRUE(attitude);
    const Transform off =
        attitude->T_new_root * T_root_plain;  // as the plain robot is, but along x
    EXPECT_LT((off.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-3);
    EXPECT_LT(std::abs(off.translation().y()), 1e-3);
    const ReadRobot mended = Read(AddRootLink(cad.urdf, cad.tree, *attitude));
    EXPECT_EQ(LimbNames(mended), LimbNames(plain));
    EXPECT_FALSE(AttitudeOf(mended));
  }
}

}  // namespace
}  // namespace elastocal
