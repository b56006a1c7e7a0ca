// SPDX-License-Identifier: Apache-2.0
// Legs whose knees and ankles are moved by rods: tables and logs of their motors, MuJoCo's closed
// loops, recovery of the truth, and a virtual experiment from files to the calibrated rods.

#include <array>
#include <cstring>
#include <map>
#include <numeric>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "elastocal/elastocal.hpp"
#include "elastocal/io/joint_log.hpp"
#include "elastocal/io/linkage_file.hpp"
#include "elastocal/io/motor_columns.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/robot/linkage_errors.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "elastocal/simulation/true_robot.hpp"
#include "elastocal/simulation/virtual_robot.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

class LinkedBiped : public testing::Test {
 protected:
  std::filesystem::path File(const std::string& name) const { return scratch_.path() / name; }

  /// A table in whose columns the joints have the names and values that `tree` and the recording
  /// have.
  PostureTable ReadBack(const Recording& recording, const RobotTree& tree) const {
    WritePostureTable(File("table.csv"), recording, tree);
    return ReadPostureTable(File("table.csv"), project_);
  }

  Eigen::VectorXd Truth(std::uint64_t seed) const {
    Random random(seed);
    Eigen::VectorXd truth = Eigen::VectorXd::Zero(model_.parameter_count());
    const Prior prior;
    for (int i = kWaistParameterCount; i < truth.size(); ++i) {
      const Parameter& parameter = model_.parameters[i];
      const double sd = IsExternal(parameter.kind) ? 2e-3 : prior.Of(model_.tree, parameter);
      truth[i] = random.Normal(sd);
    }
    return truth;
  }

  ScratchFolder scratch_;
  Project project_ = ReadProject(SourceFile("tests/robots/linked_biped_project.yaml"));
  ErrorModel model_ = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  RobotTree unlinked_ = [this] {
    RobotTree tree = project_.tree;
    tree.linkages.clear();
    return tree;
  }();
};

TEST_F(LinkedBiped, ItsTablesHoldTheMotors) {
  EXPECT_TRUE(project_.tree.warnings.empty()) << project_.tree.warnings[0];
  const Recording recording = MakeSyntheticRecording(
      model_, Eigen::VectorXd::Zero(model_.parameter_count()), {.postures = 5, .marker_sd = 0.0});
  const PostureTable by_motors = ReadBack(recording, project_.tree);
  const std::string text = ReadFile(File("table.csv"));
  EXPECT_NE(text.find(",left_ankle_outer,"), std::string::npos);
  EXPECT_EQ(text.find("left_ankle_pitch"), std::string::npos);
  EXPECT_LT((by_motors.recording.q - recording.q).cwiseAbs().maxCoeff(), 1e-11);
  // A controller that logs the joints has them from the nominal rods.
  EXPECT_EQ(ReadBack(recording, unlinked_).recording.q, recording.q);

  Recording motors = recording;
  RobotTree named = JointsToMotors(project_.tree, {}, motors.q);
  named.linkages.clear();
  EXPECT_EQ(ReadBack(motors, named).recording.q, by_motors.recording.q);
  const int outer = FindJoint(named, "left_ankle_outer");
  motors.q(2, named.joints[outer].coordinate) = 3.0;
  ExpectInputError([&] { ReadBack(motors, named); },
                   {"table.csv:4: ", "'left_ankle_outer' at 3 rad", "'left_ankle'"});
  named.joints[outer].name = "left_ankle_pitch";
  ExpectInputError([&] { ReadBack(recording, named); },
                   {"table.csv: ", "'left_ankle_inner'", "none of 'left_ankle_outer'"});
}

