// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "elastocal/elastocal.hpp"
#include "elastocal/mistakes/general_fault.hpp"
#include "elastocal/screening/recording_faults.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/test_files.hpp"

namespace elastocal {

/// An arm with errors in 48 postures.
class FaultyArm : public testing::Test {
 protected:
  static Recording Record(const ErrorModel& model, const std::vector<int>& kept,
                          std::uint64_t robot) {
    const Eigen::VectorXd errors = DrawErrors(model, kept,
                                              {{ParameterKind::kTheta, 0.5 * kDegree},
                                               {ParameterKind::kAlpha, 0.2 * kDegree},
                                               {ParameterKind::kR, 0.5e-3},
                                               {ParameterKind::kD, 0.5e-3}},
                                              robot);
    return MakeSyntheticRecording(model, errors, {.postures = 48, .seed = 3});
  }

  int CoordinateOf(const std::string& name) const {
    for (const Joint& joint : project_.tree.joints) {
      if (joint.name == name) return joint.coordinate;
    }
    return -1;
  }

  void Turn(const std::string& joint, int begin, int end, double degrees) {
    recorded_.q.col(CoordinateOf(joint)).segment(begin, end - begin).array() += degrees * kDegree;
  }

  /// The explanation of the first fault; empty if none is found.
  std::string Said() const {
    const CalibrationResult fit = Calibrate(model_, recorded_, base_, kKind, project_.calibration);
    const auto found = FindRecordingFaults(fit, recorded_, project_.calibration);
    if (found.empty()) return "";
    return ExplainFault({found.front(), model_, base_, recorded_, kKind, project_.calibration},
                        project_)
        .text;
  }

  static constexpr double kDegree = M_PI / 180.0;
  static constexpr ModelKind kKind = ModelKind::kGeometric;
  Project project_ = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  ErrorModel model_ = MakeErrorModel(project_.tree, project_.markers, project_.placement);
  BaseParameters base_ = FindBaseParameters(model_, project_.identifiability);
  Recording recorded_ = Record(model_, base_.kept, 1);
};

inline void ExpectIn(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

}  // namespace elastocal
