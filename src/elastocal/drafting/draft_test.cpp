// SPDX-License-Identifier: Apache-2.0
// Drafted projects: the embedded humanoid, compared with its hand-written project, and small robots
// that are written here.
#include "elastocal/drafting/draft.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/tables/read_file.hpp"
#include "elastocal/tables/text.hpp"
#include "tests/draft_files.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/test_robots.hpp"

namespace elastocal {
namespace {

double Length(const Project& project, int marker, int other) {
  return (project.markers[Size(marker)].p_link_marker - project.markers[Size(other)].p_link_marker)
      .norm();
}

TEST(DraftStudy, TalosHasTheLimbsOfItsHandWrittenProject) {
  const ScratchFolder folder;
  const Project drafted = ReadBack(DraftFile("models/talos/talos.urdf"), folder);
  const Project written = ReadProject(SourceFile("models/talos/project.yaml"));
  EXPECT_EQ(drafted.markers.size(), written.markers.size());
  // Chains are compared by their end links and their number of markers.
  const auto ends = [](const Project& project) {
    std::map<std::pair<std::string, std::string>, std::size_t> found;
    for (const Chain& chain : project.chains) {
      found[{project.tree.links[Size(chain.from_link)].name,
             project.tree.links[Size(chain.tip_link)].name}] = ChainMarkers(project, chain).size();
    }
    return found;
  };
  EXPECT_EQ(ends(drafted), ends(written));
  // Each sole is a box of 210 x 130 mm. The links of the soles are in the URDF.
  ASSERT_EQ(drafted.soles.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(drafted.tree.links[Size(drafted.soles[i].link)].name,
              written.tree.links[Size(written.soles[i].link)].name);
    EXPECT_LT((drafted.soles[i].lower - written.soles[i].lower).norm(), 1e-9);
    EXPECT_LT((drafted.soles[i].upper - written.soles[i].upper).norm(), 1e-9);
  }
  ASSERT_EQ(drafted.motion.chains.size(), 3U);
  EXPECT_EQ(drafted.motion.chains[1].mirror, "right_arm");
  EXPECT_EQ(drafted.motion.chains[2].mirror, "right_leg");
}

TEST(DraftStudy, ClustersAreFatTrianglesOfDifferentSides) {
  for (const char* robot :
       {"models/talos/talos.urdf", "tests/robots/mini_humanoid.urdf", "tests/robots/arm6.urdf"}) {
    const ScratchFolder folder;
    const Project project = ReadBack(DraftFile(robot), folder);
    std::size_t different = 0;
    for (const MarkerCluster& cluster : project.clusters) {
      const std::vector<int>& m = cluster.markers;
      std::array<double, 3> sides = {Length(project, m[0], m[1]), Length(project, m[1], m[2]),
                                     Length(project, m[2], m[0])};
      std::sort(sides.begin(), sides.end());
      // The ratio is 0.75, or 0.88 where a shape allows no other. Rounding to millimetres changes
      // it a little, since sides are 20 mm and more.
      EXPECT_LT(sides[0], 0.93 * sides[1]) << robot << " " << cluster.name;
      EXPECT_LT(sides[1], 0.93 * sides[2]) << robot << " " << cluster.name;
      different += sides[0] < 0.8 * sides[1] && sides[1] < 0.8 * sides[2] ? 1 : 0;
      // Heron's formula gives the height above the longest side.
      const double s = 0.5 * (sides[0] + sides[1] + sides[2]);
      const double area = std::sqrt(s * (s - sides[0]) * (s - sides[1]) * (s - sides[2]));
      EXPECT_GT(2.0 * area / sides[2], 0.3 * sides[2]) << robot << " " << cluster.name;
    }
    EXPECT_GT(different, project.clusters.size() * 3 / 4) << robot;
  }
}

// A calibration moves hands and feet of robots of any size by some millimetres, and joints by some
// degrees; the nominal robot must not be planned to where the corrected one cannot follow.
TEST(DraftStudy, LeavesRoomForCorrections) {
  const ScratchFolder folder;
  const ProjectDraft draft = DraftFile("models/talos/talos.urdf");
  const Project project = ReadBack(draft, folder);
  const auto of = [&](const std::string& joint) {
    return draft.tree.joints[Size(FindJoint(draft.tree, joint))].coordinate;
  };
  const auto degrees = [](double angle) { return angle / kRadiansPerDegree; };
  for (const std::string side : {"left", "right"}) {
    const int knee = of("leg_" + side + "_4_joint"), elbow = of("arm_" + side + "_4_joint");
    EXPECT_NEAR(degrees(draft.bent_ranges.at(knee)[0]), 30.0, 8.0);
    EXPECT_NEAR(degrees(draft.bent_ranges.at(elbow)[1]), -40.0, 8.0);
    EXPECT_NEAR(project.motion.lower[knee], draft.bent_ranges.at(knee)[0], 1e-3);
    EXPECT_NEAR(project.motion.upper[elbow], draft.bent_ranges.at(elbow)[1], 1e-3);
    EXPECT_GE(draft.rest.q[knee], draft.bent_ranges.at(knee)[0]);
    EXPECT_LE(draft.rest.q[elbow], draft.bent_ranges.at(elbow)[1]);
  }
  // Zeros of 0.5 degrees at six joints of a leg add up.
  for (const auto& [c, room] : draft.room) {
    EXPECT_GT(degrees(room), 1.4) << c;
    EXPECT_LT(degrees(room), 6.1) << c;
  }
  for (const std::string joint : {"leg_left_6_joint", "arm_left_4_joint"}) {
    std::string other = joint;
    other.replace(other.find("left"), 4, "right");
    EXPECT_EQ(draft.room.at(of(joint)), draft.room.at(of(other)));
  }
  EXPECT_GT(draft.sphere_margin, 0.008);
  const ProjectDraft small = DraftFile("tests/robots/mini_humanoid.urdf");
  EXPECT_GT(small.sphere_margin, 1.5 * 0.004 * LongestBranch(small.tree));
}

/// Names of the limbs of the pole with the additional links `more`.
std::vector<std::string> LimbsOfPole(const std::string& more) {
  std::vector<std::string> names;
  const std::string urdf = PoleUrdf("<box size='0.3 0.3 0.3'/>", "20", more);
  for (const Limb& limb : DraftProject(urdf, "pole.urdf", {}).limbs.limbs) {
    names.push_back(limb.name);
  }
  return names;
}

/// A joint with a limit at zero rests so far from it that `--limit-margin-deg 6` leaves it room.
TEST(Draft, TheRestOfAnElbowKeepsAwayFromItsLimit) {
  std::string urdf = PoleUrdf("<box size='0.3 0.3 0.3'/>", "20");
  for (const char* joint : {"l2_joint", "r2_joint"}) {
    const std::size_t at = urdf.find("lower='-1' upper='1'", urdf.find(joint));
    urdf.replace(at, 20, "lower='-2' upper='0'");
  }
  const ProjectDraft draft = DraftProject(urdf, "pole.urdf", {});
  const auto rest = [&](const char* joint) {
    return draft.rest.q[draft.tree.joints[Size(FindJoint(draft.tree, joint))].coordinate];
  };
  // The distance is 2.1 % of the range and 10 degrees. A joint whose zero is far from its limits
  // rests at zero.
  EXPECT_NEAR(rest("l2_joint"), -(0.042 + 10.0 * kRadiansPerDegree), 1e-3);
  EXPECT_EQ(rest("l1_joint"), 0.0);
}

TEST(Draft, MissingMeshesAreOneWarning) {
  const ScratchFolder folder;
  const std::string mesh = "<mesh filename='package://pole/arm.stl'/>";
  std::string urdf = PoleUrdf(mesh, "10");
  const std::size_t link = urdf.find("</link>", urdf.find("name='l1'"));
  urdf.insert(link,
              "<visual><geometry><mesh filename='package://pole/hand.stl'/></geometry></visual>");
  const ProjectDraft draft = DraftProject(urdf, "pole", {});
  EXPECT_TRUE(draft.shapes.bodies[0].guessed);
  ASSERT_FALSE(draft.warnings.empty());
  EXPECT_EQ(draft.warnings[0],
            "meshes of package 'pole' are missing: 2, the first one 'package://pole/arm.stl'; give "
            "its folder by --package pole=DIR");
  // The mesh is in millimetres, and no scale says so.
  folder.Write("arm.stl",
               "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 200 0 0\nvertex 0 200 "
               "0\nendloop\nendfacet\nendsolid\n");
  MeshPlaces places;
  places.packages["pole"] = folder.path();
  const ProjectDraft large = DraftProject(PoleUrdf(mesh, "10"), "pole", {}, places);
  EXPECT_TRUE(large.shapes.bodies[0].guessed);
  EXPECT_NE(large.warnings[0].find("200 m"), std::string::npos) << large.warnings[0];
}

// Waist and neck carry two arms and two ears, so that both are trunks. Their chains had one name.
TEST(Draft, EachTrunkHasAChainOfItsOwnName) {
  const std::string urdf =
      "<robot name='r'><link name='base'><inertial><mass value='20'/><inertia ixx='1' iyy='1' "
      "izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>" +
      RodXml("waist", "base", "0 0 0.3") + RodXml("l1", "waist", "0.2 0.2 0.3") +
      RodXml("l2", "l1", "0.2 0 0.3") + RodXml("r1", "waist", "0.2 -0.2 0.3") +
      RodXml("r2", "r1", "0.2 0 0.3") + RodXml("neck", "waist", "0 0 0.5") +
      RodXml("ear_l", "neck", "0 0.1 0.1") + RodXml("ear_r", "neck", "0 -0.1 0.1") + "</robot>";
  ProjectDraft draft = DraftProject(urdf, "r.urdf", {});
  std::vector<std::string> trunks;
  for (const DraftedChain& chain : draft.chains) {
    if (chain.trunk) trunks.push_back(chain.name);
  }
  EXPECT_EQ(trunks, (std::vector<std::string>{"torso", "torso_2"}));
  const ScratchFolder folder;
  const Project project = ReadBack(draft, folder);
  EXPECT_EQ(project.chains.size(), draft.chains.size());
  const std::filesystem::path written = folder.Write("r.urdf", draft.urdf);
  EXPECT_NO_THROW(RequireReadable(draft, "project.yaml", written));
  draft.chains.push_back(draft.chains.front());
  ExpectInputError([&] { RequireReadable(draft, "project.yaml", written); },
                   {"no project that can be read", "nothing is written", "project.yaml:"});
}

TEST(DraftStudy, PartsThatAreCheckedAreApartAtRestAndTheSolesLieFlat) {
  for (const char* robot : {"models/talos/talos.urdf", "tests/robots/mini_humanoid.urdf"}) {
    const ScratchFolder folder;
    const Project project = ReadBack(DraftFile(robot), folder);
    const auto poses = LinkTransforms(project.tree, project.motion.rest);
    for (const ChainSetup& chain : project.motion.chains) {
      if (chain.contacts.empty()) continue;
      EXPECT_GE(SphereDistances(project.motion.spheres, chain.contacts, poses).minCoeff(),
                project.motion.sphere_margin - 1e-4)
          << robot;
    }
    const auto zero =
        LinkTransforms(project.tree, Eigen::VectorXd::Zero(project.tree.coordinate_count()));
    for (const Sole& sole : project.soles) {
      // Angles are written to a thousandth of a degree.
      EXPECT_LT(RotationAngle(poses[Size(sole.link)].linear() *
                              zero[Size(sole.link)].linear().transpose()),
                1e-4);
      EXPECT_GT(poses[Size(sole.link)].translation().z(),
                zero[Size(sole.link)].translation().z() + 0.01);
    }
  }
}

TEST(Draft, WheelsAreNoLimbsAndALongBranchIsAnArm) {
  // The left branch of the pole gets two more joints, and the pole gets two wheels.
  const std::string more = RodXml("l3", "l2", "0.2 0 0") + RodXml("l4", "l3", "0.2 0 0") +
                           RodXml("wheel_l", "pole", "0 0.2 -0.1", "continuous") +
                           RodXml("wheel_r", "pole", "0 -0.2 -0.1", "continuous");
  EXPECT_EQ(LimbsOfPole(more), (std::vector<std::string>{"head", "arm"}));
  // If nothing else moves, even a joint that turns without an end is a limb.
  const std::string alone = "<robot name='a'><link name='pole'/>" +
                            RodXml("plate", "pole", "0 0 1", "continuous") + "</robot>";
  EXPECT_EQ(DraftProject(alone, "a.urdf", {}).limbs.limbs.size(), 1u);
}

// Pepper is such a robot: its base is the end of its leg.
TEST(Draft, WheelsBesideEachOtherAreNoLimbsWhereverTheyAre) {
  const std::string more = RodXml("hip", "pole", "0 0 -0.2") + RodXml("base", "hip", "0 0 -0.3") +
                           RodXml("wheel_l", "base", "0 0.2 -0.1", "continuous") +
                           RodXml("wheel_r", "base", "0 -0.2 -0.1", "continuous");
  EXPECT_EQ(LimbsOfPole(more), (std::vector<std::string>{"left_arm", "right_arm", "leg"}));
}

// The HSR is such a robot: its turning base carries casters of three joints each.
TEST(Draft, CastersAndWhatCarriesNothingElseAreNoLimbs) {
  const std::string caster = RodXml("base", "pole", "0 0 -0.2", "continuous") +
                             RodXml("caster_x", "base", "0 0.2 0", "continuous") +
                             RodXml("caster_y", "caster_x", "0 0.01 0", "continuous") +
                             RodXml("caster_z", "caster_y", "0 0.01 0", "continuous");
  EXPECT_EQ(LimbsOfPole(caster), (std::vector<std::string>{"left_arm", "right_arm"}));
}

TEST(DraftStudy, ASoleWithoutALinkIsAddedToTheUrdf) {
  std::string urdf = ReadFile(SourceFile("models/talos/talos.urdf"));
  for (const std::string side : {"left", "right"}) {
    for (const std::string& element :
         {"<link name=\"" + side + "_sole_link\"/>",
          "<joint name=\"leg_" + side + R"(_sole_fix_joint" type="fixed">)"}) {
      const std::size_t begin = urdf.find(element);
      ASSERT_NE(begin, std::string::npos) << element;
      const bool joint = element.starts_with("<joint");
      const std::size_t end = joint ? urdf.find("</joint>", begin) + 8 : begin + element.size();
      urdf.erase(begin, end - begin);
    }
  }
  const ScratchFolder folder;
  const Project project = ReadBack(DraftProject(urdf, "talos.urdf", {}), folder);
  const auto zero =
      LinkTransforms(project.tree, Eigen::VectorXd::Zero(project.tree.coordinate_count()));
  ASSERT_EQ(project.soles.size(), 2U);
  for (const Sole& sole : project.soles) {
    EXPECT_TRUE(project.tree.links[Size(sole.link)].name.ends_with("_leg_sole"));
    // Depths of hip, knee, ankle and underside of the foot's box: -0.27105 - 0.38 - 0.325 - 0.107.
    EXPECT_NEAR(zero[Size(sole.link)].translation().z(), -1.08305, 1e-6);
    EXPECT_NEAR((sole.upper - sole.lower).x(), 0.210, 1e-3);
    EXPECT_NEAR((sole.upper - sole.lower).y(), 0.130, 1e-3);
  }
}

TEST(Draft, AShapeThatIsTooLightForItsSizeIsLeftOut) {
  const std::string box = "<box size='0.2 0.3 0.4'/>";  // 24 litres
  EXPECT_FALSE(DraftProject(PoleUrdf(box, "10"), "pole", {}).shapes.bodies[0].guessed);
  const ProjectDraft light = DraftProject(PoleUrdf(box, "0.4"), "pole", {});
  EXPECT_TRUE(light.shapes.bodies[0].guessed);
  ASSERT_FALSE(light.warnings.empty());
  EXPECT_NE(light.warnings[0].find("24 litres"), std::string::npos) << light.warnings[0];
  EXPECT_THROW(DraftProject(PoleUrdf("<sphere radius='1e9'/>", "10"), "pole", {}), InputError);
}

TEST(Draft, NamesRestAndPairsComeFromTheSrdf) {
  const std::string urdf = PoleUrdf("<sphere radius='0.1'/>", "10");
  const Semantics semantics = ParseSemantics(
      "<robot name='pole'><group name='west wing'><joint name='l1_joint'/><joint "
      "name='l2_joint'/></group><group_state name='home' group='west wing'><joint "
      "name='l2_joint' value='0.5'/><joint name='root' value='0 0 1'/></group_state>"
      "<disable_collisions link1='l2' link2='pole' reason='Never'/></robot>",
      "pole.srdf");
  const ProjectDraft draft = DraftProject(urdf, "pole", semantics);
  ASSERT_EQ(draft.chains.size(), 2U);
  EXPECT_EQ(draft.chains[0].name, "west_wing");
  EXPECT_EQ(draft.chains[1].name, "right_arm");
  EXPECT_EQ(draft.rest.q[1], 0.5);
  EXPECT_EQ(draft.rest.source, "the state 'home' of the SRDF");
  EXPECT_EQ(semantics.apart.count({"l2", "pole"}), 1U);
  EXPECT_TRUE(draft.rest.warnings.empty());
  EXPECT_THROW(ParseSemantics("<robot><group/></robot>", "x.srdf"), InputError);
  EXPECT_THROW(ParseSemantics("<srdf/>", "x.srdf"), InputError);
  EXPECT_THROW(ParseSemantics(urdf, "a URDF"), InputError);
}

TEST(Draft, SectionsOfATelescopeAreNotChecked) {
  const auto pairs = [](const Eigen::Vector3d& third_axis, JointType third_type) {
    RobotTree tree = MakeRoot();
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
    int link = AddJoint(tree, "first", 0, Offset(0, 0, 0), x, JointType::kPrismatic);
    link = AddJoint(tree, "second", link, Offset(0, 0, 0), x, JointType::kPrismatic);
    const int tip = AddJoint(tree, "third", link, Offset(0, 0, 0), third_axis, third_type);
    const std::vector<CollisionSphere> spheres = {{"root", 0, {0, 0, 0}, 0.1},
                                                  {"tip", tip, {0, 0, 0}, 0.1}};
    return PairsMovedBy(tree, spheres, {0, 1, 2}, {}).size();
  };
  EXPECT_EQ(pairs(Eigen::Vector3d::UnitX(), JointType::kPrismatic), 0U);
  EXPECT_EQ(pairs(Eigen::Vector3d::UnitY(), JointType::kPrismatic), 1U);
  EXPECT_EQ(pairs(Eigen::Vector3d::UnitX(), JointType::kRevolute), 1U);
}

TEST(Draft, PairsThatTouchInAnyPostureOfRestAreNotChecked) {
  const RobotTree tree = ParseUrdf(PoleUrdf("<sphere radius='0.1'/>", "10"), "pole");
  // The spheres are 2 mm apart in the zero posture, and further apart if one arm is raised.
  const std::vector<CollisionSphere> spheres = {{"L", FindLink(tree, "l1"), {0.2, 0, 0}, 0.199},
                                                {"R", FindLink(tree, "r1"), {0.2, 0, 0}, 0.199}};
  ChainSetup chain;
  chain.tip_link = FindLink(tree, "l2");
  chain.coordinates = {0, 1};
  Eigen::VectorXd raised = Eigen::VectorXd::Zero(tree.coordinate_count());
  raised[0] = 0.8;
  const ContactSearch one = FindContacts(tree, spheres, {{0, 1}}, {raised}, chain, 0.005);
  EXPECT_EQ(one.pairs.size(), 1U);
  EXPECT_TRUE(one.touching_at_rest.empty());
  const ContactSearch two =
      FindContacts(tree, spheres, {{0, 1}}, {raised, 0.0 * raised}, chain, 0.005);
  EXPECT_TRUE(two.pairs.empty());
  EXPECT_EQ(two.touching_at_rest, (std::vector<SpherePair>{{0, 1}}));
}

TEST(Draft, SaysWhereTheSrdfBreaksLimitsOfTheUrdf) {
  const Semantics semantics = ParseSemantics(
      "<robot name='pole'><group_state name='home' group='all'><joint name='l1_joint' value='0.1'/>"
      "<joint name='l2_joint' value='40'/></group_state></robot>",
      "pole.srdf");
  const ProjectDraft draft =
      DraftProject(PoleUrdf("<sphere radius='0.1'/>", "10"), "pole", semantics);
  ASSERT_EQ(draft.rest.warnings.size(), 1U);
  EXPECT_EQ(draft.rest.warnings[0],
            "the state 'home' of the SRDF has joint " + Quote("l2_joint") +
                " at 2291.8 deg, outside the limits of the URDF, -57.3 to 57.3; one of the two is "
                "wrong");
  const auto& all = draft.warnings;
  EXPECT_EQ(std::count(all.begin(), all.end(), draft.rest.warnings[0]), 1);
}

TEST(DraftStudy, TheSameTextGivesTheSameDraft) {
  const std::string first = FormatDraft(DraftFile("tests/robots/mini_humanoid.urdf"), "a");
  EXPECT_EQ(first, FormatDraft(DraftFileAnew("tests/robots/mini_humanoid.urdf"), "a"));
}

TEST(DraftStudy, OtherPeoplesRobotsCanBeReadBack) {
  const std::vector<std::pair<std::string, std::string>> robots = {
      {"talos/talos_full_v2.urdf", "talos/talos.srdf"},
      {"simple_humanoid/simple_humanoid.urdf", "simple_humanoid/simple_humanoid.srdf"},
      {"solo12/solo12.urdf", "solo12/solo.srdf"},
      {"panda/panda.urdf", "panda/panda.srdf"},
      {"tiago/tiago_arm.urdf", ""}};
  int found = 0;
  for (const auto& [urdf, srdf] : robots) {
    const auto file = SharedFile("robots/" + urdf);
    if (!std::filesystem::exists(file)) continue;
    ++found;
    Semantics semantics;
    if (!srdf.empty()) semantics = ParseSemantics(ReadFile(SharedFile("robots/" + srdf)), srdf);
    const ScratchFolder folder;
    const Project project = ReadBack(DraftProject(ReadFile(file), urdf, semantics), folder);
    EXPECT_FALSE(project.motion.chains.empty()) << urdf;
    for (const Chain& chain : project.chains) {
      EXPECT_GE(ChainMarkers(project, chain).size(), 3U) << urdf << " " << chain.name;
    }
  }
  if (found == 0) GTEST_SKIP() << "no shared robots";
}

}  // namespace
}  // namespace elastocal