// What the motors do is what the joints do: their powers are the same.
TEST_F(LinkedBiped, ItsLogsHoldTheTorquesOfTheMotors) {
  Random random(3);
  const Eigen::VectorXd q = RandomPosture(project_.tree, random);
  const auto coordinates = static_cast<Eigen::Index>(q.size());
  constexpr double kStep = 1e-6;
  JointLog log;
  for (int k : project_.tree.coordinate_joint) log.names.push_back(project_.tree.joints[k].name);
  log.time_s = Eigen::Vector2d(0.0, 0.01);
  log.positions.resize(2, coordinates);
  log.positions.row(0) = q.transpose();
  const Eigen::VectorXd change = random.NormalVector(coordinates, kStep);
  log.positions.row(1) = (q + change).transpose();
  log.torques = random.NormalVector(coordinates, 20.0).transpose().replicate(2, 1);
  const JointLog motors = JointsToMotors(project_.tree, log);
  const Eigen::VectorXd way = (motors.positions.row(1) - motors.positions.row(0)).transpose();
  EXPECT_GT((way - change).norm(), 0.1 * change.norm());
  const double power = log.torques.row(0).dot(change);
  EXPECT_NEAR(motors.torques.row(0).dot(way), power, 1e-4 * std::abs(power) + 1e-9);

  WriteJointLog(File("joints.csv"), motors);
  EXPECT_NE(ReadFile(File("joints.csv")).find(",right_knee_actuator_torque,"), std::string::npos);
  const JointLog read = ReadJointLog(File("joints.csv"), project_);
  EXPECT_EQ(read.names, log.names);
  EXPECT_LT((read.positions - log.positions).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((read.torques - log.torques).cwiseAbs().maxCoeff(), 1e-7);
}

std::string Numbers(const Eigen::VectorXd& v) {
  std::string text;
  for (const double number : v) text += fmt::format("{:.17g} ", number);
  return text;
}

/// Thigh, shank, cross and foot of one leg by MuJoCo, its rods as bodies: on a crank's pin by a
/// ball joint, or sliding out of a ball joint where there is an actuator, and their ends on the
/// links by `connect`. An equality constraint holds each motor.
std::string LoopsXml(const RobotTree& tree, const std::string& side, const Linkage& knee,
                     const Linkage& ankle) {
  const std::string mass = R"(<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>)";
  std::string equality;
  // The rod lies along x of its body while the model is built; `connect` brings it where it ends.
  const auto rod_body = [&](const Rod& rod, const Transform& T_here_anchor) {
    const std::string& name = rod.motor;
    equality +=
        fmt::format(R"(<joint name="{0}" joint1="{0}"/>)"
                    R"(<connect name="end_{0}" body1="end_{0}" body2="{1}" anchor="0 0 0"/>)",
                    name, tree.links[static_cast<std::size_t>(rod.to_link)].name);
    const Eigen::Vector3d start = rod.actuator ? rod.centre : rod.pin;
    const Eigen::Vector3d along = T_here_anchor * rod.anchor - start;
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), along);
    const Eigen::Vector4d wxyz(turn.w(), turn.x(), turn.y(), turn.z());
    const Eigen::Vector3d end = rod.length * Eigen::Vector3d::UnitX();
    const std::string slide =
        rod.actuator ? fmt::format(R"(<joint name="{}" type="slide" axis="1 0 0"/>)", name) : "";
    const std::string rest = fmt::format(
        R"(<body name="rod_{0}" pos="{1}" quat="{2}"><joint type="ball"/>{3}<body name="end_{0}" pos="{4}">{5}{3}</body></body>)",
        name, Numbers(rod.actuator ? rod.centre : Eigen::Vector3d(rod.pin - rod.centre)),
        Numbers(wxyz), mass, Numbers(end), slide);
    if (rod.actuator) return rest;
    return fmt::format(R"(<body pos="{}"><joint name="{}" type="hinge" axis="{}"/>{}{}</body>)",
                       Numbers(rod.centre), name, Numbers(rod.axis), mass, rest);
  };
  const auto joint = [&](const std::string& name) -> const Joint& {
    return tree.joints[static_cast<std::size_t>(FindJoint(tree, side + name))];
  };
  const auto link = [&](const std::string& name, const std::string& moved_by,
                        const std::string& content) {
    const Joint& by = joint(moved_by);
    return fmt::format(
        R"(<body name="{0}" pos="{1}"><joint name="{2}" type="hinge" axis="{3}"/>{4}{5}</body>)",
        side + name, Numbers(by.T_parent_child.translation()), side + moved_by, Numbers(by.axis),
        mass, content);
  };
  const Transform T_shank_foot =
      joint("ankle_pitch").T_parent_child * joint("ankle_roll").T_parent_child;
  std::string rods;
  for (const Rod& rod : ankle.rods) rods += rod_body(rod, T_shank_foot);
  const std::string foot = link("foot", "ankle_roll", "");
  const std::string shank = link("shank", "knee", rods + link("ankle", "ankle_pitch", foot));
  const std::string actuator = rod_body(knee.rods[0], joint("knee").T_parent_child);
  return fmt::format(
      R"(<mujoco><option timestep="0.0005" gravity="0 0 0"><flag contact="disable"/></option>)"
      R"(<default><joint damping="2"/><equality solref="0.002 1"/></default>)"
      R"(<worldbody><body name="{}thigh">{}{}</body></worldbody><equality>{}</equality></mujoco>)",
      side, actuator, shank, equality);
}

using Model = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;

