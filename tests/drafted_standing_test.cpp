// SPDX-License-Identifier: Apache-2.0
// Robots that `init` drafts, in plans and standing freely in MuJoCo. An invented quadruped moves a
// leg while it stands on the balls of the other three. An invented humanoid, whose hips share a
// motor, moves a leg while it stands on the other.

#include <gtest/gtest.h>

#include "elastocal/drafting/draft.hpp"
#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/motion/stabiliser.hpp"
#include "elastocal/planning/plan_motion.hpp"
#include "elastocal/planning/project_motion.hpp"
#include "elastocal/planning/simulate_experiment.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

class Quadruped : public testing::Test {
 protected:
  Quadruped() {
    const std::string file = "tests/robots/quadruped.urdf";
    const ProjectDraft draft = DraftProject(ReadFile(SourceFile(file)), file, {});
    folder_.Write("robot.urdf", draft.urdf);
    project_ = ReadProject(folder_.Write("project.yaml", FormatDraft(draft, "robot.urdf")));
    // The foot of a leg moves up by 0.1 m and to the side.
    const ChainSetup& setup = project_.motion.chains[0];
    Eigen::VectorXd q = project_.motion.rest;
    q[setup.coordinates[0]] += 0.15;
    q[setup.coordinates[1]] += 0.4;
    q[setup.coordinates[2]] -= 0.8;
    plan_ = PlanMotion(project_, {{setup.name, setup.support, {q}}}, {});
  }

  ScratchFolder folder_;
  Project project_;
  MotionPlan plan_;
};

TEST_F(Quadruped, LiftsAFootOverTheMiddleOfTheOthers) {
  ASSERT_TRUE(plan_.left_out.empty()) << plan_.left_out[0];
  EXPECT_TRUE(plan_.broken().empty());
  ASSERT_EQ(plan_.planned[0].visits.size(), 1u);
  // At rest on three feet, the zero-moment point is in the middle of these feet.
  const Visit& visit = plan_.planned[0].visits[0];
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  const Eigen::VectorXd q =
      plan_.planned[0].motion.q.row((visit.begin + visit.end) / 2).transpose();
  const std::vector<Transform> T_root_link = LinkTransforms(project_.tree, q);
  const Eigen::Vector3d com = CentreOfMass(project_.tree, BodyInertias(project_.tree), q);
  std::vector<Eigen::Vector3d> balls;
  for (const int link : project_.motion.chains[0].support) {
    balls.emplace_back(T_root_link[Size(link)].translation());
    middle += (balls.back() - com).head<2>() / 3.0;
  }
  EXPECT_LT(middle.norm(), 1e-6);
  EXPECT_TRUE(FloorAxes(balls).isIdentity(1e-9));  // the root link is upright
  EXPECT_GT(T_root_link[Size(project_.motion.chains[0].tip_link)].translation().z(),
            balls[0].z() + 0.05);
}

/// What inertial unit and feet measure if the robot rests on all feet and its root link leans.
StandingSense SenseAtRest(const StandingRobot& robot, double lean) {
  StandingSense sense;
  sense.R_world_root = RotX(lean).linear();
  sense.wrenches.setZero(6, 4);
  const Eigen::Vector3d com =
      robot.T_world_root * CentreOfMass(robot.tree, robot.inertias, robot.rest);
  const Eigen::Vector3d force(0.0, 0.0, 200.0);
  const auto wrenches = ShareWrench(robot.soles, robot.T_world_sole, force, com.cross(force));
  const std::vector<Transform> T_root_link = LinkTransforms(robot.tree, robot.rest);
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Matrix3d R_link_world =
        (robot.T_world_root * T_root_link[Size(robot.soles[i].link)]).linear().transpose();
    sense.wrenches.col(static_cast<Eigen::Index>(i)).head<3>() = R_link_world * wrenches[i].force;
  }
  return sense;
}

