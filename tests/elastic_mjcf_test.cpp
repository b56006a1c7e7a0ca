// SPDX-License-Identifier: Apache-2.0
// Compares the exported MJCF with springs in MuJoCo with the elastic robot at run time.
#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "elastocal/description/calibrated_mjcf.hpp"
#include "elastocal/description/calibrated_urdf.hpp"
#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/files/output_files.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/legs.hpp"
#include "elastocal/runtime/compensator.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/runtime_calibration.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"
#include "tests/user_mjcf.hpp"

namespace elastocal {
namespace {

using Model = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;
using Data = std::unique_ptr<mjData, decltype(&mj_deleteData)>;

class ElasticMjcf : public testing::Test {
 protected:
  ElasticMjcf() : project_(ReadProject(SourceFile("models/talos/project.yaml"))) {
    stored_ = RandomCalibration(project_, 1);
    for (const Chain& chain : project_.chains) {
      chains_.push_back({chain.name, chain.from_link, chain.tip_link});
    }
    legs_ = FindLegs(project_.tree, chains_);
  }

  /// Removes the compliances whose names begin with this.
  void TakeAway(const std::string& beginning) {
    for (auto& [name, value] : stored_.joint_errors) {
      if (name.starts_with(beginning + ".compliance")) value = 0.0;
    }
  }

  std::string Export(const std::string& user) const {
    const StoredRobot robot = RestoreRobot(project_, stored_);
    CalibrationResult result;
    result.model = robot.model;
    result.delta = robot.errors;
    const CalibratedUrdf apart = MakeCalibratedUrdf(ReadFile(project_.urdf), project_.urdf.string(),
                                                    result, ZeroOffsets::kEncoder);
    const RobotTree calibrated = ParseUrdf(apart.text, "calibrated");
    std::vector<SeriesSpring> springs = SeriesSprings(result, calibrated, legs_);
    const auto soles = SpringsOfSoles(stored_.soles, calibrated, legs_);
    springs.insert(springs.end(), soles.begin(), soles.end());
    return MakeCalibratedMjcf(user, "user.xml", project_.tree, calibrated, apart.encoder_offsets,
                              springs);
  }

  static Model Load(const std::string& text) {
    const ScratchFolder folder;
    std::array<char, 1000> error{};
    const std::string file = folder.Write("robot.xml", text);
    Model model(mj_loadXML(file.c_str(), nullptr, error.data(), error.size()), &mj_deleteModel);
    if (!model) throw std::runtime_error(error.data());
    return model;
  }

  Eigen::VectorXd Posture(std::uint64_t seed) const {
    Random random(seed);
    Eigen::VectorXd q = project_.motion.rest;
    for (double& position : q) position += random.Uniform(-0.2, 0.2);
    return q.cwiseMax(project_.motion.lower).cwiseMin(project_.motion.upper);
  }

  double JointPosition(const Joint& joint, const Eigen::VectorXd& q) const {
    return joint.multiplier * q[joint.coordinate] + joint.offset;
  }

  /// Sets motors and joints to a posture.
  void Put(const mjModel& model, const Eigen::VectorXd& q, mjData& data) const {
    for (const Joint& joint : project_.tree.joints) {
      const int id = mj_name2id(&model, mjOBJ_JOINT, joint.name.c_str());
      const int motor = mj_name2id(&model, mjOBJ_ACTUATOR, joint.name.c_str());
      data.qpos[model.jnt_qposadr[id]] = data.ctrl[motor] = JointPosition(joint, q);
    }
  }

  /// The positions that the encoders show.
  Eigen::VectorXd Encoders(const mjModel& model, const mjData& data) const {
    Eigen::VectorXd q = Eigen::VectorXd::Zero(project_.tree.coordinate_count());
    for (std::size_t c = 0; c < project_.tree.coordinate_joint.size(); ++c) {
      const Joint& joint =
          project_.tree.joints[static_cast<std::size_t>(project_.tree.coordinate_joint[c])];
      const int id = mj_name2id(&model, mjOBJ_JOINT, joint.name.c_str());
      q[static_cast<Eigen::Index>(c)] = data.qpos[model.jnt_qposadr[id]];
    }
    return q;
  }

  static Transform BodyPose(const mjModel& model, const mjData& data, const std::string& name) {
    const int body = mj_name2id(&model, mjOBJ_BODY, name.c_str());
    Transform T = Transform::Identity();
    T.translation() = Eigen::Map<const Eigen::Vector3d>(data.xpos + 3 * body);
    T.linear() =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data.xmat + 9 * body);
    return T;
  }

  const std::string& LinkName(int link) const {
    return project_.tree.links[static_cast<std::size_t>(link)].name;
  }

