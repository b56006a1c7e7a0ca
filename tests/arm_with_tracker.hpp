// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "elastocal/observation/observed_posture.hpp"
#include "elastocal/pipeline/contact_run.hpp"
#include "elastocal/tables/table_writer.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {

/// A table of these postures with a measurement of every instrument of the model, to be filled in.
inline Observations WithEveryInstrument(const ObservedRobot& model, const Eigen::MatrixXd& q) {
  Observations seen;
  seen.files = {"table.csv"};
  seen.q = q;
  for (int i = 0; i < static_cast<int>(q.rows()); ++i) {
    seen.postures.push_back({0, i + 2});
    for (int k = 0; k < static_cast<int>(model.setup.instruments.size()); ++k) {
      seen.all.push_back({i, k, {}, {}});
    }
  }
  return seen;
}

/// A fixed arm with errors. A laser tracker sees its tool in 30 postures.
class ArmWithTracker : public testing::Test {
 protected:
  static constexpr int kPostures = 30;

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

  /// Makes all joints give way about their axes by this compliance, rad/(N.m).
  void MakeElastic(double compliance) {
    std::vector<int> all(project_.tree.joints.size());
    std::iota(all.begin(), all.end(), 0);
    const ObservedRobot elastic =
        MakeObservedRobot(project_.tree, project_.placement, project_.contact->setup, all, {});
    ObservedValues truth = truth_;
    truth.robot = Eigen::VectorXd::Zero(elastic.robot.parameter_count());
    for (int i = 0; i < elastic.robot.parameter_count(); ++i) {
      const Parameter& parameter = elastic.robot.parameters[static_cast<std::size_t>(i)];
      if (!IsCompliance(parameter.kind)) {
        truth.robot[i] = truth_.robot[FindParameter(model_.robot.parameters, parameter.name)];
      } else if (parameter.unit == ParameterUnit::kRadianPerNewtonMetre) {
        truth.robot[i] = compliance;
      }
    }
    Measure(elastic, truth);
  }

  /// Simulates what the tracker sees of this robot.
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

  /// Calibrates from all postures and returns the folder.
  std::filesystem::path WriteCalibration() const { return WriteCalibration(Calibrate(q_)); }

  std::filesystem::path WriteCalibration(ContactRun run) const {
    EXPECT_TRUE(run.deployable()) << First(run);
    const std::filesystem::path out = folder_.path() / "out";
    std::filesystem::create_directory(out);
    for (const auto& [name, text] : MakeContactFiles(project_, run)) {
      std::ofstream(out / name) << text;
    }
    return out;
  }

  /// Moves the tracker, as on another day.
  void MoveTracker() {
    for (std::size_t i = 0; i < model_.setup.quantities.size(); ++i) {
      if (model_.setup.quantities[i].of_surroundings) truth_.quantities[i].x.array() += 0.05;
    }
    Measure(model_, truth_);
  }

  /// Turns a joint (or changes a link), as on another day.
  void Change(const std::string& parameter, double by) {
    truth_.robot[FindParameter(model_.robot.parameters, parameter)] += by;
    Measure(model_, truth_);
  }

  /// Writes a table of these postures. `first`: number of the pose in the first row.
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

}  // namespace elastocal
