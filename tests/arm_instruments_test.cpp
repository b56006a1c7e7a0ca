// SPDX-License-Identifier: Apache-2.0
// A fixed arm whose tool a laser tracker sees, and what goes wrong with its table.
#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/observation/observed_posture.hpp"
#include "elastocal/pipeline/contact_run.hpp"
#include "elastocal/pipeline/contact_validation.hpp"
#include "elastocal/pipeline/runtime_robot.hpp"
#include "elastocal/tables/table_writer.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

constexpr int kPostures = 30;

class ArmWithTracker : public testing::Test {
 protected:
  ArmWithTracker() {
    std::ofstream(folder_.path() / "project.yaml")
        << "robot: {urdf: " << SourceFile("tests/robots/arm6.urdf").string() << "}\n"
        << "instruments:\n"
           "  trackers: [{name: laser}]\n"
           "  poses: [{name: tool, link: tool, tracker: laser, xyz_mm: [30, 10, 20], rpy_deg: [5, "
           "3, -4]}]\n"
           "recording: {not_recorded_mm: {finger_left_joint: 10}}\n";
    project_ = ReadProject(folder_.path() / "project.yaml");
    model_ = MakeObservedRobot(project_.tree, project_.placement, project_.contact->setup, {}, {});
    Random random(7);
    truth_.robot = Eigen::VectorXd::Zero(model_.robot.parameter_count());
    for (int i = 0; i < model_.robot.parameter_count(); ++i) {
      const bool angle =
          model_.robot.parameters[static_cast<std::size_t>(i)].unit == ParameterUnit::kRadian;
      if (model_.unknown[static_cast<std::size_t>(i)] >= 0) {
        truth_.robot[i] = random.Normal(angle ? 8e-3 : 1e-3);
      }
    }
    for (const Quantity& quantity : model_.setup.quantities) {
      truth_.quantities.push_back(
          {quantity.origin, random.NormalVector(static_cast<int>(quantity.size()), 5e-3)});
    }
    q_.resize(kPostures, project_.tree.coordinate_count());
    for (int i = 0; i < kPostures; ++i) {
      for (const Joint& joint : project_.tree.joints) {
        if (joint.mimic) continue;
        const bool held = joint.name.starts_with("finger");
        q_(i, joint.coordinate) = held ? 0.01
                                       : random.Uniform(std::max(-2.0, joint.limits.lower),
                                                        std::min(2.0, joint.limits.upper));
      }
    }
    Measure(model_, truth_);
  }

  /// What the tracker sees of this robot.
  void Measure(const ObservedRobot& model, const ObservedValues& truth) {
    Observations all;
    all.q = q_;
    for (int i = 0; i < kPostures; ++i) {
      all.postures.push_back({0, i + 2});
      all.all.push_back({i, 0, {}, {}});
    }
    Random random(8);
    poses_.clear();
    for (const Sight& sight : SightsOf(model, all, truth, ObservedLoads(model, all, truth.robot))) {
      Eigen::VectorXd pose = model.instrument(0).Predict(sight);
      pose += random.NormalVector(7, 1e-4);
      pose.tail<4>().normalize();
      poses_.push_back(pose);
    }
  }

  ContactRun Calibrate(const Eigen::MatrixXd& q,
                       const std::vector<std::string>& accept = {}) const {
    return CalibrateContacts(project_, {Table(q)}, {.folds = 5, .accept = accept});
  }

  /// `first`: of the poses, that of the first row.
  std::filesystem::path Table(const Eigen::MatrixXd& q, const std::string& file_name = "table.csv",
                              std::size_t first = 0) const {
    TableWriter table;
    std::vector<int> joints;
    for (int joint : project_.tree.coordinate_joint) {
      const std::string& name = project_.tree.joints[static_cast<std::size_t>(joint)].name;
      if (name.starts_with("finger")) continue;
      joints.push_back(joint);
      table.Add(name);
    }
    for (const std::string& column : project_.contact->columns[0]) table.Add(column);
    table.EndRow();
    for (Eigen::Index i = 0; i < q.rows(); ++i) {
      for (int joint : joints) {
        table.Add(q(i, project_.tree.joints[static_cast<std::size_t>(joint)].coordinate));
      }
      for (double number : poses_[first + static_cast<std::size_t>(i)]) table.Add(number);
      table.EndRow();
    }
    const std::filesystem::path file = folder_.path() / file_name;
    std::ofstream(file) << table.text();
    return file;
  }