TEST_F(Quadruped, ItsStabiliserKnowsTheFloorUnderItsBalls) {
  const auto robot = StandProjectRobot(project_, {});
  std::vector<int> support;
  for (const Sole& sole : robot->soles) support.push_back(sole.link);
  Stabiliser upright(robot->tree, robot->soles);
  Stabiliser leaning(robot->tree, robot->soles);
  Eigen::VectorXd corrected;
  for (int i = 0; i < 100; ++i) {
    const Eigen::VectorXd q = upright.Correct(robot->rest, support, SenseAtRest(*robot, 0.0), 0.01);
    EXPECT_LT((q - robot->rest).cwiseAbs().maxCoeff(), 1e-6);
    corrected = leaning.Correct(robot->rest, support, SenseAtRest(*robot, 0.02), 0.01);
  }
  // The correction turns against the lean. Seen from the root link, the corrected joints turn the
  // floor about x as the root link must turn back.
  std::vector<Eigen::Vector3d> balls;
  const std::vector<Transform> T_root_link = LinkTransforms(robot->tree, corrected);
  for (const int link : support) balls.emplace_back(T_root_link[Size(link)].translation());
  const Eigen::Vector3d turn = RotationVector(FloorAxes(balls));
  EXPECT_GT(turn.x(), 0.005);
  EXPECT_LT(turn.x(), 0.05);
  EXPECT_NEAR(leaning.turn().x(), -turn.x(), 2e-3);
}

// The leg hangs straight down. If the root link is upright, it is too low for this foot or too high
// for the other legs.
TEST_F(Quadruped, VisitsPosturesForWhichOneHeightIsLeft) {
  const ChainSetup& setup = project_.motion.chains[0];
  Eigen::VectorXd q = project_.motion.rest;
  q(setup.coordinates) = Eigen::Vector3d(0.0458, -0.3488, 0.046);
  const MotionPlan plan = PlanMotion(project_, {{setup.name, setup.support, {q}}}, {});
  EXPECT_TRUE(plan.left_out.empty()) << plan.left_out[0];
  EXPECT_TRUE(plan.broken().empty());
}

// All postures keep the range. What the standing legs need for balance beyond it is reported.
TEST_F(Quadruped, SaysWhichJointLeavesTheRangeThatIsAskedFor) {
  EXPECT_TRUE(plan_.beyond_ranges.empty()) << plan_.beyond_ranges[0];
  const ChainSetup& setup = project_.motion.chains[0];
  const int standing = project_.motion.chains[1].coordinates[1];
  const Eigen::VectorXd moved = plan_.whole.motion.q.col(standing);
  project_.motion.upper[standing] = 0.5 * (project_.motion.rest[standing] + moved.maxCoeff());
  Eigen::VectorXd q = project_.motion.rest;
  q(setup.coordinates) += Eigen::Vector3d(0.15, 0.4, -0.8);
  const MotionPlan plan = PlanMotion(project_, {{setup.name, setup.support, {q}}}, {});
  ASSERT_EQ(plan.beyond_ranges.size(), 1u);
  const Joint& joint = project_.tree.joints[Size(project_.tree.coordinate_joint[Size(standing)])];
  EXPECT_EQ(plan.beyond_ranges[0].rfind(joint.name + " leaves the range", 0), 0u)
      << plan.beyond_ranges[0];
}

TEST_F(Quadruped, RobotsWithErrorsStandThrough) {
  for (const MotionTrial& trial : TryMotion(project_, plan_.whole.motion, {.robots = 3})) {
    EXPECT_TRUE(trial.run.stood) << trial.seed;
    EXPECT_LT(trial.run.largest_lean, 0.06) << trial.seed;
    EXPECT_GT(trial.run.largest_shift, 1e-4) << trial.seed;  // the stabiliser works
  }
  // Without friction, feet slide apart.
  MotionTrialOptions ice{.robots = 1};
  ice.floor_friction = 1e-4;
  EXPECT_FALSE(TryMotion(project_, plan_.whole.motion, ice)[0].run.stood);
}

