// SPDX-License-Identifier: Apache-2.0
// A fixed arm whose tool a laser tracker sees, and what goes wrong with its table.
#include <fstream>

#include <gtest/gtest.h>

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/observation/observed_posture.hpp"
#include "elastocal/pipeline/contact_run.hpp"
#include "elastocal/pipeline/contact_validation.hpp"
#include "elastocal/pipeline/runtime_robot.hpp"
#include "elastocal/tables/table_writer.hpp"
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
    Observations all;
    all.q = q_;
    for (int i = 0; i < kPostures; ++i) {
      all.postures.push_back({0, i + 2});
      all.all.push_back({i, 0, {}, {}});
    }
    const auto sights = SightsOf(model_, all, truth_, {});
    for (const Sight& sight : sights) {
      Eigen::VectorXd pose = model_.instrument(0).Predict(sight);
      pose += random.NormalVector(7, 1e-4);
      pose.tail<4>().normalize();
      poses_.push_back(pose);
    }
  }

  ContactRun Calibrate(const Eigen::MatrixXd& q, int folds = 5) const {
    return CalibrateContacts(project_, {Table(q)}, {.folds = folds});
  }

  std::filesystem::path Table(const Eigen::MatrixXd& q) const {
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
      for (double number : poses_[static_cast<std::size_t>(i)]) table.Add(number);
      table.EndRow();
    }
    const std::filesystem::path file = folder_.path() / "table.csv";
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
  EXPECT_EQ(First(Calibrate(q)).find("elbow_joint: the sign of its positions is reversed;"), 0u);
  q = q_;
  q.col(Coordinate("shoulder_joint")).swap(q.col(Coordinate("elbow_joint")));
  EXPECT_NE(First(Calibrate(q)).find(": their positions are exchanged;"), std::string::npos);
  q.topRows(kPostures - 1) = q_.bottomRows(kPostures - 1);
  q.row(kPostures - 1) = q_.row(0);
  EXPECT_EQ(First(Calibrate(q))
                .find("what was observed belongs to the joint positions of the row "
                      "before;"),
            0u);
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
  EXPECT_EQ(wrong.objections.front().find("no calibrated robot errs like this: position of tool"),
            0u)
      << wrong.objections.front();
}

}  // namespace
}  // namespace elastocal