  static void Play(const mjModel& model, double seconds, mjData& data) {
    while (data.time < seconds) mj_step(&model, &data);
    double fastest = 0.0;
    for (int i = 0; i < model.nv; ++i) fastest = std::max(fastest, std::abs(data.qvel[i]));
    ASSERT_LT(fastest, 1e-4);  // at rest
    mj_kinematics(&model, &data);
  }

  const Leg& FindLeg(const std::string& name) const {
    return *std::ranges::find(legs_, name, &Leg::chain);
  }

  /// The link that a leg's last joint moves.
  int FootOf(const Leg& leg) const {
    return project_.tree.joints[static_cast<std::size_t>(leg.joints.back())].child_link;
  }

  /// A model at rest.
  struct Played {
    Model model;
    Data data;
  };

  /// The exported robot under a force [N] that pushes the sole of the right leg upwards. Its left
  /// foot is welded to the floor where it is flat at `q`.
  Played PlayOnLeftFoot(const Eigen::VectorXd& q, double push = 0.0) const {
    const Leg& leg = FindLeg("leg_left");
    const std::string foot = LinkName(FootOf(leg));
    Compensator rigid(MakeRuntimeModel(project_, stored_, RuntimeContent::kGeometry));
    rigid.Forward(q, Eigen::VectorXd(), 0);
    Transform T_root_foot = Transform::Identity();  // the sole's link, flat on the floor
    T_root_foot.matrix() = rigid.link_pose(leg.foot_link).matrix();
    const Transform T_world_root = Transform(leg.R_floor_foot) * T_root_foot.inverse();

    const std::string text = Export(UserModel{project_.tree}.Text(true));
    const auto put = [&](const mjModel& model, mjData& data) {
      const Eigen::Quaterniond quaternion(T_world_root.linear());
      Eigen::Map<Eigen::Vector3d>(data.qpos) = T_world_root.translation();
      Eigen::Map<Eigen::Vector4d>(data.qpos + 3) << quaternion.w(), quaternion.vec();
      Put(model, q, data);
      mj_kinematics(&model, &data);
    };
    const Model floating = Load(text);
    const Data there(mj_makeData(floating.get()), &mj_deleteData);
    put(*floating, *there);
    const Transform T_foot_world = BodyPose(*floating, *there, foot).inverse();
    const Eigen::Quaterniond turn(T_foot_world.linear());
    const Eigen::Vector3d shift = T_foot_world.translation();
    const std::string weld = fmt::format(
        "<equality><weld body1=\"{}\" relpose=\"{} {} {} {} {} {} {}\" solref=\"0.005 1\" "
        "solimp=\"0.999 0.9999 0.001\"/></equality></mujoco>",
        foot, shift.x(), shift.y(), shift.z(), turn.w(), turn.x(), turn.y(), turn.z());
    Model model = Load(text.substr(0, text.rfind("</mujoco>")) + weld);
    Data data(mj_makeData(model.get()), &mj_deleteData);
    put(*model, *data);
    PushUp(*model, FindLeg("leg_right"), push, *data);
    Play(*model, 5.0, *data);
    return {std::move(model), std::move(data)};
  }

  /// Applies a vertical force through the ankle of a leg.
  void PushUp(const mjModel& model, const Leg& leg, double force, mjData& data) const {
    const int foot = mj_name2id(&model, mjOBJ_BODY, LinkName(FootOf(leg)).c_str());
    mj_kinematics(&model, &data);
    mj_comPos(&model, &data);
    const Eigen::Vector3d lever = Eigen::Map<const Eigen::Vector3d>(data.xpos + 3 * foot) -
                                  Eigen::Map<const Eigen::Vector3d>(data.xipos + 3 * foot);
    const Eigen::Vector3d up(0, 0, force);
    Eigen::Map<Eigen::Vector3d>(data.xfrc_applied + 6 * foot) = up;
    Eigen::Map<Eigen::Vector3d>(data.xfrc_applied + 6 * foot + 3) = lever.cross(up);
  }

