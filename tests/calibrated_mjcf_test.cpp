// SPDX-License-Identifier: Apache-2.0
// Compares the exported MJCF in MuJoCo with the calibrated URDF.
#include "elastocal/description/calibrated_mjcf.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "elastocal/description/calibrated_urdf.hpp"
#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/description/urdf_writer.hpp"
#include "elastocal/files/output_files.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "tests/drawn_calibration.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// The bodies of joints on `parent_body`. Links on fixed joints belong to their body.
std::string BodyText(const RobotTree& tree, int parent_body) {
  std::string text;
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const Joint& joint = tree.joints[k];
    if (joint.parent_body != parent_body) continue;
    const Transform T =
        tree.links[static_cast<std::size_t>(joint.parent_link)].T_body_link * joint.T_parent_child;
    const Eigen::Quaterniond q(T.linear());
    text += fmt::format(
        "<body name=\"{}\" pos=\"{:.17g} {:.17g} {:.17g}\" quat=\"{:.17g} {:.17g} {:.17g} "
        "{:.17g}\">\n<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>\n"
        "<joint name=\"{}\" type=\"{}\" axis=\"{:.17g} {:.17g} {:.17g}\"/>\n",
        tree.links[static_cast<std::size_t>(joint.child_link)].name, T.translation().x(),
        T.translation().y(), T.translation().z(), q.w(), q.x(), q.y(), q.z(), joint.name,
        joint.type == JointType::kRevolute ? "hinge" : "slide", joint.axis.x(), joint.axis.y(),
        joint.axis.z());
    text += BodyText(tree, static_cast<int>(k) + 1) + "</body>\n";
  }
  return text;
}

std::string NominalMjcf(const RobotTree& tree, const std::string& compiler) {
  const auto root = std::find_if(tree.links.begin(), tree.links.end(), [](const Link& link) {
    return link.body == 0 && link.T_body_link.isApprox(Transform::Identity());
  });
  return "<mujoco>" + compiler + "<worldbody>\n<body name=\"" + root->name + "\">\n" +
         BodyText(tree, 0) + "</body>\n</worldbody></mujoco>\n";
}

using Model = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;

Model Load(const std::string& text) {
  const ScratchFolder folder;
  std::array<char, 1000> error{};
  const std::string file = folder.Write("robot.xml", text);
  return {mj_loadXML(file.c_str(), nullptr, error.data(), error.size()), &mj_deleteModel};
}

struct CalibratedMjcf {
  RobotTree nominal, calibrated;
  std::map<std::string, double> offsets;
  std::string text;
};

constexpr const char* kDegrees = "<compiler angle=\"degree\"/>";

/// Moves axis, type and zero of the first joint into a default class of its body.
std::string WithDefaultClass(std::string mjcf, const std::string& axis) {
  const std::size_t body = mjcf.find("<body", mjcf.find("<body") + 1);
  const std::size_t from = mjcf.find(" type=", body), to = mjcf.find("/>", from);
  std::string given = mjcf.substr(from, to - from);
  if (!axis.empty())
    given.replace(given.find(" axis"), std::string::npos, " axis=\"" + axis + "\"");
  mjcf.replace(from, to - from, "");
  mjcf.insert(body + 5, " childclass=\"inner\"");
  return mjcf.insert(mjcf.find("<worldbody>"),
                     R"(<default><joint ref="0.25"/><default class="outer"><joint axis="1 2 3")" +
                         given.substr(0, given.find(" axis")) +
                         R"(/><default class="inner"><joint)" + given.substr(given.find(" axis")) +
                         "/></default></default></default>");
}

CalibratedMjcf Export(const std::string& robot, const std::string& compiler) {
  const std::string urdf = ReadFile(SourceFile(robot));
  CalibratedMjcf result;
  result.nominal = ParseUrdf(urdf, robot);
  const CalibratedUrdf apart =
      MakeCalibratedUrdf(urdf, robot, WithErrors(result.nominal, 5), ZeroOffsets::kEncoder);
  result.calibrated = ParseUrdf(apart.text, "calibrated");
  result.offsets = apart.encoder_offsets;
  result.text = MakeCalibratedMjcf(NominalMjcf(result.nominal, compiler), "robot.xml",
                                   result.nominal, result.calibrated, result.offsets);
  return result;
}

