// SPDX-License-Identifier: Apache-2.0
// What joints gain on held-out postures.
#include "elastocal/validation/joint_gains.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/calibration/prediction.hpp"
#include "elastocal/validation/metrics.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/invented_arm.hpp"

namespace elastocal {
namespace {

class Gains : public InventedArm {
 protected:
  Recording Record(const Eigen::VectorXd& truth, int postures, std::uint64_t seed) const {
    return MakeSyntheticRecording(model_, truth, {.postures = postures, .seed = seed});
  }

  HeldOutSplit Split(const Eigen::VectorXd& truth) const {
    HeldOutSplit split;
    split.training = Record(truth, 30, 1);
    split.held_out = Record(truth, 60, 2);
    CalibrationResult result =
        Calibrate(model_, split.training, base_, ModelKind::kGeometric, CalibrationOptions());
    split.model = result.model;
    split.delta = result.delta;
    return split;
  }

  double& Of(Eigen::VectorXd& errors, const std::string& name) const {
    return errors[FindParameter(model_.parameters, name)];
  }

  static const JointGain& Find(const GainStudy& study, const std::string& owner) {
    return *std::ranges::find(study.joints, owner, &JointGain::owner);
  }

  static std::vector<std::string> Kept(const GainStudy& study) {
    std::vector<std::string> names;
    for (const JointGain& joint : study.joints) {
      if (joint.kept) names.push_back(joint.owner);
    }
    return names;
  }

  /// Held-out error with the given joints. The estimator fits waist and markers to the training
  /// postures.
  double Refitted(const HeldOutSplit& split, const std::map<std::string, double>& joints) const {
    const CalibrationResult result =
        RefitExternals(model_, split.training, base_, CalibrationOptions(), joints);
    return ComputeMetrics(Predict(result.model, result.delta, split.held_out, {}).distances,
                          SeenMask(split.held_out))
        .rmse_3d;
  }

