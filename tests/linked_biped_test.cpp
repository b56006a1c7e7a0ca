// SPDX-License-Identifier: Apache-2.0
// Legs whose knees and ankles are moved by rods: tables and logs of their motors, recovery of the
// truth, and a robot of MuJoCo, from files to calibrated rods.

#include "tests/linked_biped.hpp"

#include <array>
#include <numeric>
#include <sstream>

#include <gtest/gtest.h>

#include "elastocal/elastocal.hpp"
#include "elastocal/io/joint_log.hpp"
#include "elastocal/io/linkage_file.hpp"
#include "elastocal/io/motor_columns.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/io/recorded_files.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/mistakes/stated_corrections.hpp"
#include "elastocal/motion/motion_check.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/robot/linkage_errors.hpp"
#include "elastocal/robot/move_motors.hpp"
#include "elastocal/robot/zero_offset.hpp"
#include "elastocal/screening/recording_faults.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "elastocal/simulation/true_robot.hpp"
#include "elastocal/simulation/virtual_robot.hpp"
#include "elastocal/tables/read_file.hpp"
#include "elastocal/validation/moved_joints.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

TEST_F(LinkedBiped, ItsTablesHoldTheMotors) {
  EXPECT_TRUE(project_.tree.warnings.empty()) << project_.tree.warnings[0];
  const Recording recording = MakeSyntheticRecording(
      model_, Eigen::VectorXd::Zero(model_.parameter_count()), {.postures = 5, .marker_sd = 0.0});
  const PostureTable by_motors = ReadBack(recording, project_.tree);
  const std::string text = ReadFile(File("table.csv"));
  EXPECT_NE(text.find(",left_ankle_outer,"), std::string::npos);
  EXPECT_EQ(text.find("left_ankle_pitch"), std::string::npos);
  EXPECT_LT((by_motors.recording.q - recording.q).cwiseAbs().maxCoeff(), 1e-11);
  // If a table has the motors, its columns of the joints are ignored.
  std::string both;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    both += line + (both.empty() ? ",left_ankle_pitch\n" : ",0.5\n");
  }
  std::istringstream stream(both);
  EXPECT_EQ(ReadPostureTable(stream, "both", project_).recording.q, by_motors.recording.q);
  // A controller that logs joint positions computes them with the nominal rods.
  EXPECT_EQ(ReadBack(recording, unlinked_).recording.q, recording.q);

  Recording motors = recording;
  RobotTree named = JointsToMotors(project_.tree, {}, motors.q);
  named.linkages.clear();
  EXPECT_EQ(ReadBack(motors, named).recording.q, by_motors.recording.q);
  const int outer = FindJoint(named, "left_ankle_outer");
  motors.q(2, named.joints[outer].coordinate) = 3.0;
  ExpectInputError([&] { ReadBack(motors, named); },
                   {"table.csv:4: ", "'left_ankle_outer' at 3 rad", "'left_ankle'"});
  Recording degrees = recording;
  RobotTree in_degrees = JointsToMotors(project_.tree, {}, degrees.q);
  in_degrees.linkages.clear();
  for (const char* name : {"left_ankle_outer", "left_ankle_inner"}) {
    const Joint& joint = in_degrees.joints[Size(FindJoint(in_degrees, name))];
    degrees.q.col(joint.coordinate) *= 180.0 / M_PI;
  }
  ExpectInputError([&] { ReadBack(degrees, in_degrees); },
                   {"'left_ankle'", "(they would close with degrees read as such)"});
  named.joints[outer].name = "left_ankle_pitch";
  ExpectInputError([&] { ReadBack(recording, named); },
                   {"table.csv: ", "'left_ankle_inner'", "none of 'left_ankle_outer'"});
  Recording without = recording;
  without.joints_not_recorded = {"left_ankle_pitch", "left_ankle_roll"};
  ExpectInputError([&] { ReadBack(without, project_.tree); },
                   {"'left_ankle_pitch'",
                    "is missing (or those of its motors 'left_ankle_outer', "
                    "'left_ankle_inner')"});
}

// The power of the motors is the power of the joints.
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

  // A log in another format, with columns in the order of their names, gives the same.
  const JointLog taken = TakeJoints(motors, project_);
  for (std::size_t i = 0; i < taken.names.size(); ++i) {
    const auto found = std::find(log.names.begin(), log.names.end(), taken.names[i]);
    ASSERT_NE(found, log.names.end()) << taken.names[i];
    const auto column = static_cast<Eigen::Index>(i);
    const Eigen::VectorXd difference =
        taken.positions.col(column) - log.positions.col(found - log.names.begin());
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-11) << taken.names[i];
  }
  // A joint has a torque if all its motors have one.
  JointLog some = motors;
  const auto outer = std::find(some.names.begin(), some.names.end(), "left_ankle_outer");
  some.torques.col(outer - some.names.begin()).setConstant(kNaN);
  MotorsToJoints(project_.tree, some);
  for (std::size_t i = 0; i < some.names.size(); ++i) {
    const bool of_ankle = some.names[i].starts_with("left_ankle");
    EXPECT_EQ(some.torques.col(static_cast<Eigen::Index>(i)).array().isNaN().all(), of_ankle);
  }
}