/// MuJoCo's qpos is the encoder's position: the poses of bodies are those of the calibrated URDF at
/// q + offset.
void ExpectThatMujocoAgrees(const CalibratedMjcf& robot) {
  const Model model = Load(robot.text);
  ASSERT_NE(model, nullptr);
  const std::unique_ptr<mjData, decltype(&mj_deleteData)> data(mj_makeData(model.get()),
                                                               &mj_deleteData);
  Random random(2);
  for (int posture = 0; posture < 1000; ++posture) {
    const Eigen::VectorXd q = RandomPosture(robot.calibrated, random);
    Eigen::VectorXd encoders = q;
    for (const auto& [joint, offset] : robot.offsets) {
      const auto k = static_cast<std::size_t>(FindJoint(robot.calibrated, joint));
      encoders[robot.calibrated.joints[k].coordinate] -= offset;
    }
    for (const Joint& joint : robot.calibrated.joints) {
      const int id = mj_name2id(model.get(), mjOBJ_JOINT, joint.name.c_str());
      ASSERT_GE(id, 0) << joint.name;
      data->qpos[model->jnt_qposadr[id]] =
          joint.multiplier * encoders[joint.coordinate] + joint.offset;
    }
    mj_forward(model.get(), data.get());
    for (int i = 0; i < data->ne; ++i) EXPECT_NEAR(data->efc_pos[i], 0.0, 1e-12);
    const std::vector<Transform> T_root_link = LinkTransforms(robot.calibrated, q);
    for (const Joint& joint : robot.calibrated.joints) {
      const auto link = static_cast<std::size_t>(joint.child_link);
      const int body =
          mj_name2id(model.get(), mjOBJ_BODY, robot.calibrated.links[link].name.c_str());
      const Eigen::Map<const Eigen::Vector3d> position(data->xpos + 3 * body);
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(data->xmat + 9 * body);
      EXPECT_LT((position - T_root_link[link].translation()).norm(), 1e-9) << joint.name;
      EXPECT_LT((R - T_root_link[link].linear()).norm(), 1e-9) << joint.name;
    }
  }
}

TEST(CalibratedMjcf, MujocoStandsWhereTheCalibratedUrdfDoes) {
  ExpectThatMujocoAgrees(Export("tests/robots/arm6.urdf", kDegrees));
}

TEST(CalibratedMjcf, AnglesOfTheFileMayBeRadiansAndLinksMayFollowOthers) {
  ExpectThatMujocoAgrees(Export("tests/robots/mini_humanoid.urdf", "<compiler angle=\"radian\"/>"));
}

// A mimic joint follows what its leader's encoder shows, whether or not the model has an equality.
TEST(CalibratedMjcf, EqualitiesOfMimicJointsHoldAsBefore) {
  CalibratedMjcf robot = Export("tests/robots/mini_humanoid.urdf", "<compiler angle=\"radian\"/>");
  std::string equalities;
  for (const Joint& joint : robot.nominal.joints) {
    if (!joint.mimic) continue;
    const int leader = robot.nominal.coordinate_joint[static_cast<std::size_t>(joint.coordinate)];
    const std::string& name = robot.nominal.joints[static_cast<std::size_t>(leader)].name;
    EXPECT_GT(std::abs(robot.offsets.at(name)), 1e-3);
    equalities += fmt::format(R"(<joint joint1="{}" joint2="{}" polycoef="{} {} 0 0 0"/>)",
                              joint.name, name, joint.offset, joint.multiplier);
  }
  ASSERT_FALSE(equalities.empty());
  robot.text.insert(robot.text.find("</mujoco>"), "<equality>" + equalities + "</equality>");
  ExpectThatMujocoAgrees(robot);
}

// The file that includes this one may state the unit.
TEST(CalibratedMjcf, RangesOfJointsTellAnUnstatedUnit) {
  const std::string urdf = ReadFile(SourceFile("tests/robots/arm6.urdf"));
  const RobotTree tree = ParseUrdf(urdf, "arm6.urdf");
  const auto hinge = std::ranges::find(tree.joints, JointType::kRevolute, &Joint::type);
  const auto ref = [&](double unit) {
    std::string text = NominalMjcf(tree, "");
    if (unit > 0.0) {
      const std::string name = "name=\"" + hinge->name + "\"";
      text.insert(text.find(name), "range=\"" + std::to_string(hinge->limits.lower / unit) + " " +
                                       std::to_string(hinge->limits.upper / unit) + "\" ");
    }
    const std::string made =
        MakeCalibratedMjcf(text, "bodies.xml", tree, tree, {{hinge->name, -0.01}});
    const std::size_t at = made.find("ref=\"");
    return std::stod(made.substr(at + 5));
  };
  EXPECT_NEAR(ref(1.0), 0.01, 1e-12);
  EXPECT_NEAR(ref(M_PI / 180.0), 0.01 * 180.0 / M_PI, 1e-9);
  ExpectInputError([&] { ref(0.0); }, {"bodies.xml", "the unit of angles is unknown"});
  // Where no angle is written, no unit is needed.
  EXPECT_NE(MakeCalibratedMjcf(NominalMjcf(tree, ""), "bodies.xml", tree, tree, {}), "");
}

