// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/soles.hpp"

#include <gtest/gtest.h>

#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/drafting/body_shapes.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// The soles of the legs, found without drafting the rest of the project.
std::vector<DraftedSole> SolesOf(const std::string& urdf) {
  const RobotTree tree = ParseUrdf(urdf, "robot.urdf");
  const RobotShapes shapes = ReadBodyShapes(tree, urdf, "robot.urdf", {});
  return FindSoles(tree, shapes, FindLimbs(tree, shapes, {}));
}

/// Removes the visual and collision shapes of a link from a URDF.
void RemoveShapes(const std::string& link, std::string& urdf) {
  const std::size_t begin = urdf.find("<link name=\"" + link + "\"");
  ASSERT_NE(begin, std::string::npos);
  for (const std::string shape : {"collision", "visual"}) {
    for (std::size_t at; (at = urdf.find("<" + shape, begin)) < urdf.find("</link>", begin);) {
      const std::string close = "</" + shape + ">";
      urdf.erase(at, urdf.find(close, at) + close.size() - at);
    }
  }
}

// The ankles of the Unitree R1 carry such frames, for its rods.
TEST(Soles, AFrameNearTheAnkleIsNoSole) {
  std::string urdf = ReadFile(SourceFile("models/talos/talos.urdf"));
  for (const std::string side : {"left", "right"}) {
    const std::size_t joint =
        urdf.find("<joint name=\"leg_" + side + R"(_sole_fix_joint" type="fixed">)");
    ASSERT_NE(joint, std::string::npos);
    const std::size_t xyz = urdf.find("xyz=\"", joint) + 5;
    urdf.replace(xyz, urdf.find('"', xyz + 1) - xyz, "0 0 -0.012");
    // Without shapes, the sole is a guess.
    RemoveShapes("leg_" + side + "_6_link", urdf);
  }
  const std::vector<DraftedSole> soles = SolesOf(urdf);
  ASSERT_EQ(soles.size(), 2u);
  EXPECT_TRUE(soles[0].added);
  EXPECT_TRUE(soles[0].guessed_height);
}

// Fourier's GR3 is such a robot: the shapes of its two feet are on different links.
TEST(Soles, AFootWithoutShapesHasTheSoleOfItsMirrorImage) {
  std::string urdf = ReadFile(SourceFile("models/talos/talos.urdf"));
  RemoveShapes("leg_right_6_link", urdf);
  const std::vector<DraftedSole> soles = SolesOf(urdf);
  ASSERT_EQ(soles.size(), 2u);
  EXPECT_FALSE(soles[1].guessed_size);
  EXPECT_FALSE(soles[1].guessed_height);
  EXPECT_EQ(soles[1].lower.x(), soles[0].lower.x());
  EXPECT_EQ(soles[1].lower.y(), -soles[0].upper.y());
  EXPECT_EQ(soles[1].upper.y(), -soles[0].lower.y());
}

// EngineAI's PM01 is such a robot: a small ball marks the middle of each foot, whose mesh is
// missing.
TEST(Soles, AMarkOnTheFootIsNotItsSole) {
  std::string urdf = ReadFile(SourceFile("models/talos/talos.urdf"));
  for (const std::string link : {"leg_left_6_link", "leg_right_6_link"}) {
    RemoveShapes(link, urdf);
    urdf.insert(urdf.find("</link>", urdf.find("<link name=\"" + link + "\"")),
                "<collision><origin xyz='0.02 0 -0.08'/><geometry><sphere "
                "radius='0.02'/></geometry></collision>");
  }
  const std::vector<DraftedSole> soles = SolesOf(urdf);
  ASSERT_EQ(soles.size(), 2u);
  EXPECT_TRUE(soles[0].guessed_size);
  EXPECT_EQ(soles[0].link, "left_sole_link");
  EXPECT_GT(soles[0].upper.x() - soles[0].lower.x(), 0.15);
}

