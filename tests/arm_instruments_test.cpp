// SPDX-License-Identifier: Apache-2.0
// A fixed arm whose tool a laser tracker sees. It is calibrated from a table.
#include <fstream>

#include <nlohmann/json.hpp>

#include "elastocal/exports/runtime_robot.hpp"
#include "elastocal/io/calibration_file.hpp"
#include "elastocal/pipeline/contact_validation.hpp"
#include "tests/arm_with_tracker.hpp"

namespace elastocal {
namespace {

TEST_F(ArmWithTracker, ACleanTableIsDeployed) {
  const ContactRun run = Calibrate(q_);
  EXPECT_EQ(First(run), "");
  EXPECT_LT(ContactRun::Judged(run.calibrated).rows[0].rms, 4e-4);
  EXPECT_GT(ContactRun::Judged(run.uncalibrated).rows[0].rms, 2e-3);
}

// The first guess of the noise is 1 mm and 2 mrad. The true noise is ten times smaller, and the
// estimate must be able to find that.
TEST_F(ArmWithTracker, ItsNoiseIsFoundHoweverFarItIsFromTheGuess) {
  const ContactStart start = StartContacts(project_, {Table(q_)}, {});
  const ObservationFit fit = EstimateObserved(start.model, start.observations, {}).fit;
  const std::vector<Source>& sources = start.model.setup.sources;
  int found = 0;
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const bool place = sources[s].name == "tool.position";
    if (!place && sources[s].name != "tool.rotation") continue;
    ++found;
    // A third of the 90 numbers is explained by the fit, so the noise is known to 9 %; the
    // tolerance is twice that. A quaternion counts half angles.
    const double truth = place ? 1e-4 : 2e-4;
    EXPECT_NEAR(fit.spread.sd[s], truth, 0.2 * truth) << sources[s].name;
  }
  EXPECT_EQ(found, 2);
}

// The positions are in mm^2, so that their weight is a millionth of that of rotations.
TEST_F(ArmWithTracker, ACovarianceInOtherUnitsIsNamed) {
  const auto remarks = [&](const std::string& place) {
    std::string rows;
    for (int i = 0; i < 6; ++i) {
      rows += i > 0 ? ", [" : "[";
      for (int j = 0; j < 6; ++j) {
        rows += (j > 0 ? ", " : "") + (i != j ? std::string("0") : i < 3 ? place : "4e-8");
      }
      rows += "]";
    }
    project_ = ParseProject(
        "robot: {urdf: " + SourceFile("tests/robots/arm6.urdf").string() +
            "}\nrecording: {not_recorded_mm: {finger_left_joint: 10}}\n"
            "elasticity: {torsion: []}\ncalibration: {extra: none}\ninstruments:\n"
            "  trackers: [{name: laser}]\n  poses:\n    - {name: tool, link: tool, tracker: laser, "
            "xyz_mm: [30, 10, 20], rpy_deg: [5, 3, -4], covariance: [" +
            rows + "]}\n",
        (folder_.path() / "covariance.yaml").string());
    std::string all;
    for (const std::string& remark : Calibrate(q_).verdict.remarks) all += remark + "\n";
    return all;
  };
  EXPECT_EQ(remarks("1e-8").find("the covariance of tool"), std::string::npos);
  EXPECT_NE(remarks("1e-2").find("the covariance of tool"), std::string::npos);
}

// On the second day the tracker stands elsewhere, so each file is a session.
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

// The project does not say whether joints give way. If they do, held-out postures tell it. A joint
// that bends under gravity has no wrong gain.
TEST_F(ArmWithTracker, JointsThatGiveWayAreFound) {
  EXPECT_FALSE(Calibrate(q_).geometric);
  MakeElastic(300e-6);
  const ContactRun run = Calibrate(q_);
  EXPECT_EQ(First(run), "");
  ASSERT_TRUE(run.geometric);
  EXPECT_LT(ContactRun::Judged(run.calibrated).rows[0].rms, 5e-4);
  EXPECT_GT(ContactRun::Judged(*run.geometric).rows[0].rms,
            2.0 * ContactRun::Judged(run.calibrated).rows[0].rms);
  const auto decided_once = [](const ContactRun& of) {
    return nlohmann::json::parse(MakeContactSummary(of))["contact"]["kfold"]["decided_once"];
  };
  EXPECT_EQ(decided_once(run), nlohmann::json::array({"elasticity"}));
  Project rigid = project_;
  rigid.elasticity.torsion.emplace();
  rigid.calibration.extra.automatic = false;  // otherwise causes would replace the springs
  const ContactRun held = CalibrateContacts(rigid, {Table(q_)}, {.folds = 5});
  EXPECT_FALSE(held.geometric);
  EXPECT_EQ(decided_once(held), nlohmann::json::array());
}

// The project has no markers. Its joint parameters are still restored, and so is which of them the
// deployed URDF has.
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

// A calibration from a table with shifted rows predicts its own data well, but not other data.
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

// Errors far above those that the calibration left do not confirm it, even if they are smaller than
// those of the nominal robot.
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
  EXPECT_EQ(slightly.warnings.back().find("without"), std::string::npos);  // no single row is off
  EXPECT_FALSE(validate(1.02).better());
  // Two rows that are off are named. The others are as good as before.
  Eigen::MatrixXd q = q_;
  for (const int row : {3, 7}) q(row, Coordinate("elbow_joint")) += 0.05;
  for (const bool refit : {false, true}) {
    const ContactValidation two =
        ValidateContacts(project_, folder_.path() / "calibration.yaml", {Table(q)}, refit);
    std::string said;
    for (const std::string& text : two.objections) said += text + "\n";
    for (const std::string& text : two.warnings) said += text + "\n";
    EXPECT_NE(said.find(".csv:5, 9 it is "), std::string::npos) << refit << said;
  }
}

}  // namespace
}  // namespace elastocal