Model Compile(const std::string& xml) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "loops.xml", static_cast<int>(xml.size()) + 1);
  std::memcpy(files->filedata[0], xml.c_str(), xml.size() + 1);
  std::array<char, 1000> error{};
  Model model(mj_loadXML("loops.xml", files.get(), error.data(), error.size()), &mj_deleteModel);
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error.data());
  return model;
}

double* EqualityData(mjModel& model, const std::string& name) {
  return model.eq_data + mjNEQDATA * mj_name2id(&model, mjOBJ_EQUALITY, name.c_str());
}

/// MuJoCo takes the ends of a rod as where they are at first; they are the anchors.
void ConnectRods(const Linkage& linkage, mjModel& model) {
  for (const Rod& rod : linkage.rods) {
    Eigen::Map<Eigen::Vector3d>(EqualityData(model, "end_" + rod.motor) + 3) = rod.anchor;
  }
}

/// Moves the motors to where they are to be, and lets the loops come to rest; positions of the
/// joints of the names.
std::vector<double> SettledPositions(mjModel& model, const std::map<std::string, double>& motors,
                                     const std::vector<std::string>& names) {
  const std::unique_ptr<mjData, decltype(&mj_deleteData)> data(mj_makeData(&model), &mj_deleteData);
  constexpr int kMostSteps = 20000, kMoving = 4000;
  for (int i = 0; i < kMostSteps; ++i) {
    const double share = std::min(1.0, static_cast<double>(i) / kMoving);
    for (const auto& [motor, at] : motors) EqualityData(model, motor)[0] = share * at;
    mj_step(&model, data.get());
    const Eigen::Map<const Eigen::VectorXd> speeds(data->qvel, model.nv);
    if (i > 2 * kMoving && speeds.cwiseAbs().maxCoeff() < 1e-11) break;
  }
  std::vector<double> positions;
  for (const std::string& name : names) {
    const int id = mj_name2id(&model, mjOBJ_JOINT, name.c_str());
    positions.push_back(data->qpos[model.jnt_qposadr[id]]);
  }
  return positions;
}

// MuJoCo's constraints are springs, which have no force at rest where there is no weight.
TEST_F(LinkedBiped, ClosesItsLoopsAsMujocoDoes) {
  Random random(11);
  const std::array<int, 2> which = {0, 1};  // left_knee, left_ankle
  for (int i = 0; i < 3; ++i) {
    const Eigen::VectorXd q = RandomPosture(project_.tree, random);
    std::vector<Eigen::VectorXd> errors;
    for (const Linkage& linkage : project_.tree.linkages) {
      errors.push_back(random.NormalVector(linkage.error_count(), 1.5e-3));
    }
    std::vector<Linkage> rods;
    std::map<std::string, double> motors;
    for (int l : which) {
      const Linkage& linkage = project_.tree.linkages[l];
      rods.push_back(WithErrors(linkage, errors[l]));
      const Eigen::VectorXd at =
          *MotorPositions(project_.tree, linkage, q(CoordinatesOf(project_.tree, linkage)));
      for (std::size_t m = 0; m < linkage.rods.size(); ++m) {
        motors[linkage.rods[m].motor] = at[static_cast<Eigen::Index>(m)];
      }
    }
    const Model mujoco = Compile(LoopsXml(project_.tree, "left_", rods[0], rods[1]));
    for (const Linkage& linkage : rods) ConnectRods(linkage, *mujoco);
    const Eigen::VectorXd placed = PlaceLinkages(project_.tree, errors, q).q;
    const std::vector<std::string> names = {"left_knee", "left_ankle_pitch", "left_ankle_roll"};
    const std::vector<double> found = SettledPositions(*mujoco, motors, names);
    for (std::size_t j = 0; j < names.size(); ++j) {
      const int k = FindJoint(project_.tree, names[j]);
      EXPECT_NEAR(JointPosition(project_.tree.joints[k], placed), found[j], 1e-8) << names[j];
    }
    EXPECT_GT((placed - q).norm(), 1e-3);
  }
}

TEST_F(LinkedBiped, NoiseFreeTableGivesBackTheTruth) {
  const Eigen::VectorXd truth = Truth(1);
  const auto record = [&](int postures, std::uint64_t seed) {
    return MakeSyntheticRecording(model_, truth,
                                  {.postures = postures, .marker_sd = 0.0, .seed = seed});
  };
  const CalibrationResult result =
      Calibrate(model_, record(80, 1), FindBaseParameters(model_, {}), ModelKind::kGeometric, {});
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_TRUE(result.outliers.empty());
  int told = 0;
  for (int i = kWaistParameterCount; i < model_.parameter_count(); ++i) {
    EXPECT_NEAR(result.delta[i], truth[i], 1e-8 + 5.0 * result.sd[i]) << model_.parameters[i].name;
    if (model_.parameters[i].linkage >= 0 && result.sd[i] < 1e-6) ++told;
  }
  EXPECT_GE(told, 1);
  const Recording unseen = record(20, 2);
  const auto furthest = [&](const Eigen::VectorXd& delta) {
    return Predict(result.model, delta, unseen, {}).distances.maxCoeff();
  };
  EXPECT_LT(furthest(result.delta), 1e-8);
  Eigen::VectorXd exact_rods = truth;
  for (int i = 0; i < truth.size(); ++i) {
    if (model_.parameters[i].linkage >= 0) exact_rods[i] = 0.0;
  }
  EXPECT_GT(furthest(exact_rods), 5e-3);
}