TEST_F(Quadruped, IsRecordedWhileItStandsOnThreeFeet) {
  SimulationOptions options;
  options.motion = plan_.whole.motion;
  const Simulation simulation = PrepareSimulation(project_, options);
  ASSERT_EQ(simulation.experiment.trials.size(), 1u);
  EXPECT_EQ(simulation.experiment.trials[0].support, project_.motion.chains[0].support);
  const TrueMotion played = RunTrial(simulation.experiment, 0).motion;
  EXPECT_TRUE(played.markers.allFinite());
  EXPECT_TRUE(played.encoders.allFinite() && played.torques.allFinite());
  ASSERT_EQ(played.T_camera_waist.size(), static_cast<std::size_t>(played.frame_count()));
  // The stabiliser must have corrected the legs.
  const VirtualExperiment& experiment = simulation.experiment;
  const TrueMotion uncorrected =
      PlayMotion(experiment.robot, experiment.trials[0].support, experiment.trials[0].motion,
                 experiment.T_camera_world[0], experiment.options.physics);
  const Eigen::Index last = played.frame_count() - 1;  // at rest
  EXPECT_GT((uncorrected.encoders - played.encoders).row(last).cwiseAbs().maxCoeff(), 2e-3);
  const double height = played.T_camera_waist[0].translation().z();
  EXPECT_GT(height, 0.4);
  for (const Transform& T : played.T_camera_waist) {
    EXPECT_NEAR(T.translation().z(), height, 0.02);
    EXPECT_GT(T.linear()(2, 2), 0.995);
  }
  EXPECT_EQ(LargestWaistDeflection(simulation.experiment, 0, played).translation, 0.0);
}

TEST_F(Quadruped, ARecordingInWhichItFallsIsRefused) {
  SimulationOptions options;
  options.motion = plan_.whole.motion;
  Simulation simulation = PrepareSimulation(project_, options);
  simulation.experiment.options.physics.gravity_tilt_x = 0.8;
  ExpectInputError([&] { RunTrial(simulation.experiment, 0); }, {"trial 'motion", "fell after"});
}

TEST_F(Quadruped, CommandsAreNotCorrected) {
  ExpectInputError([&] { MakeRuntimeModel(project_, {}); },
                   {"project.yaml", "front_left_foot", "ball"});
}

/// The small humanoid with stronger motors. Its own motors cannot carry it on one leg.
class SharedHips : public testing::Test {
 protected:
  static std::string Urdf(double strength) {
    std::string urdf = ReadFile(SourceFile("tests/robots/mini_humanoid.urdf"));
    const std::string key = "effort=\"";
    for (std::size_t at = urdf.find(key); at != std::string::npos; at = urdf.find(key, at + 1)) {
      const std::size_t begin = at + key.size(), end = urdf.find('"', begin);
      const double effort = strength * std::stod(urdf.substr(begin, end - begin));
      urdf.replace(begin, end - begin, std::to_string(effort));
    }
    return urdf;
  }

  static ProjectDraft Draft(double strength) {
    return DraftProject(Urdf(strength), "mini_humanoid.urdf", {});
  }

  void ReadDraft() {
    const ProjectDraft draft = Draft(1.5);
    ASSERT_TRUE(draft.stands) << draft.held_because;
    folder_.Write("robot.urdf", draft.urdf);
    project_ = ReadProject(folder_.Write("project.yaml", FormatDraft(draft, "robot.urdf")));
  }

  ScratchFolder folder_;
  Project project_;
};

TEST_F(SharedHips, OfWeakMotorsDoNotStand) {
  const ProjectDraft draft = Draft(1.0);
  EXPECT_FALSE(draft.stands);
  EXPECT_FALSE(draft.stance);
  EXPECT_NE(draft.held_because.find("torque limit of 'right_hip_roll'"), std::string::npos)
      << draft.held_because;
  EXPECT_EQ(draft.held_because.find("before its gear"), std::string::npos);
  EXPECT_NE(Draft(0.1).held_because.find("before its gear"), std::string::npos);
}

// The hips' axes differ from the ankles', so that each place of the root link needs another angle
// of the shared motor.
TEST_F(SharedHips, KeepBothFeetFlatWhereverTheRootIs) {
  ReadDraft();
  const auto robot = StandProjectRobot(project_, {});
  ASSERT_TRUE(robot->legs[1].turns_root());
  const int shared = robot->legs[1].shared_coordinates().front();
  PlacedPosture pose{robot->rest, robot->T_world_root};
  pose.T_world_root.translation().y() += 0.02;
  ASSERT_TRUE(PlaceFeet(*robot, {0, 1}, pose));
  for (const std::size_t foot : {0u, 1u}) {
    const Transform T_world_sole = pose.T_world_root * robot->legs[foot].SolePose(pose.q);
    EXPECT_LT((T_world_sole.matrix() - robot->T_world_sole[foot].matrix()).norm(), 1e-9) << foot;
  }
  EXPECT_GT(std::abs(pose.q[shared] - robot->rest[shared]), 1e-6);
  EXPECT_LT(std::abs(pose.q[shared] - robot->rest[shared]), 1e-2);
}