  static std::string First(const ContactRun& run) {
    return run.verdict.objections.empty() ? "" : run.verdict.objections.front();
  }

  int Coordinate(const std::string& joint) const {
    return project_.tree.joints[static_cast<std::size_t>(FindJoint(project_.tree, joint))]
        .coordinate;
  }

  ScratchFolder folder_;
  Project project_;
  ObservedRobot model_;
  ObservedValues truth_;
  Eigen::MatrixXd q_;
  std::vector<Eigen::VectorXd> poses_;
};

TEST_F(ArmWithTracker, ACleanTableIsDeployed) {
  const ContactRun run = Calibrate(q_);
  EXPECT_EQ(First(run), "");
  EXPECT_LT(ContactRun::Judged(run.calibrated).rows[0].rms, 4e-4);
  EXPECT_GT(ContactRun::Judged(run.uncalibrated).rows[0].rms, 2e-3);
}

TEST_F(ArmWithTracker, MistakesInTheJointsAreNamed) {
  Eigen::MatrixXd q = q_;
  q.col(Coordinate("elbow_joint")) *= -1.0;
  EXPECT_EQ(First(Calibrate(q))
                .find("elbow_joint: the sign of its positions is reversed (--accept "
                      "sign:elbow_joint corrects it);"),
            0u);
  q = q_;
  q.col(Coordinate("shoulder_joint")).swap(q.col(Coordinate("elbow_joint")));
  EXPECT_NE(First(Calibrate(q)).find(": their positions are exchanged (--accept exchange:"),
            std::string::npos);
  q.topRows(kPostures - 1) = q_.bottomRows(kPostures - 1);
  q.row(kPostures - 1) = q_.row(0);
  EXPECT_EQ(First(Calibrate(q))
                .find("what was observed belongs to the joint positions of the row "
                      "before (--accept rows:-1 corrects it);"),
            0u);
}

// Errors that a robot nearly explains: they are found in what the fit leaves.
TEST_F(ArmWithTracker, FaultsOfTheTableAreNamed) {
  const Eigen::Index elbow = Coordinate("elbow_joint");
  Eigen::MatrixXd q = q_;
  q.col(elbow) *= 1.05;
  const std::string gain = First(Calibrate(q));
  EXPECT_EQ(gain.find("elbow_joint: its positions are 1.0"), 0u) << gain;
  // To first order it would be 1.048.
  const std::string name = "--accept gain:elbow_joint=";
  ASSERT_NE(gain.find(name), std::string::npos) << gain;
  EXPECT_NEAR(std::stod(gain.substr(gain.find(name) + name.size())), 1.05, 5e-4);
  q = q_;
  q.col(elbow).tail(14).array() += 0.03;
  const std::string off = First(Calibrate(q));
  EXPECT_EQ(off.find("elbow_joint: its positions are off by 1."), 0u) << off;
  EXPECT_NE(off.find("table.csv:18 on (--accept offset:elbow_joint@table.csv:17="),
            std::string::npos)
      << off;
  q = q_;
  q.col(elbow).segment(8, 9).setConstant(q_(8, elbow));
  const std::string frozen = First(Calibrate(q));
  EXPECT_EQ(frozen.find("elbow_joint: its positions are frozen in 9 postures from "), 0u) << frozen;
  EXPECT_NE(frozen.find("table.csv:10 on, while it moved (--accept frozen:"), std::string::npos)
      << frozen;
}