// The feet of ergoCub have such frames, of sensors, at the height of the floor, ahead and behind.
TEST(Soles, OfLinksInTheFloorTheOneCalledSoleIsTheSole) {
  std::string urdf = ReadFile(SourceFile("models/talos/talos.urdf"));
  const std::string foot =
      "<link name='a_front'/><joint name='a_fixed' type='fixed'><parent "
      "link='left_sole_link'/><child link='a_front'/><origin xyz='0.05 0 -0.001'/></joint>";
  urdf.insert(urdf.rfind("</robot>"), foot);
  const std::vector<DraftedSole> soles = SolesOf(urdf);
  ASSERT_EQ(soles.size(), 2u);
  EXPECT_EQ(soles[0].link, "left_sole_link");
}

/// The embedded humanoid with a toe on each foot: a box, 70 mm long, as low as the foot.
std::string WithToes(std::string urdf, bool shapes) {
  const std::string shape =
      "<collision><origin xyz='0.035 0 0.015'/><geometry><box size='0.07 0.13 0.03'/></geometry>"
      "</collision>";
  for (const std::string side : {"left", "right"}) {
    const std::string name = "dedo_" + side;
    urdf.insert(urdf.rfind("</robot>"),
                "<link name='" + name +
                    "'><inertial><mass value='0.2'/><inertia ixx='1e-4' ixy='0' ixz='0' "
                    "iyy='1e-4' iyz='0' izz='1e-4'/></inertial>" +
                    (shapes ? shape : "") + "</link><joint name='" + name +
                    "' type='revolute'><parent link='" + side + "_sole_link'/><child link='" +
                    name +
                    "'/><origin xyz='0.105 0 0'/><axis xyz='0 -1 0'/><limit lower='-0.1' "
                    "upper='0.9' effort='20' velocity='5'/></joint>");
    if (!shapes) RemoveShapes("leg_" + side + "_6_link", urdf);
  }
  return urdf;
}

Limbs LimbsOf(const std::string& urdf, const Semantics& semantics = {}) {
  const RobotTree tree = ParseUrdf(urdf, "talos.urdf");
  return FindLimbs(tree, ReadBodyShapes(tree, urdf, "talos.urdf", {}), semantics);
}

// The SRDF's groups may go on to the toe, or end at the foot.
TEST(Limbs, LegsWithToesHaveTheNamesOfTheirGroups) {
  const std::string urdf = WithToes(ReadFile(SourceFile("models/talos/talos.urdf")), true);
  Semantics semantics;
  semantics.groups = {{"to_the_toe", "dedo_left", {}}, {"to_the_foot", "right_sole_link", {}}};
  std::vector<std::string> names;
  for (const Limb& limb : LimbsOf(urdf, semantics).limbs) {
    if (limb.leg) names.push_back(limb.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"to_the_toe", "to_the_foot"}));
}

// The right toe ends well above the floor, and no name tells that the body before it is the foot.
TEST(Limbs, ToesAreThoseOfBothLegsOrOfNone) {
  std::string urdf = WithToes(ReadFile(SourceFile("models/talos/talos.urdf")), true);
  EXPECT_EQ(LimbsOf(urdf).toes.size(), 2u);
  const std::string low = "<origin xyz='0.035 0 0.015'/>", sole = "right_sole_link";
  urdf.replace(urdf.rfind(low), low.size(), "<origin xyz='0.035 0 0.035'/>");
  for (std::size_t at; (at = urdf.find(sole)) != std::string::npos;) {
    urdf.replace(at, sole.size(), "right_floor");
  }
  EXPECT_EQ(LimbsOf(urdf).toes.size(), 0u);
}

// A toe ends the tree behind the foot, but nothing stands on toes alone.
TEST(Soles, AreThoseOfTheFeetWithoutToes) {
  const std::string plain = ReadFile(SourceFile("models/talos/talos.urdf"));
  const std::vector<DraftedSole> expected = SolesOf(plain);
  for (const bool shapes : {true, false}) {  // without its meshes, names tell
    const std::vector<DraftedSole> soles = SolesOf(WithToes(plain, shapes));
    ASSERT_EQ(soles.size(), 2u);
    for (const std::size_t i : {0u, 1u}) {
      EXPECT_EQ(soles[i].link, expected[i].link);
      EXPECT_TRUE(!shapes || soles[i].upper == expected[i].upper);
    }
  }
}

}  // namespace
}  // namespace elastocal