// The shared motor pitches the waist. Hips then bend against it even with straight knees.
TEST_F(SharedHips, HaveKneesThatAreNotTheirMostBentJoints) {
  ReadDraft();
  const auto robot = StandProjectRobot(project_, {});
  const auto coordinate = [&](const char* joint) {
    return robot->tree.joints[Size(FindJoint(robot->tree, joint))].coordinate;
  };
  EXPECT_EQ(robot->knees,
            (std::vector<int>{coordinate("left_knee_pitch"), coordinate("right_knee_pitch")}));
  Eigen::VectorXd q = robot->rest;
  q[coordinate("left_hip_pitch")] = -0.8;
  q[coordinate("left_knee_pitch")] = 0.1;
  const MotionMargins margins = CheckMotion(*robot, {100.0, q.transpose(), {{0}}});
  EXPECT_NEAR(margins.knee.value, 0.1, 1e-12);
}

TEST_F(SharedHips, MoveTheirMotorOnOneLegAndStandInMujoco) {
  ReadDraft();
  const ChainSetup* leg = nullptr;
  for (const ChainSetup& setup : project_.motion.chains) {
    if (setup.support.size() == 1 && leg == nullptr) leg = &setup;
  }
  ASSERT_NE(leg, nullptr);
  Eigen::VectorXd q = project_.motion.rest;
  q[leg->coordinates[0]] -= 0.3;  // the shared motor
  q[leg->coordinates[1]] += 0.1;
  q[leg->coordinates[2]] -= 0.3;
  q[leg->coordinates[3]] += 0.4;
  const MotionPlan plan = PlanMotion(project_, {{leg->name, leg->support, {q}}}, {});
  ASSERT_TRUE(plan.left_out.empty()) << plan.left_out[0];
  EXPECT_TRUE(plan.broken().empty());
  // The standing foot does not move on the floor, so the root link turns over it.
  const auto heading = [&](Eigen::Index row) {
    const auto T_root_link =
        LinkTransforms(project_.tree, plan.whole.motion.q.row(row).transpose());
    return RotationVector(T_root_link[Size(leg->support[0])].linear()).z();
  };
  const Visit& visit = plan.planned[0].visits[0];
  const Eigen::Index lead = plan.whole.motion.q.rows() - plan.planned[0].motion.q.rows();
  EXPECT_GT(std::abs(heading(lead + visit.begin + 10) - heading(0)), 0.1);
  for (const MotionTrial& trial : TryMotion(project_, plan.whole.motion, {.robots = 3})) {
    EXPECT_TRUE(trial.run.stood) << trial.seed;
  }
}

/// A joint of an invented robot, and the link that it carries, with a mass of 2 kg.
std::string JointXml(const std::string& name, const std::string& parent, const std::string& place,
                     const std::string& axis, const std::string& range,
                     const std::string& shape = "") {
  return "<link name='" + name +
         "'><inertial><mass value='2'/><inertia ixx='0.01' ixy='0' ixz='0'"
         " iyy='0.01' iyz='0' izz='0.01'/></inertial>" +
         shape + "</link><joint name='" + name + "_joint' type='revolute'><parent link='" + parent +
         "'/><child link='" + name + "'/><origin xyz='" + place + "'/><axis xyz='" + axis +
         "'/><limit " + range + " effort='150' velocity='10'/></joint>\n";
}