TEST(CalibratedMjcf, DefaultClassesSayWhatJointsAre) {
  const std::string urdf = ReadFile(SourceFile("tests/robots/arm6.urdf"));
  const RobotTree tree = ParseUrdf(urdf, "arm6.urdf");
  const std::string radians = "<compiler angle=\"radian\"/>";
  const std::string good = WithDefaultClass(NominalMjcf(tree, radians), "");
  const std::string& joint = tree.joints[0].name;
  const std::string text =
      MakeCalibratedMjcf(good, "a.xml", tree, tree, {{joint, 0.125}, {tree.joints[1].name, 0.5}});
  // Without the class, the first joint would have MuJoCo's default axis and a zero of 0.
  const Model model = Load(text);
  ASSERT_NE(model, nullptr);
  const int id = mj_name2id(model.get(), mjOBJ_JOINT, joint.c_str());
  EXPECT_NEAR(model->qpos0[model->jnt_qposadr[id]], 0.25 - 0.125, 1e-12);
  const auto refused = [&](const std::string& model_text, const std::string& words) {
    ExpectInputError([&] { MakeCalibratedMjcf(model_text, "a.xml", tree, tree, {}); }, {words});
  };
  refused(WithDefaultClass(NominalMjcf(tree, radians), "0 0 -1"), "the axis of joint");
  std::string other = good;
  refused(other.replace(other.find("\"slide\""), 7, "\"hinge\""), "is a hinge");
  other = good;
  refused(other.replace(other.find("childclass=\"inner\""), 18, "childclass=\"none\""),
          "no default class 'none'");
}

TEST(CalibratedMjcf, NamesWhatDoesNotBelongToTheUrdf) {
  const std::string urdf = ReadFile(SourceFile("tests/robots/arm6.urdf"));
  const RobotTree tree = ParseUrdf(urdf, "arm6.urdf");
  const std::string good = NominalMjcf(tree, "");
  const auto refused = [&](const std::string& found, const std::string& with,
                           const std::string& words) {
    std::string text = good;
    const std::size_t at = text.find(found);
    ASSERT_NE(at, std::string::npos) << found;
    text.replace(at, found.size(), with);
    ExpectInputError([&] { MakeCalibratedMjcf(text, "a.xml", tree, tree, {}); }, {words});
  };
  refused("<mujoco>", "<mujoco><compiler coordinate=\"global\"/>", "global");
  ExpectInputError(
      [&] {
        MakeCalibratedMjcf("<mujoco><worldbody><include file=\"bodies.xml\"/></worldbody></mujoco>",
                           "a.xml", tree, tree, {});
      },
      {"no body has a joint", "it includes 'bodies.xml'"});
  refused("quat=", "euler=\"0 0 0\" quat=", "'quat' was expected");
  refused("<joint name=\"" + tree.joints[0].name, "<joint name=\"other", "no body has a joint");
  refused("<joint name=\"" + tree.joints[1].name, R"(<joint name="other"/><joint name="more)",
          "no body has a joint '" + tree.joints[1].name);
  refused("<body", "<body><joint name=\"" + tree.joints[3].name + R"("/></body><body)",
          "is carried by ''");
  refused("<joint name", "<joint pos=\"0 0 0.1\" name", "not in the origin");
  refused("pos=\"", "pos=\"1", "from where the URDF");
  ExpectInputError([&] { MakeCalibratedMjcf(urdf, "a.xml", tree, tree, {}); }, {"<mujoco>"});
}