// What is accepted leaves the calibration of the sound table.
TEST_F(ArmWithTracker, FaultsAreCorrectedOnRequest) {
  const Eigen::Index elbow = Coordinate("elbow_joint"), shoulder = Coordinate("shoulder_joint");
  const double sound = ContactRun::Judged(Calibrate(q_).calibrated).rows[0].rms;
  const auto expect_sound = [&](const Eigen::MatrixXd& q, const std::string& name) {
    const ContactRun run = Calibrate(q, {name});
    EXPECT_EQ(First(run), "") << name;
    EXPECT_LT(ContactRun::Judged(run.calibrated).rows[0].rms, 1.5 * sound) << name;
    const auto corrected = [](const std::string& warning) {
      return warning.starts_with("corrected on request: ");
    };
    EXPECT_TRUE(std::any_of(run.warnings.begin(), run.warnings.end(), corrected)) << name;
  };
  Eigen::MatrixXd q = q_;
  q.col(elbow) *= -1.0;
  expect_sound(q, "sign:elbow_joint");
  q = q_;
  q.col(elbow).swap(q.col(shoulder));
  expect_sound(q, "exchange:elbow_joint,shoulder_joint");
  q.topRows(kPostures - 1) = q_.bottomRows(kPostures - 1);
  q.row(kPostures - 1) = q_.row(0);
  expect_sound(q, "rows:-1");
  q = q_;
  q.col(elbow) *= 1.03;
  expect_sound(q, "gain:elbow_joint=1.03");
  q = q_;
  q.col(elbow).tail(14).array() += 0.03;
  expect_sound(q, "offset:elbow_joint@table.csv:17=1.71887");
  q = q_;
  q.col(elbow).segment(8, 9).setConstant(q_(8, elbow));
  expect_sound(q, "frozen:elbow_joint");
  for (Eigen::VectorXd& pose : poses_) pose.head<3>() *= 1.03;
  expect_sound(q_, "scale=1.03");
}

TEST_F(ArmWithTracker, NamesThatCorrectNothingAreRefused) {
  const auto refused = [&](const std::string& name, const std::string& why) {
    ExpectInputError([&] { Calibrate(q_, {name}); }, {"--accept " + name, why});
  };
  refused("sign:elbow", "no moving joint 'elbow'");
  refused("exchange:elbow_joint", "exchange:JOINT,JOINT was expected");
  refused("frozen:elbow_joint", "not the same in five rows");
  refused("rows:0", "rows:+1");
  refused("rows:1.5", "rows:+1");
  refused("offset:elbow_joint@other.csv=2", "in a file 'other.csv'");
  refused("offset:elbow_joint@table.csv:31=2", "no posture 31");
  refused("labels:A,B", "sign:JOINT, exchange:JOINT,JOINT");
  ExpectInputError(
      [&] {
        Calibrate(q_, {"sign:elbow_joint", "sign:elbow_joint"});
      },
      {"given twice"});
}

TEST_F(ArmWithTracker, ADriftIsNamed) {
  Eigen::MatrixXd q = q_;
  q.col(Coordinate("elbow_joint")) += Eigen::VectorXd::LinSpaced(kPostures, 0.0, 0.02);
  const std::string drift = First(Calibrate(q));
  EXPECT_EQ(drift.find("elbow_joint: its positions drift by 1."), 0u) << drift;
  EXPECT_NE(drift.find("deg from the first row to the last (measure again);"), std::string::npos)
      << drift;
}

TEST_F(ArmWithTracker, ABodyThatWasBumpedIsNamed) {
  const Eigen::Vector3d shift(0.003, 0.004, 0.0);
  for (std::size_t i = 15; i < poses_.size(); ++i) {
    Eigen::VectorXd& pose = poses_[i];
    pose.head<3>() += Eigen::Quaterniond(pose[6], pose[3], pose[4], pose[5]) * shift;
  }
  const std::string bumped = First(Calibrate(q_));
  EXPECT_EQ(bumped.find("tool was moved on its link by some "), 0u) << bumped;
  EXPECT_NE(bumped.find("table.csv:17 (calibrate the rows before and after apart);"),
            std::string::npos)
      << bumped;
}

// On the second of two days a joint has a wrong gain, or the tracker a wrong scale.
TEST_F(ArmWithTracker, AFaultOfOneFileIsNamed) {
  constexpr int kFirstDay = 18;
  const auto first_of = [&](const Eigen::MatrixXd& q, const std::vector<std::string>& accept) {
    const auto first = Table(q.topRows(kFirstDay), "first.csv");
    const auto second = Table(q.bottomRows(kPostures - kFirstDay), "second.csv", kFirstDay);
    return First(CalibrateContacts(project_, {first, second}, {.folds = 5, .accept = accept}));
  };
  Eigen::MatrixXd q = q_;
  q.col(Coordinate("elbow_joint")).tail(kPostures - kFirstDay) *= 1.03;
  const std::string gain = first_of(q, {});
  EXPECT_EQ(gain.find("elbow_joint: its positions are 1.0"), 0u) << gain;
  EXPECT_NE(gain.find("--accept gain:elbow_joint@second.csv=1.0"), std::string::npos) << gain;
  EXPECT_EQ(first_of(q, {"gain:elbow_joint@second.csv=1.03"}), "");
  for (std::size_t i = kFirstDay; i < poses_.size(); ++i) poses_[i].head<3>() *= 1.02;
  const std::string scale = first_of(q_, {});
  EXPECT_EQ(scale.find("lengths as they were measured in "), 0u) << scale;
  EXPECT_NE(scale.find("--accept scale:second.csv=1.0"), std::string::npos) << scale;
  EXPECT_EQ(first_of(q_, {"scale:second.csv=1.02"}), "");
}