/// A robot whose root link is its trunk. Both legs are on a waist joint, or else on the trunk. Its
/// ankles can roll, or cannot.
std::string TrunkOnLegs(bool waist, bool feet_roll) {
  std::string urdf =
      "<robot name='below'><link name='trunk'><inertial><origin xyz='0 0 0.2'/><mass value='12'/>"
      "<inertia ixx='0.2' ixy='0' ixz='0' iyy='0.2' iyz='0' izz='0.1'/></inertial><collision>"
      "<origin xyz='0 0 0.2'/><geometry><box size='0.15 0.2 "
      "0.3'/></geometry></collision></link>\n";
  if (waist) urdf += JointXml("waist", "trunk", "0 0 -0.05", "0 0 1", "lower='-1.5' upper='1.5'");
  const std::string top = waist ? "waist" : "trunk";
  for (const std::string side : {"left", "right"}) {
    const std::string y = side == "left" ? "0.1" : "-0.1";
    const auto joint = [&](const std::string& name, const std::string& parent,
                           const std::string& place, const std::string& axis,
                           const std::string& range, const std::string& shape = "") {
      urdf +=
          JointXml(side + name, parent == top ? parent : side + parent, place, axis, range, shape);
    };
    joint("_hip_yaw", top, "0 " + y + " -0.05", "0 0 1", "lower='-0.5' upper='0.5'");
    joint("_hip_roll", "_hip_yaw", "0 0 0", "1 0 0", "lower='-0.6' upper='0.6'");
    joint("_hip", "_hip_roll", "0 0 0", "0 1 0", "lower='-1.8' upper='1'");
    joint("_knee", "_hip", "0 0 -0.35", "0 1 0", "lower='0' upper='2.3'");
    const std::string foot =
        "<collision><origin xyz='0.02 0 -0.03'/><geometry><box size='0.22 0.11 0.02'/>"
        "</geometry></collision>";
    joint("_ankle", "_knee", "0 0 -0.35", "0 1 0", "lower='-1.2' upper='0.8'",
          feet_roll ? "" : foot);
    if (!feet_roll) continue;
    joint("_foot", "_ankle", "0 0 -0.03", "1 0 0", "lower='-0.6' upper='0.6'", foot);
  }
  return urdf + "</robot>\n";
}

TEST(LegsBelowAWaist, StandAndTurnTheWaistAsFarAsTheHipsAllow) {
  const ProjectDraft draft = DraftProject(TrunkOnLegs(true, true), "below.urdf", {});
  ASSERT_TRUE(draft.stands) << draft.held_because;
  std::vector<std::string> chains;
  for (const DraftedChain& chain : draft.chains) chains.push_back(chain.name);
  EXPECT_EQ(chains, (std::vector<std::string>{"left_leg", "waist_left_leg", "right_leg",
                                              "waist_right_leg", "waist"}));
  ScratchFolder folder;
  folder.Write("robot.urdf", draft.urdf);
  const Project project =
      ReadProject(folder.Write("project.yaml", FormatDraft(draft, "robot.urdf")));
  // If the feet must not move, the waist can turn by as much as the hips can turn back, 0.5 rad.
  const int waist = project.tree.joints[Size(FindJoint(project.tree, "waist_joint"))].coordinate;
  EXPECT_GT(project.motion.upper[waist], 0.2);
  EXPECT_LT(project.motion.upper[waist], 0.5);
  Eigen::VectorXd turned = project.motion.rest, leg = project.motion.rest;
  turned[waist] = 0.9 * project.motion.upper[waist];
  const ChainSetup& left = project.motion.chains[0];
  leg[left.coordinates[2]] -= 0.4;
  leg[left.coordinates[3]] += 0.5;
  const std::vector<int> both = project.motion.chains.back().support;
  ASSERT_EQ(both.size(), 2u);
  const MotionPlan plan =
      PlanMotion(project, {{"waist", both, {turned}}, {"left_leg", left.support, {leg}}}, {});
  ASSERT_TRUE(plan.left_out.empty()) << plan.left_out[0];
  EXPECT_TRUE(plan.broken().empty());
  for (const MotionTrial& trial : TryMotion(project, plan.whole.motion, {.robots = 1})) {
    EXPECT_TRUE(trial.run.stood) << trial.seed;
  }
}

// If no joint rolls the foot, the weight cannot be shifted with both soles flat.
TEST(Legs, WhoseFeetDoNotRollAreHeld) {
  const ProjectDraft draft = DraftProject(TrunkOnLegs(false, false), "below.urdf", {});
  EXPECT_FALSE(draft.soles.empty());
  EXPECT_FALSE(draft.stands);
  EXPECT_FALSE(draft.held_because.empty());
  EXPECT_NE(FormatDraft(draft, "robot.urdf").find("held still"), std::string::npos);
  EXPECT_TRUE(DraftProject(TrunkOnLegs(false, true), "below.urdf", {}).stands);
}

}  // namespace
}  // namespace elastocal