  std::map<std::string, double> JointErrors(const HeldOutSplit& split,
                                            const GainStudy& study) const {
    std::map<std::string, double> errors;
    for (int i = 0; i < model_.parameter_count(); ++i) {
      const Parameter& parameter = model_.parameters[static_cast<std::size_t>(i)];
      if (IsExternal(parameter.kind)) continue;
      const std::string owner = parameter.name.substr(0, parameter.name.rfind('.'));
      if (Find(study, owner).kept) errors[parameter.name] = split.delta[i];
    }
    return errors;
  }
};

TEST_F(Gains, JointsWithoutErrorsReturnToNominal) {
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(model_.parameter_count());
  Of(truth, "elbow_joint.theta") = 0.01;
  Of(truth, "turret_joint.alpha") = -0.006;
  const HeldOutSplit split = Split(truth);
  const GainStudy study = StudyGains({split}, {}, {.least = 0.02e-3});
  EXPECT_EQ(Kept(study), (std::vector<std::string>{"turret_joint", "elbow_joint"}));
  // Noise of 0.2 mm a coordinate remains. Estimates of joints without errors only add to it.
  EXPECT_NEAR(study.kept, std::sqrt(3.0) * 0.2e-3, 0.02e-3);
  EXPECT_NEAR(study.kept, study.all, 0.02e-3);
  EXPECT_GT(study.uncalibrated, 1e-3);
  EXPECT_EQ(study.left_out, 0);
}

TEST_F(Gains, FiguresAreThoseOfTheEstimatorsOwnRefit) {
  const HeldOutSplit split = Split(Truth(1, 2e-3));
  const GainStudy study = StudyGains({split}, {}, {.least = 2e-3});
  EXPECT_LT(Kept(study).size(), study.joints.size());
  EXPECT_GT(Kept(study).size(), 0u);
  const double all = Refitted(split, JointErrors(split, StudyGains({split}, {}, {.least = -1.0})));
  EXPECT_NEAR(study.all, all, 0.02 * all);
  EXPECT_NEAR(study.kept, Refitted(split, JointErrors(split, study)), 0.03 * study.kept);
  EXPECT_NEAR(study.uncalibrated, Refitted(split, {}), 0.02 * study.uncalibrated);
}

// The run-time library carries causes; a URDF does not.
TEST_F(Gains, CountCausesWhereTheExportCarriesThem) {
  const std::string cause = "elbow_joint.eccentricity_sin";
  Project project = ReadProject(SourceFile("tests/robots/arm6_project.yaml"));
  project.elasticity.extra = {"elbow_joint.eccentricity"};
  model_ = MakeProjectModel(project, {});
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(model_.parameter_count());
  Of(truth, cause) = 5e-3;
  HeldOutSplit split;
  split.training = Record(Eigen::VectorXd::Zero(truth.size()), 30, 1);
  split.held_out = Record(Eigen::VectorXd::Zero(truth.size()), 60, 2);
  for (Recording* recording : {&split.training, &split.held_out}) {  // with their noise
    recording->markers += PredictedPositions(model_, *recording, truth, {}) -
                          PredictedPositions(model_, *recording, 0.0 * truth, {});
  }
  split.model = model_;
  split.delta = truth;
  const GainStudy with = StudyGains({split}, {}, {.least = 0.0, .causes = {cause}});
  EXPECT_EQ(Kept(with), std::vector<std::string>{"elbow_joint"});
  EXPECT_NEAR(with.kept, std::sqrt(3.0) * 0.2e-3, 0.02e-3);
  const GainStudy without = StudyGains({split}, {}, {.least = 0.0});
  EXPECT_TRUE(without.joints.empty());
  EXPECT_GT(without.all, 2.0 * with.all);
}

TEST_F(Gains, AGainIsWhatTheJointItselfDoes) {
  // The elbow is turned by 5 mrad about its axis, which moves only what it carries.
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(model_.parameter_count());
  Of(truth, "elbow_joint.theta") = 5e-3;
  HeldOutSplit split = Split(truth);
  split.model = model_;
  split.delta = truth;
  const GainStudy study = StudyGains({split}, {}, {});
  ASSERT_EQ(study.joints.size(), 1u);
  const JointGain& elbow = study.joints.front();
  EXPECT_NEAR(elbow.rmse, std::sqrt(3.0) * 0.2e-3, 0.02e-3);
  std::map<std::string, double> nominal;
  const double without = Refitted(split, nominal);
  EXPECT_GT(elbow.gain, without - study.all);  // counts only the markers that it moves
  EXPECT_LT(elbow.observations, study.observations);
}

TEST_F(Gains, WhatTheMarkersCanTakeUpIsNoGain) {
  // The last joint turns the hand, and its markers are turned back, so that the recording is the
  // same.
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(model_.parameter_count());
  Of(truth, "elbow_joint.theta") = 0.01;
  HeldOutSplit split = Split(truth);
  const CalibrationResult turned =
      RefitExternals(model_, split.training, base_, {},
                     {{"elbow_joint.theta", 0.01}, {"flange_joint.theta", 0.02}});
  split.model = turned.model;
  split.delta = turned.delta;
  const GainStudy study = StudyGains({split}, {}, {.least = 0.01e-3});
  EXPECT_EQ(Kept(study), std::vector<std::string>{"elbow_joint"});
  EXPECT_LT(std::abs(Find(study, "flange_joint").gain), 0.01e-3);
}

TEST_F(Gains, AMarkerThatWasMeasuredWrongDoesNotDecide) {
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(model_.parameter_count());
  Of(truth, "elbow_joint.theta") = 0.01;
  HeldOutSplit split = Split(truth);
  split.held_out.markers(3, 20) += 0.3;
  const GainStudy study = StudyGains({split}, {}, {.least = 0.02e-3});
  EXPECT_EQ(study.left_out, 1);
  EXPECT_EQ(Kept(study), std::vector<std::string>{"elbow_joint"});
}

TEST_F(Gains, NothingSeenIsAnError) {
  HeldOutSplit split = Split(Eigen::VectorXd::Zero(model_.parameter_count()));
  split.held_out.markers.setConstant(std::nan(""));
  ExpectInputError([&] { StudyGains({split}, {}, {}); }, {"no marker"});
}

}  // namespace
}  // namespace elastocal