TEST_F(ArmWithTracker, ATrackerThatWasMovedIsNamed) {
  for (std::size_t i = 12; i < poses_.size(); ++i) poses_[i][1] += 0.006;
  const std::string moved = First(Calibrate(q_));
  EXPECT_EQ(moved.find("laser was moved by some "), 0u) << moved;
  EXPECT_NE(moved.find("table.csv:14 (each file is a session of its own: split"), std::string::npos)
      << moved;
}

// On the second day the tracker stands elsewhere: each file is a session of it.
TEST_F(ArmWithTracker, ATrackerIsSetUpAnewForEachFile) {
  constexpr int kFirstDay = 18;
  const Transform T = FromXyzRpy({0.6, -1.1, 0.2}, {0.02, -0.03, 1.4});
  for (std::size_t i = kFirstDay; i < poses_.size(); ++i) {
    Eigen::VectorXd& pose = poses_[i];
    const Eigen::Quaterniond turn(pose[6], pose[3], pose[4], pose[5]);
    pose.head<3>() = T * pose.head<3>().eval();
    pose.tail<4>() = (Eigen::Quaterniond(T.linear()) * turn).coeffs();
  }
  const auto first = Table(q_.topRows(kFirstDay), "first.csv");
  const auto second = Table(q_.bottomRows(kPostures - kFirstDay), "second.csv", kFirstDay);
  const ContactRun run = CalibrateContacts(project_, {first, second}, {.folds = 5});
  EXPECT_EQ(First(run), "");
  EXPECT_LT(ContactRun::Judged(run.calibrated).rows[0].rms, 4e-4);
  ASSERT_EQ(run.calibrated.estimate.fit.values.effects.size(), 2u);
  const auto& effects = run.calibrated.estimate.fit.values.effects;
  EXPECT_NEAR((effects[1] - effects[0]).tail<3>().norm(), 1.4, 0.02);
}

TEST_F(ArmWithTracker, AWrongScaleIsNamed) {
  for (Eigen::VectorXd& pose : poses_) pose.head<3>() *= 1.03;
  const std::string scale = First(Calibrate(q_));
  EXPECT_EQ(scale.find("lengths as they were measured seem 1.0"), 0u) << scale;
}

// Nobody says whether its joints give way. Where they do, left-out postures tell; a joint that
// bends under gravity is no wrong gain.
TEST_F(ArmWithTracker, JointsThatGiveWayAreFound) {
  std::vector<int> all;
  for (std::size_t k = 0; k < project_.tree.joints.size(); ++k) all.push_back(static_cast<int>(k));
  const ObservedRobot elastic =
      MakeObservedRobot(project_.tree, project_.placement, project_.contact->setup, all, {});
  ObservedValues truth = truth_;
  truth.robot = Eigen::VectorXd::Zero(elastic.robot.parameter_count());
  for (int i = 0; i < elastic.robot.parameter_count(); ++i) {
    const Parameter& parameter = elastic.robot.parameters[static_cast<std::size_t>(i)];
    if (!IsCompliance(parameter.kind)) {
      truth.robot[i] = truth_.robot[FindParameter(model_.robot.parameters, parameter.name)];
    } else if (parameter.unit == ParameterUnit::kRadianPerNewtonMetre) {
      truth.robot[i] = 300e-6;
    }
  }
  EXPECT_FALSE(Calibrate(q_).geometric);
  Measure(elastic, truth);
  const ContactRun run = Calibrate(q_);
  EXPECT_EQ(First(run), "");
  ASSERT_TRUE(run.geometric);
  EXPECT_LT(ContactRun::Judged(run.calibrated).rows[0].rms, 5e-4);
  EXPECT_GT(ContactRun::Judged(*run.geometric).rows[0].rms,
            2.0 * ContactRun::Judged(run.calibrated).rows[0].rms);
  Project rigid = project_;
  rigid.elasticity.torsion.emplace();
  EXPECT_FALSE(CalibrateContacts(rigid, {Table(q_)}, {.folds = 5}).geometric);
}