TEST(CalibratedMjcf, WhatBodiesAreCalledDoesNotMatter) {
  const CalibratedMjcf robot = Export("tests/robots/arm6.urdf", kDegrees);
  const std::string expected = robot.text;
  std::string mjcf = NominalMjcf(robot.nominal, kDegrees);
  int bodies = 0;
  for (std::size_t at = 0; (at = mjcf.find("<body name=\"", at)) != std::string::npos;
       ++at, ++bodies) {
    const std::size_t begin = at + 12, end = mjcf.find('"', begin);
    mjcf.replace(begin, end - begin, "part" + std::to_string(bodies));
  }
  ASSERT_GT(bodies, 6);
  MjcfJointNames names;
  for (const std::vector<std::string>& rules :
       {std::vector<std::string>{}, {"elbow_joint=bend", "*_joint=j_*"}}) {
    names = ReadMjcfJointNames(robot.nominal, rules);
    std::string renamed = mjcf;
    for (const auto& [joint, name] : names) {
      const std::size_t at = renamed.find("<joint name=\"" + joint + "\"");
      ASSERT_NE(at, std::string::npos) << joint;
      renamed.replace(at + 13, joint.size(), name);
    }
    const std::string text = MakeCalibratedMjcf(renamed, "a.xml", robot.nominal, robot.calibrated,
                                                robot.offsets, {}, names);
    const Model model = Load(text), same = Load(expected);
    ASSERT_NE(model, nullptr);
    ASSERT_EQ(model->nbody, same->nbody);
    for (int i = 0; i < 3 * model->nbody; ++i) EXPECT_EQ(model->body_pos[i], same->body_pos[i]);
    for (int i = 0; i < model->nq; ++i) EXPECT_EQ(model->qpos0[i], same->qpos0[i]);
  }
  EXPECT_EQ(names.at("elbow_joint"), "bend");
  EXPECT_EQ(names.at("rail_joint"), "j_rail");
  ExpectInputError([&] { ReadMjcfJointNames(robot.nominal, {"elbow_jont=bend"}); },
                   {"'elbow_jont=bend'", "elbow_joint"});
  ExpectInputError([&] { ReadMjcfJointNames(robot.nominal, {"*=bend"}); }, {"one * on each side"});
}

TEST(CalibratedMjcf, FindsItsFilesFromAnotherFolder) {
  const ScratchFolder folder;
  const std::filesystem::path from = folder.path() / "robots/a & b", to = folder.path() / "out";
  std::filesystem::create_directories(from / "meshes");
  std::filesystem::create_directories(to);
  WriteFile(from / "meshes/corner.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const auto model = [](const std::string& compiler, const std::string& file) {
    return "<mujoco>" + compiler + R"(<asset><mesh name="c" file=")" + file +
           R"("/></asset><worldbody><geom type="mesh" mesh="c"/></worldbody></mujoco>)";
  };
  const auto loads = [&](const std::string& text) {
    std::array<char, 1000> error{};
    const std::string file = folder.Write("out/robot.xml", text);
    const Model loaded(mj_loadXML(file.c_str(), nullptr, error.data(), error.size()),
                       &mj_deleteModel);
    return loaded ? std::string() : std::string(error.data());
  };
  for (const auto& [compiler, file] :
       {std::pair{"", "meshes/corner.obj"}, {"<compiler meshdir=\"meshes\"/>", "corner.obj"}}) {
    EXPECT_NE(loads(model(compiler, file)), "");
    EXPECT_EQ(loads(MoveMjcf(model(compiler, file), "robot.xml", from, to)), "");
    EXPECT_EQ(MoveMjcf(model(compiler, file), "robot.xml", from, from / "."),
              model(compiler, file));
  }
  ExpectInputError(
      [&] { MoveMjcf("<mujoco><include file=\"b.xml\"/></mujoco>", "a.xml", from, to); },
      {"a.xml:1", "includes other files"});
}

TEST(ReferencePositions, AreShiftedByTheZeros) {
  const std::string before =
      "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>\n"
      "<joint name=\"j\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/>"
      "<calibration rising=\"0.5\"/></joint>\n"
      "<joint name=\"k\" type=\"continuous\">\n  <parent link=\"b\"/><child link=\"c\"/></joint>"
      "</robot>\n";
  const std::string after = ShiftReferencePositions(before, "r.urdf", {{"j", 0.25}, {"k", -1.0}});
  EXPECT_NE(after.find("<calibration rising=\"0.75\"/></joint>"), std::string::npos) << after;
  EXPECT_NE(after.find("\n  <calibration rising=\"-1\"/>\n  <parent link=\"b\"/>"),
            std::string::npos)
      << after;
  EXPECT_EQ(ShiftReferencePositions(before, "r.urdf", {{"j", 0.0}, {"k", 0.0}}), before);
}

}  // namespace
}  // namespace elastocal