  /// Moments on the right leg about the origin of the root link, in its axes: that of PushUp, and
  /// that of the leg's own weight.
  Eigen::Vector3d MomentOfFloor(const mjModel& model, double force, const mjData& data) const {
    const int foot = mj_name2id(&model, mjOBJ_BODY, LinkName(FootOf(FindLeg("leg_right"))).c_str());
    return MomentInRoot(model, data, data.xpos + 3 * foot, force);
  }
  Eigen::Vector3d MomentOfOwnWeight(const mjModel& model, mjData& data) const {
    mj_comPos(&model, &data);
    const int hip = model.jnt_bodyid[mj_name2id(&model, mjOBJ_JOINT, "leg_right_elastic_rx")];
    return MomentInRoot(model, data, data.subtree_com + 3 * hip,
                        -9.81 * model.body_subtreemass[hip]);
  }
  Eigen::Vector3d MomentInRoot(const mjModel& model, const mjData& data, const double* at,
                               double up) const {
    const Joint& hip =
        project_.tree.joints[static_cast<std::size_t>(FindLeg("leg_right").joints.front())];
    const Transform T = BodyPose(model, data, LinkName(hip.parent_link));
    const Eigen::Vector3d lever = Eigen::Map<const Eigen::Vector3d>(at) - T.translation();
    return T.linear().transpose() * lever.cross(Eigen::Vector3d(0, 0, up));
  }

  /// The root link of a robot that stands on its left foot (m and rad): how far it gives way, and
  /// how far MuJoCo's root link is from there.
  struct Stands {
    double deflection = 0.0, off = 0.0;
    double turn = 0.0, turned_off = 0.0;
  };

  Stands OnLeftFoot(const Eigen::VectorXd& q) const {
    const Leg& leg = FindLeg("leg_left");
    const auto [model, data] = PlayOnLeftFoot(q);
    const Eigen::VectorXd encoders = Encoders(*model, *data);
    const Joint& hip = project_.tree.joints[static_cast<std::size_t>(leg.joints.front())];
    const Transform T_foot_root = BodyPose(*model, *data, LinkName(FootOf(leg))).inverse() *
                                  BodyPose(*model, *data, LinkName(hip.parent_link));
    Compensator elastic(MakeRuntimeModel(project_, stored_));
    Compensator rigid(MakeRuntimeModel(project_, stored_, RuntimeContent::kGeometry));
    const StandingFeet feet = 1u << (&leg - legs_.data());
    elastic.Forward(encoders, Eigen::VectorXd(), feet);
    rigid.Forward(encoders, Eigen::VectorXd(), feet);
    // The sole in the frame of the foot's body.
    const Transform T_body_sole =
        project_.tree.links[static_cast<std::size_t>(FootOf(leg))].T_body_link.inverse() *
        project_.tree.links[static_cast<std::size_t>(leg.foot_link)].T_body_link;
    const Transform T_sole_root = T_body_sole.inverse() * T_foot_root;
    const auto angle = [&](const auto& from, const auto& to) {
      return Eigen::AngleAxisd(from.linear().transpose() * to.linear()).angle();
    };
    const auto& expected = elastic.root_pose();
    return {(expected.translation() - rigid.root_pose().translation()).norm(),
            (expected.translation() - T_sole_root.translation()).norm(),
            angle(expected, rigid.root_pose()), angle(expected, T_sole_root)};
  }