TEST_F(LinkedBiped, KnowsTheZerosOfItsMotors) {
  std::vector<std::string> zeros;
  for (const Parameter& parameter : model_.parameters) {
    if (parameter.linkage >= 0 && IsZeroOffset(parameter, model_.tree)) {
      zeros.push_back(parameter.name);
    }
  }
  EXPECT_EQ(zeros, (std::vector<std::string>{"left_knee_actuator.length", "left_ankle_outer.zero",
                                             "left_ankle_inner.zero", "right_knee_actuator.length",
                                             "right_ankle_outer.zero", "right_ankle_inner.zero"}));
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

/// The joint positions that the calibrated rods in a file give where the nominal rods give `q`.
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

// The actuator's foot is at (-60, 300) mm from the knee, its anchor at (-50, -20) mm in the shank,
// which the knee turns. The lever is the distance between the knee and the line through both.
TEST_F(LinkedBiped, ThePlanKeepsRodsAwayFromDeadPoints) {
  const Linkage& knee = model_.tree.linkages[0];
  ASSERT_EQ(knee.name, "left_knee");
  const auto lever = [](double a) {
    const Eigen::Vector2d foot(-60.0, 300.0);
    const Eigen::Vector2d anchor(-50.0 * std::cos(a) - 20.0 * std::sin(a),
                                 50.0 * std::sin(a) - 20.0 * std::cos(a));
    const Eigen::Vector2d rod = (anchor - foot).normalized();
    return std::abs(anchor.x() * rod.y() - anchor.y() * rod.x());
  };
  const auto at = [](double a) { return Eigen::VectorXd::Constant(1, a); };
  for (const double a : {0.0, 0.7, 1.47, 1.745}) {
    EXPECT_NEAR(LeverShare(model_.tree, knee, at(a)), lever(a) / lever(knee.assembled[0]), 1e-9);
  }
  EXPECT_EQ(LeverShare(model_.tree, knee, knee.assembled), 1.0);

  // At 100 degrees, the line passes close to the knee.
  const StandingRobot robot(model_.tree, {}, {.position_margin = -1.0, .torque_share = 100.0});
  SampledMotion motion{100.0, NeutralPosture(model_.tree, 0.01).transpose(), {{}}};
  EXPECT_EQ(Broken(CheckMotion(robot, motion), robot.limits), std::nullopt);
  motion.q(0, CoordinatesOf(model_.tree, knee)[0]) = 1.745;
  const MotionMargins margins = CheckMotion(robot, motion);
  EXPECT_EQ(BrokenConstraints(margins, robot.limits), std::vector{Constraint::kLever});
  EXPECT_EQ(margins.lever.index, 0);
}

/// A table of the motors and markers of a rigid robot that settles in MuJoCo under its weight.
/// tests/study/linkage_study.py tests whole recordings of elastic robots.
class OfMujoco : public LinkedBiped {
 protected:
  static constexpr int kPostures = 60, kSeen = 50;

  OfMujoco() {
    TruthOptions truth;
    truth.upper_elasticity_scale = truth.friction_share = 0.0;
    robot_ = DrawTrueRobot(NominalRobot(project_.tree, project_.markers, {}, {}), truth);
  }

  Recording Record() const {
    Recording measured = MakeSyntheticRecording(
        model_, Eigen::VectorXd::Zero(model_.parameter_count()), {.postures = kPostures});
    for (int i = 0; i < kPostures; ++i) {
      VirtualRobot body(robot_, {}, measured.q.row(i).transpose(), {});
      body.Settle(2.0);
      measured.q.row(i) = body.Encoders()(project_.tree.coordinate_joint).transpose();
      measured.markers.row(i) =
          (body.WaistPose().inverse() * body.MarkerPositions()).reshaped().transpose();
    }
    return ReadBack(measured, project_.tree).recording;
  }

  /// Largest distances of held-out markers: calibrated, calibrated with exact rods, uncalibrated.
  std::array<double, 3> HeldOut() const {
    const Recording recording = Record();
    std::vector<int> seen(kSeen), unseen(kPostures - kSeen);
    std::iota(seen.begin(), seen.end(), 0);
    std::iota(unseen.begin(), unseen.end(), kSeen);
    const Recording held_out = SelectPostures(recording, unseen);
    const CalibrationResult result =
        Calibrate(model_, SelectPostures(recording, seen), FindBaseParameters(model_, {}),
                  ModelKind::kGeometric, {});
    Eigen::VectorXd exact_rods = result.delta;
    for (int i = 0; i < exact_rods.size(); ++i) {
      if (model_.parameters[i].linkage >= 0) exact_rods[i] = 0.0;
    }
    const auto furthest = [&](const Eigen::VectorXd& delta) {
      return Predict(result.model, delta, held_out, {}).distances.maxCoeff();
    };
    return {furthest(result.delta), furthest(exact_rods),
            furthest(Eigen::VectorXd::Zero(model_.parameter_count()))};
  }

  TrueRobot robot_;
};

// The truth has the model's form, because the loops close on the nominal tree.
TEST_F(OfMujoco, RodsAreFoundFromMotors) {
  for (std::size_t k = 0; k < robot_.tree.joints.size(); ++k) {
    robot_.tree.joints[k].T_parent_child = robot_.described.joints[k].T_parent_child;
  }
  const auto [calibrated, exact_rods, uncalibrated] = HeldOut();
  EXPECT_LT(calibrated, 1e-6);
  EXPECT_GT(exact_rods, 2e-3);
  EXPECT_GT(uncalibrated, 1e-2);
}

// The loops close on the true tree, whose axes are displaced by 0.8 mm and 0.2 degrees each. The
// model leaves errors of second order, 0.03 mm.
TEST_F(OfMujoco, DisplacedAxesAreFoundAsDisplacedAnchors) {
  const auto [calibrated, exact_rods, uncalibrated] = HeldOut();
  EXPECT_LT(calibrated, 6e-5);
  EXPECT_GT(exact_rods, 2e-3);
  EXPECT_GT(uncalibrated, 1e-2);
}

// If a lever is wrong, rods turn a joint by a multiple of what the motors show. This is an error of
// the robot, so no joint must be accused of a wrong gain.
TEST_F(OfMujoco, LeversThatAreOffAreNoFaultsOfTheRecording) {
  Recording recording = Record();
  Random random(3);
  for (auto row : recording.markers.rowwise()) row += random.NormalVector(row.size(), 2e-5);
  const CalibrationOptions options;
  const CalibrationResult result =
      Calibrate(model_, recording, FindBaseParameters(model_, {}), ModelKind::kGeometric, options);
  for (const RecordingFault& fault : FindRecordingFaults(result, recording, options)) {
    ADD_FAILURE() << DescribeFault(fault, model_.tree, recording);
  }
}

// The encoder of a motor slips. Its offset turns both joints of the ankle by what the rods make of
// it in each posture.
TEST_F(OfMujoco, AnOffsetOfAMotorIsNamedAndCorrected) {
  Recording recording = Record();
  Random random(3);
  for (auto row : recording.markers.rowwise()) row += random.NormalVector(row.size(), 2e-5);
  const Recording sound = recording;
  const RobotTree& tree = project_.tree;
  const int from = recording.posture_count() / 2;
  const auto slip = [](Eigen::VectorXd& motors) { motors[0] += 0.03; };
  for (int i = from; i < recording.posture_count(); ++i) {
    Eigen::VectorXd q = recording.q.row(i).transpose();
    ASSERT_TRUE(MoveMotors(tree, tree.linkages[1], slip, q));
    recording.q.row(i) = q.transpose();
  }
  const CalibrationOptions options;
  const CalibrationResult result =
      Calibrate(model_, recording, FindBaseParameters(model_, {}), ModelKind::kGeometric, options);
  const std::vector<RecordingFault> faults = FindRecordingFaults(result, recording, options);
  ASSERT_FALSE(faults.empty());
  EXPECT_EQ(faults[0].linkage, 1);
  EXPECT_EQ(faults[0].coordinate, 0);
  EXPECT_NEAR(faults[0].size, 0.03, 2e-3);
  EXPECT_NEAR(faults[0].posture, from, 1);
  EXPECT_EQ(DescribeFault(faults[0], tree, recording).find("left_ankle_outer: its positions are"),
            0u);

  // The same offset in one trial, corrected by its name.
  Measurements measured;
  measured.calibration = recording;
  measured.calibration.trials = {{.name = "a", .chains = {}}, {.name = "b", .chains = {}}};
  measured.calibration.trial.assign(Size(recording.posture_count()), 0);
  for (int i = from; i < recording.posture_count(); ++i) measured.calibration.trial[Size(i)] = 1;
  RecordingFault of_trial = faults[0];
  of_trial.trial = 1;
  of_trial.size = 0.03;
  const auto name = NameOfCorrection(of_trial, tree, measured.calibration);
  ASSERT_TRUE(name);
  EXPECT_EQ(*name, "offset:left_ankle_outer@b=1.7189");
  EXPECT_EQ(ApplyCorrection(*ParseStatedCorrection(*name, tree), tree, measured),
            "1.7189 deg were taken from the positions of left_ankle_outer in trial b");
  EXPECT_LT((measured.calibration.q - sound.q).cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace elastocal