// No mistake that has a name: the estimate needs what no robot is.
TEST_F(ArmWithTracker, WhatNoRobotExplainsIsRefused) {
  for (Eigen::VectorXd& pose : poses_) {  // w first
    const Eigen::Vector4d quaternion = pose.tail<4>();
    pose.tail<4>() << quaternion[3], quaternion[0], quaternion[1], quaternion[2];
  }
  const ContactRun run = Calibrate(q_);
  EXPECT_FALSE(run.deployable());
  EXPECT_NE(First(run).find("rotation of tool off by"), std::string::npos) << First(run);
}

// Its project has no markers: the parameters of its joints come back all the same, and those that
// the deployed URDF has are known apart.
TEST_F(ArmWithTracker, TheStoredRobotIsTheCalibratedOne) {
  ContactRun run = Calibrate(q_);
  ASSERT_EQ(First(run), "");
  const auto files = MakeContactFiles(project_, run);
  std::ofstream(folder_.path() / "calibration.yaml") << files.at("calibration.yaml");
  const StoredCalibration stored = ReadCalibration(folder_.path() / "calibration.yaml");
  const StoredRobot robot = RestoreRobot(project_, stored);
  int restored = 0;
  for (int i = 0; i < run.result.model.parameter_count(); ++i) {
    const Parameter& parameter = run.result.model.parameters[static_cast<std::size_t>(i)];
    if (IsExternal(parameter.kind) || run.result.delta[i] == 0.0) continue;
    const int k = FindParameter(robot.model.parameters, parameter.name);
    ASSERT_GE(k, 0) << parameter.name;
    EXPECT_NEAR(robot.errors[k], run.result.delta[i], 1e-12) << parameter.name;
    ++restored;
  }
  EXPECT_GT(restored, 20);
}

// A calibration from a table whose rows were shifted says better of itself; other data do not.
TEST_F(ArmWithTracker, ValidationRefusesWhatIsWorseOrNoRobot) {
  ContactRun run = Calibrate(q_);
  ASSERT_EQ(First(run), "");
  std::ofstream(folder_.path() / "calibration.yaml")
      << MakeContactFiles(project_, run).at("calibration.yaml");
  EXPECT_TRUE(
      ValidateContacts(project_, folder_.path() / "calibration.yaml", {Table(q_)}, true).better());
  Eigen::MatrixXd q = q_;
  q.col(Coordinate("elbow_joint")) *= -1.0;
  const ContactValidation wrong =
      ValidateContacts(project_, folder_.path() / "calibration.yaml", {Table(q)}, true);
  ASSERT_FALSE(wrong.better());
  EXPECT_EQ(wrong.objections.front().find("elbow_joint: the sign of its positions is reversed"), 0u)
      << wrong.objections.front();
  EXPECT_TRUE(ValidateContacts(project_, folder_.path() / "calibration.yaml", {Table(q)}, true,
                               {"sign:elbow_joint"})
                  .better());
}

// Errors that are far above what the calibration left are no better robot, though they are smaller
// than those of the nominal one.
TEST_F(ArmWithTracker, ValidationKnowsWhatTheCalibrationLeft) {
  ContactRun run = Calibrate(q_);
  ASSERT_EQ(First(run), "");
  std::ofstream(folder_.path() / "calibration.yaml")
      << MakeContactFiles(project_, run).at("calibration.yaml");
  const auto validate = [&](double gain) {
    Eigen::MatrixXd q = q_;
    q.col(Coordinate("elbow_joint")) *= gain;
    return ValidateContacts(project_, folder_.path() / "calibration.yaml", {Table(q)}, true);
  };
  EXPECT_TRUE(validate(1.0).warnings.empty());
  const ContactValidation slightly = validate(1.002);
  EXPECT_TRUE(slightly.better());
  ASSERT_FALSE(slightly.warnings.empty());
  EXPECT_NE(slightly.warnings.back().find("where the calibration left"), std::string::npos);
  EXPECT_FALSE(validate(1.02).better());
}

}  // namespace
}  // namespace elastocal