  Project project_;
  StoredCalibration stored_;
  std::vector<NamedChain> chains_;
  std::vector<Leg> legs_;
};

/// Largest error as a share of the deflection. Both models take loads of the deflected robot, ours
/// those of the first deflection.
constexpr double kShare = 1e-3;
/// The springs of a leg are in the axes of its foot, which is inclined to the root link by some
/// tenths of a radian here.
constexpr double kShareOnLeg = 0.03;
/// Largest error of the turn, most of which comes from joints.
constexpr double kShareOfTurn = 4e-3;
/// In MuJoCo, the spring of a sole carries all but the link of the foot.
constexpr double kShareOfFoot = 0.03;

TEST_F(ElasticMjcf, HangsAsTheElasticModelDoes) {
  TakeAway("leg_left");  // whole legs, which a held root does not load
  TakeAway("leg_right");
  const Model model = Load(Export(UserModel{project_.tree}.Text(false)));
  Compensator elastic(MakeRuntimeModel(project_, stored_));
  Compensator rigid(MakeRuntimeModel(project_, stored_, RuntimeContent::kGeometry));
  for (std::uint64_t seed : {3, 4}) {
    const Data data(mj_makeData(model.get()), &mj_deleteData);
    Put(*model, Posture(seed), *data);
    Play(*model, 3.0, *data);
    const Eigen::VectorXd q = Encoders(*model, *data);
    elastic.Forward(q, Eigen::VectorXd(), 0);
    rigid.Forward(q, Eigen::VectorXd(), 0);
    double largest = 0.0, off = 0.0;
    for (const Joint& joint : project_.tree.joints) {
      if (joint.mimic) continue;
      const Transform T = BodyPose(*model, *data, LinkName(joint.child_link));
      const auto expected = elastic.link_pose(joint.child_link);
      largest = std::max(
          largest,
          (rigid.link_pose(joint.child_link).translation() - expected.translation()).norm());
      off = std::max(off, (T.translation() - expected.translation()).norm());
    }
    EXPECT_GT(largest, 5e-4);
    EXPECT_LT(off, kShare * largest);
  }
}

TEST_F(ElasticMjcf, StandsOnOneFootAsTheElasticModelDoes) {
  TakeAway("leg_right");  // it swings, and in MuJoCo its own weight stretches it
  const Stands stands = OnLeftFoot(Posture(7));
  EXPECT_GT(stands.deflection, 1e-2);
  EXPECT_LT(stands.off, kShareOnLeg * stands.deflection);
  EXPECT_GT(stands.turn, 1e-2);
  EXPECT_LT(stands.turned_off, kShareOfTurn * stands.turn);
}

// The leg weighs a sixth of the robot. While it hangs, its length is that of the geometry. On the
// floor, it gives way by the share of the weight that the floor carries: with the whole weight, as
// much as eq. 6 says. Its turn is that of eq. 6 with the whole weight.
TEST_F(ElasticMjcf, ALegGivesWayByItsShareOfTheWeight) {
  for (auto& [name, value] : stored_.joint_errors) value = 0.0;
  for (const char* along : {"x", "y", "z"}) {
    stored_.joint_errors[std::string("leg_right.compliance_") + along] = 1e-6;   // m/N
    stored_.joint_errors[std::string("leg_right.compliance_r") + along] = 1e-5;  // rad/(N.m)
  }
  double all = 0.0, leg = 0.0;
  for (const Link& link : project_.tree.links) {
    all += 9.81 * link.mass;
    if (link.name.starts_with("leg_right") || link.name == "right_sole_link") {
      leg += 9.81 * link.mass;
    }
  }
  ASSERT_GT(leg, 0.1 * all);
  for (const double share : {0.0, 0.5, 1.0}) {
    const auto [model, data] = PlayOnLeftFoot(project_.motion.rest, share * all);
    const auto position = [&, model = model.get(), data = data.get()](const char* name) {
      return data->qpos[model->jnt_qposadr[mj_name2id(model, mjOBJ_JOINT, name)]];
    };
    EXPECT_NEAR(position("leg_right_elastic_z"), share * 1e-6 * (all - leg), 0.02 * 1e-6 * leg);
    const Eigen::Vector3d floor = MomentOfFloor(*model, share * all, *data);
    const Eigen::Vector3d own = MomentOfOwnWeight(*model, *data);
    EXPECT_GT(own.norm(), 15.0);
    // MuJoCo adds the moment of the whole weight of the leg, the model at run time only a share of
    // it.
    EXPECT_NEAR(position("leg_right_elastic_rx"), 1e-5 * (floor + own).x(),
                0.04 * 1e-5 * own.norm());
    EXPECT_NEAR(position("leg_right_elastic_ry"), 1e-5 * (floor + own).y(),
                0.04 * 1e-5 * own.norm());
  }
}

// The spring is below the ankle, so the leg's inclination does not matter.
TEST_F(ElasticMjcf, ASoleSinksAsTheElasticModelDoes) {
  for (auto& [name, value] : stored_.joint_errors) {
    if (name.find(".compliance") != std::string::npos) value = 0.0;
  }
  stored_.soles = {{.leg = "leg_left", .changes = 2, .compliance = 1e-5, .sd = 1e-7}};
  const Stands stands = OnLeftFoot(Posture(7));
  EXPECT_GT(stands.deflection, 5e-3);
  EXPECT_LT(stands.off, kShareOfFoot * stands.deflection);
}

TEST_F(ElasticMjcf, WithoutCompliancesNothingIsAdded) {
  for (auto& [name, value] : stored_.joint_errors) {
    if (name.find(".compliance") != std::string::npos) value = 0.0;
  }
  EXPECT_EQ(Export(UserModel{project_.tree}.Text(false)).find("elastic"), std::string::npos);
}

TEST_F(ElasticMjcf, RefusesKeyframesAndNamesThatAreTaken) {
  std::string user = UserModel{project_.tree}.Text(false);
  const auto with = [&](const std::string& found, const std::string& text) {
    std::string changed = user;
    return changed.replace(user.rfind(found), 0, text);
  };
  ExpectInputError([&] { Export(with("</mujoco>", "<keyframe><key qpos=\"0 0\"/></keyframe>")); },
                   {"user.xml", "keyframe"});
  ExpectInputError(
      [&] { Export(with("</worldbody>", "<body name=\"leg_left_1_link_root_elastic\"/>")); },
      {"leg_left_1_link_root_elastic"});
}

}  // namespace
}  // namespace elastocal
