// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/io/calibration_file.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/corrections.hpp"
#include "elastocal/runtime/compensator.hpp"
#include "tests/run_program.hpp"
#include "tests/runtime_calibration.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {

/// The small TALOS with a random calibration in a folder.
class CalibratedTalos : public testing::Test {
 protected:
  CalibratedTalos()
      : project_(ReadProject(ProjectFile())), stored_(RandomCalibration(project_, 1)) {
    WriteCalibration(stored_);
  }

  static std::string ProjectFile() { return SourceFile("models/talos/project.yaml").string(); }

  void WriteCalibration(const StoredCalibration& stored) {
    CalibrationEstimate estimate;
    estimate.robot = stored.robot;
    estimate.nominal = stored.nominal;
    estimate.recording = "drawn <at> random -- twice";
    estimate.model = "full";
    const auto add = [&](const std::string& name, ParameterUnit unit) {
      const auto value = stored.joint_errors.find(name);
      if (value == stored.joint_errors.end()) return;
      estimate.parameters.push_back({.name = name,
                                     .unit = UnitName(unit),
                                     .value = value->second,
                                     .sd = std::max(0.1 * std::abs(value->second), 1e-12)});
    };
    const StoredRobot robot = RestoreRobot(project_, stored);
    for (const Parameter& parameter : robot.model.parameters) add(parameter.name, parameter.unit);
    for (const Correction& cause : PossibleCorrections(project_.tree, std::nullopt)) {
      add(cause.name, cause.unit);
    }
    std::filesystem::create_directories(scratch_.path() / "out");
    scratch_.Write("out/calibration.yaml", MakeCalibrationYaml(estimate));
  }

  /// Exports into a file and returns its path.
  std::string Export(const std::string& format, const std::string& more = "") {
    const std::string file = (scratch_.path() / format).string();
    const ProgramResult result = RunExport(format, file, more);
    EXPECT_EQ(result.exit_code, 0) << format << ": " << result.err;
    return file;
  }

  ProgramResult RunExport(const std::string& format, const std::string& file,
                          const std::string& more = "") const {
    return RunProgram("export " + (scratch_.path() / "out").string() + " --project " +
                      ProjectFile() + " --format " + format + " -o " + file + " " + more);
  }

  ProgramResult Compensate(const std::string& motion, const std::string& more = "") const {
    return RunProgram("compensate " + (scratch_.path() / "out").string() + " --project " +
                      ProjectFile() + " --motion " + motion + " -o " +
                      (scratch_.path() / "corrected.csv").string() + " " + more);
  }

  Compensator Robot(RuntimeContent content) const {
    return Compensator(MakeRuntimeModel(project_, stored_, content));
  }

  Eigen::VectorXd Posture(int number) const {
    Eigen::VectorXd q = project_.motion.rest;
    for (Eigen::Index c = 0; c < q.size(); ++c) q[c] += 0.1 * std::sin(1.7 * number + 2.3 * c);
    return q.cwiseMax(project_.motion.lower).cwiseMin(project_.motion.upper);
  }

  /// The zeros of the encoders by coordinate.
  Eigen::VectorXd Zeros(const std::map<std::string, double>& by_joint) const {
    Eigen::VectorXd zeros = Eigen::VectorXd::Zero(project_.tree.coordinate_count());
    for (std::size_t c = 0; c < project_.tree.coordinate_joint.size(); ++c) {
      const auto joint = static_cast<std::size_t>(project_.tree.coordinate_joint[c]);
      const auto zero = by_joint.find(project_.tree.joints[joint].name);
      if (zero != by_joint.end()) zeros[static_cast<Eigen::Index>(c)] = zero->second;
    }
    return zeros;
  }

  std::map<std::string, double> TrueZeros() const {
    std::map<std::string, double> zeros;
    for (const Joint& joint : project_.tree.joints) {
      const auto found = stored_.joint_errors.find(joint.name + ".theta");
      if (!joint.mimic && found != stored_.joint_errors.end()) zeros[joint.name] = found->second;
    }
    return zeros;
  }

  /// Checks that a robot description at the encoders' positions plus `zeros` is the calibrated
  /// rigid robot.
  void ExpectTheCalibratedRobot(const std::string& urdf,
                                const std::map<std::string, double>& zeros) {
    const RobotTree tree = ParseUrdf(urdf, "exported");
    Compensator rigid = Robot(RuntimeContent::kGeometry);
    double largest = 0.0;
    for (int posture = 0; posture < 1000; ++posture) {
      const Eigen::VectorXd q = Posture(posture);
      rigid.Forward(q, NoTorques(), 0);
      const std::vector<Transform> T_root_link = LinkTransforms(tree, q + Zeros(zeros));
      for (std::size_t i = 0; i < T_root_link.size(); ++i) {
        largest = std::max(largest,
                           (T_root_link[i].matrix() - rigid.link_pose(static_cast<int>(i)).matrix())
                               .cwiseAbs()
                               .maxCoeff());
      }
    }
    EXPECT_LT(largest, 1e-9);
  }

  static Eigen::VectorXd NoTorques() { return {}; }

  Project project_;
  StoredCalibration stored_;
  ScratchFolder scratch_;
};

}  // namespace elastocal