/// Where the nominal rods have the joints, the rods of a file written by `calibrate` put them
/// there.
Eigen::VectorXd PlacedByFile(const Project& project, const std::string& linkages,
                             const Eigen::VectorXd& q) {
  std::string text = ReadFile(project.file);
  const std::size_t begin = text.find("linkages:"), end = text.find("chains:");
  text.replace(begin, end - begin, linkages);
  const RobotTree calibrated = ParseProject(text, project.file).tree;
  Eigen::VectorXd placed = q;
  for (std::size_t i = 0; i < calibrated.linkages.size(); ++i) {
    const std::vector<int> coordinates = CoordinatesOf(project.tree, project.tree.linkages[i]);
    const auto motors = MotorPositions(project.tree, project.tree.linkages[i], q(coordinates));
    placed(coordinates) = *JointsFromMotors(calibrated, calibrated.linkages[i], *motors);
  }
  return placed;
}

TEST_F(LinkedBiped, CalibratedRodsAreWrittenForControllers) {
  CalibrationResult result;
  result.model = model_;
  result.delta = Truth(2);
  const std::string yaml = MakeLinkagesYaml(result);
  const Geometry geometry = ApplyErrors(model_, result.delta);
  Random random(5);
  for (int i = 0; i < 20; ++i) {
    const Eigen::VectorXd q = RandomPosture(model_.tree, random);
    const Eigen::VectorXd expected = PlaceLinkages(model_.tree, geometry.linkage_errors, q).q;
    EXPECT_LT((PlacedByFile(project_, yaml, q) - expected).norm(), 1e-9);
    EXPECT_GT((expected - q).norm(), 1e-4);
  }
}

// A rigid robot with true rods and a true tree settles in MuJoCo under its weight; a table has its
// motors and markers. tests/study/linkage_study.py has whole recordings of elastic robots.
TEST_F(LinkedBiped, MujocosRobotIsFoundFromItsMotors) {
  TruthOptions truth;
  truth.upper_elasticity_scale = truth.friction_share = 0.0;
  const TrueRobot robot =
      DrawTrueRobot(NominalRobot(project_.tree, project_.markers, {}, {}), truth);
  constexpr int kPostures = 60, kSeen = 50;
  Recording measured = MakeSyntheticRecording(
      model_, Eigen::VectorXd::Zero(model_.parameter_count()), {.postures = kPostures});
  for (int i = 0; i < kPostures; ++i) {
    VirtualRobot body(robot, {}, measured.q.row(i).transpose(), {});
    body.Settle(2.0);
    measured.q.row(i) = body.Encoders()(project_.tree.coordinate_joint).transpose();
    measured.markers.row(i) =
        (body.WaistPose().inverse() * body.MarkerPositions()).reshaped().transpose();
  }
  const Recording recording = ReadBack(measured, project_.tree).recording;
  std::vector<int> seen(kSeen), unseen(kPostures - kSeen);
  std::iota(seen.begin(), seen.end(), 0);
  std::iota(unseen.begin(), unseen.end(), kSeen);
  const Recording held_out = SelectPostures(recording, unseen);
  const CalibrationResult result =
      Calibrate(model_, SelectPostures(recording, seen), FindBaseParameters(model_, {}),
                ModelKind::kGeometric, {});
  const auto furthest = [&](Eigen::VectorXd delta, bool exact_rods) {
    for (int i = 0; i < delta.size(); ++i) {
      if (exact_rods && model_.parameters[i].linkage >= 0) delta[i] = 0.0;
    }
    return Predict(result.model, delta, held_out, {}).distances.maxCoeff();
  };
  EXPECT_LT(furthest(result.delta, false), 1e-6);
  EXPECT_GT(furthest(result.delta, true), 2e-3);
  EXPECT_GT(furthest(Eigen::VectorXd::Zero(model_.parameter_count()), false), 1e-2);
}

}  // namespace
}  // namespace elastocal
