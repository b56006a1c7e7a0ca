// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/calibration_file.hpp"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/files/output_files.hpp"
#include "elastocal/io/covariance_file.hpp"
#include "elastocal/io/fingerprint.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

class CalibrationFile : public ::testing::Test {
 protected:
  void SetUp() override {
    const RobotTree tree = ReadUrdf(SourceFile("tests/robots/arm6.urdf"));
    const int tool = FindLink(tree, "tool");
    const ErrorModel model =
        MakeErrorModel(tree, {{"A", tool, {0.05, 0.02, 0.03}}, {"B", tool, {-0.04, 0.05, 0.06}}});
    base_ = FindBaseParameters(model, {});
    const Eigen::VectorXd truth = DrawErrors(
        model, base_.kept, {{ParameterKind::kTheta, 0.01}, {ParameterKind::kD, 1e-3}}, 1);
    result_ = Calibrate(model, MakeSyntheticRecording(model, truth, {.postures = 40}), base_,
                        ModelKind::kGeometric, {});
  }

  void Write(const std::string& text) { std::ofstream(file_) << text; }

  BaseParameters base_;
  CalibrationResult result_;
  ScratchFolder scratch_;
  std::filesystem::path file_ = scratch_.path() / "calibration.yaml";
};

TEST_F(CalibrationFile, ReadsBackWhatWasWrittenToTheLastBit) {
  Write(MakeCalibrationYaml(result_, "there.csv", ZeroOffsets::kOrigin));
  const StoredCalibration stored = ReadCalibration(file_);
  EXPECT_EQ(stored.robot, result_.model.tree.name);
  EXPECT_EQ(stored.nominal, NominalFingerprint(result_.model));
  EXPECT_EQ(stored.recording, "there.csv");
  EXPECT_EQ(stored.rmse_3d, 0.0);
  int joint_parameters = 0;
  for (int i = 0; i < result_.model.parameter_count(); ++i) {
    const Parameter& parameter = result_.model.parameters[i];
    if (IsExternal(parameter.kind)) continue;
    EXPECT_EQ(stored.joint_errors.at(parameter.name), result_.delta[i]) << parameter.name;
    ++joint_parameters;
  }
  EXPECT_EQ(stored.joint_errors.size(), static_cast<std::size_t>(joint_parameters));
}

// Trials have no frame in which the root link stays, so the file tells its attitude by itself.
TEST_F(CalibrationFile, KnowsTheAttitudeOfARootLinkThatWasHeld) {
  Placement& placement = result_.placement;
  const auto hold = [&](double angle) {  // from y upwards about the horizontal x
    Transform T = Transform::Identity();
    T.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()).matrix();
    placement.T_ref_waist.push_back(T);
  };
  hold(0.1);
  hold(0.3);
  hold(1.5);
  placement.footings = {{.trial = 0, .leg = -1, .postures = {0, 1}},
                        {.trial = 1, .leg = 0, .postures = {2}}};  // stands, is not held
  const BesideCalibration beside{.gravity = {0.0, -9.81, 0.0}};
  Write(MakeCalibrationYaml(result_, "there", ZeroOffsets::kOrigin, beside));
  const StoredCalibration stored = ReadCalibration(file_);
  EXPECT_FALSE(stored.T_ref_waist.has_value());
  ASSERT_TRUE(stored.held_root.has_value());
  const Eigen::Vector3d up(0.0, std::cos(0.2), -std::sin(0.2));
  EXPECT_LT((stored.held_root->up - up).norm(), 1e-12);
  EXPECT_NEAR(stored.held_root->differs, 0.1, 1e-12);
  // Upside down as well as upright: no mean tells how it will be held.
  placement.T_ref_waist[1].linear() =
      Eigen::AngleAxisd(0.1 + 0.99 * M_PI, Eigen::Vector3d::UnitX()).matrix();
  placement.footings[0].postures = {0, 0, 1};
  Write(MakeCalibrationYaml(result_, "there", ZeroOffsets::kOrigin, beside));
  EXPECT_FALSE(ReadCalibration(file_).held_root.has_value());
}

// The prior of a fleet is written like this.
TEST_F(CalibrationFile, AnEstimateKeepsItsGauge) {
  CalibrationEstimate estimate =
      ParseEstimate(MakeCalibrationYaml(result_, "there.csv", ZeroOffsets::kOrigin), "first");
  EXPECT_EQ(estimate.gauge, "prior");
  estimate.gauge = "link torso_1_link";
  const CalibrationEstimate again = ParseEstimate(MakeCalibrationYaml(estimate), "again");
  EXPECT_EQ(again.gauge, "link torso_1_link");
  EXPECT_EQ(again.parameters.size(), estimate.parameters.size());
}

// A prediction without any fit needs the pose of the waist and the markers.
TEST_F(CalibrationFile, ReadsBackWaistAndMarkers) {
  CalibrationResult uncalibrated = result_;
  uncalibrated.delta *= 0.5;
  Write(MakeCalibrationYaml(result_, "there.csv", ZeroOffsets::kOrigin,
                            {.uncalibrated = &uncalibrated}));
  const StoredCalibration stored = ReadCalibration(file_);
  ASSERT_TRUE(stored.T_ref_waist.has_value());
  EXPECT_LT((stored.T_ref_waist->matrix() - result_.model.T_ref_waist.matrix()).norm(), 1e-14);
  for (int i = 0; i < result_.model.parameter_count(); ++i) {
    const Parameter& parameter = result_.model.parameters[i];
    if (!IsExternal(parameter.kind)) continue;
    EXPECT_EQ(stored.externals.at(parameter.name), result_.delta[i]);
    EXPECT_EQ(stored.uncalibrated_externals.at(parameter.name), 0.5 * result_.delta[i]);
  }
}

TEST_F(CalibrationFile, ReadsBackWhatPointsUp) {
  Write(MakeCalibrationYaml(result_, "there.csv", ZeroOffsets::kOrigin));
  EXPECT_EQ(ReadCalibration(file_).gravity, kGravity);
  const Eigen::Vector3d gravity(0.0, -9.81, 0.0);  // y is up
  Write(MakeCalibrationYaml(result_, "there.csv", ZeroOffsets::kOrigin,
                            {.gravity = gravity, .rmse_3d = 2.5e-4}));
  EXPECT_EQ(ReadCalibration(file_).rmse_3d, 2.5e-4);
  EXPECT_LT((ReadCalibration(file_).gravity - gravity).norm(), 1e-14);
  std::string text = ReadFile(file_);
  text.replace(text.find("up: [0, 1, 0]"), 13, "up: [0, 0, 0]");
  Write(text);
  ExpectInputError([&] { ReadCalibration(file_); }, {"waist.up", "a direction"});
}

TEST_F(CalibrationFile, ReadsBackWhatTheUrdfHasOfAnotherModel) {
  Write(MakeCalibrationYaml(result_, "there.csv", ZeroOffsets::kOrigin));
  EXPECT_EQ(AsInUrdf(ReadCalibration(file_)).joint_errors, ReadCalibration(file_).joint_errors);
  CalibrationResult in_urdf = result_;
  in_urdf.delta *= 0.5;
  Write(MakeCalibrationYaml(result_, "there.csv", ZeroOffsets::kOrigin, {.in_urdf = &in_urdf}));
  const StoredCalibration stored = ReadCalibration(file_);
  const StoredCalibration rigid = AsInUrdf(stored);
  for (int i = 0; i < result_.model.parameter_count(); ++i) {
    const Parameter& parameter = result_.model.parameters[i];
    if (IsExternal(parameter.kind)) continue;
    EXPECT_EQ(stored.joint_errors.at(parameter.name), result_.delta[i]);
    EXPECT_EQ(rigid.joint_errors.at(parameter.name), in_urdf.delta[i]);
  }
  std::string text = ReadFile(file_);
  const std::string before = "errors:\n    ";
  text.insert(text.find(before) + before.size(), "no_");
  Write(text);
  ExpectInputError([&] { ReadCalibration(file_); }, {"no_rail_joint", "the list below has"});
}

TEST_F(CalibrationFile, ReadsBackWhatGivesWayBelowTheFeet) {
  Write(MakeCalibrationYaml(result_, "there.csv", ZeroOffsets::kOrigin));
  EXPECT_TRUE(ReadCalibration(file_).soles.empty());  // like files of earlier versions
  const std::vector<SoleSpring> soles = {
      {.leg = "left", .changes = 3, .compliance = 7.4e-7, .sd = 4e-8, .interval_factor = 2.1},
      {.leg = "tail"},  // nothing is known about it
      {.leg = "right", .changes = 1, .compliance = -1e-7, .sd = 3e-7, .interval_factor = 4.3}};
  Write(MakeCalibrationYaml(result_, "there.csv", ZeroOffsets::kOrigin, {.soles = soles}));
  const std::vector<SoleSpring> stored = ReadCalibration(file_).soles;
  ASSERT_EQ(stored.size(), 2u);
  for (std::size_t i : {0u, 1u}) {
    EXPECT_EQ(stored[i].leg, soles[2 * i].leg);
    EXPECT_EQ(stored[i].changes, soles[2 * i].changes);
    EXPECT_EQ(stored[i].compliance, soles[2 * i].compliance);
    EXPECT_EQ(stored[i].sd, soles[2 * i].sd);
    EXPECT_EQ(stored[i].interval_factor, soles[2 * i].interval_factor);
  }
  EXPECT_EQ(ReadEstimate(file_).parameters.size(), result_.model.parameters.size());
  const std::string text = ReadFile(file_);
  const auto with = [&](const std::string& found, const std::string& instead) {
    std::string changed = text;
    changed.replace(changed.find(found), found.size(), instead);
    Write(changed);
  };
  with("leg: right", "leg: left");
  ExpectInputError([&] { ReadCalibration(file_); }, {"soles", "every leg once"});
  with("m/N", "mm/N");
  ExpectInputError([&] { ReadCalibration(file_); }, {"soles", "'mm/N'", "m/N"});
  with("changes: 3", "changes: 0");
  ExpectInputError([&] { ReadCalibration(file_); }, {"changes", "0", "1"});
  with("sd: 4e-08", "sd: -4e-08");
  ExpectInputError([&] { ReadCalibration(file_); }, {"sd", "above 0"});
}

TEST_F(CalibrationFile, ReadsBackWhatAComparisonNeeds) {
  Write(MakeCalibrationYaml(result_, "there.csv", ZeroOffsets::kOrigin));
  CalibrationEstimate estimate = ReadEstimate(file_);
  EXPECT_EQ(estimate.source, file_.string());
  EXPECT_EQ(estimate.model, "geometric");
  EXPECT_EQ(estimate.interval_factor, result_.interval_factor);
  ASSERT_EQ(estimate.parameters.size(), result_.model.parameters.size());
  for (int i = 0; i < result_.model.parameter_count(); ++i) {
    const ParameterEstimate& read = estimate.parameters[i];
    EXPECT_EQ(read.name, result_.model.parameters[i].name);
    EXPECT_EQ(read.external, IsExternal(result_.model.parameters[i].kind)) << read.name;
    EXPECT_EQ(read.status, result_.status[i]) << read.name;
    EXPECT_EQ(std::isfinite(read.sd), std::isfinite(result_.sd[i])) << read.name;
    if (std::isfinite(read.sd)) {
      EXPECT_EQ(read.sd, result_.sd[i]) << read.name;
    }
  }
  const std::string csv = scratch_.Write("covariance.csv", MakeCovarianceCsv(result_));
  ReadCovariance(csv, estimate);
  EXPECT_EQ(estimate.covariance, result_.posterior.covariance);
  for (std::size_t i = 0; i < estimate.covariance_names.size(); ++i) {
    EXPECT_EQ(estimate.covariance_names[i],
              result_.model.parameters[result_.posterior.parameters[i]].name);
  }
}

TEST_F(CalibrationFile, ACovarianceHoldsNamesWithSeparatorsAndQuotes) {
  const std::vector<int>& parameters = result_.posterior.parameters;
  ASSERT_GE(parameters.size(), 3u);
  result_.model.parameters[parameters[0]].name = "hand, left; upper.mx";
  result_.model.parameters[parameters[1]].name = "\"hand\".my";
  result_.model.parameters[parameters[2]].name = " hand .mz";
  CalibrationEstimate estimate;
  for (const int i : parameters) {
    estimate.parameters.push_back(
        {.name = result_.model.parameters[i].name, .unit = "m", .sd = result_.sd[i]});
  }
  ReadCovariance(scratch_.Write("covariance.csv", MakeCovarianceCsv(result_)), estimate);
  EXPECT_EQ(estimate.covariance, result_.posterior.covariance);
  EXPECT_EQ(estimate.covariance_names[0], "hand, left; upper.mx");
  EXPECT_EQ(estimate.covariance_names[1], "\"hand\".my");
  EXPECT_EQ(estimate.covariance_names[2], " hand .mz");
}

TEST_F(CalibrationFile, ACovarianceThatDoesNotBelongIsNamedByLine) {
  CalibrationEstimate two;
  two.parameters = {{.name = "a.theta", .unit = "rad", .value = 0.0, .sd = 2.0},
                    {.name = "a.d", .unit = "m", .value = 0.0, .sd = 3.0}};
  const auto refused = [&](const std::string& text, std::initializer_list<std::string> parts) {
    const std::string file = scratch_.Write("covariance.csv", text);
    CalibrationEstimate estimate = two;
    ExpectInputError([&] { ReadCovariance(file, estimate); }, parts);
  };
  const std::string header = "parameter,a.theta,a.d\n";
  CalibrationEstimate fine = two;
  ReadCovariance(scratch_.Write("covariance.csv", header + "a.theta,4,1\na.d,1,9\n"), fine);
  EXPECT_EQ(fine.covariance(0, 1), 1.0);
  refused("", {"covariance.csv", "empty"});
  refused("a.theta,a.d\n", {"covariance.csv:1", "'parameter'"});
  refused("parameter,parameter,a.theta,a.d\n", {"covariance.csv:1", "'parameter' comes twice"});
  refused("parameter,a.theta,a.r\n", {"covariance.csv:1", "a.r"});
  refused("parameter,a.d,a.d\n", {"covariance.csv:1", "a.d", "twice"});
  refused("parameter,a.d\na.d,9\n", {"covariance.csv:1", "a.theta"});
  refused(header + "a.theta,4,1\n", {"covariance.csv", "ends", "a.d"});
  refused(header + "a.theta,4,1\na.theta,1,9\n", {"covariance.csv:3", "a.d"});
  refused(header + "a.theta,4\n", {"covariance.csv:2", "2 cells"});
  refused(header + "a.theta,4,x\n", {"covariance.csv:2", "a.d", "'x'"});
  refused(header + "a.theta,4.1,1\n", {"covariance.csv:2", "a.theta", "another calibration"});
  refused(header + "a.theta,4,1\na.d,2,9\n", {"covariance.csv:3", "symmetric"});
  refused(header + "a.theta,4,1\na.d,1,9\na.d,1,9\n", {"covariance.csv:4", "too many"});
}

TEST_F(CalibrationFile, MarkersHaveTheirLinksAndNominalPlaces) {
  const std::string text = MakeCalibrationYaml(result_, "there.csv", ZeroOffsets::kOrigin);
  const CalibrationEstimate estimate = ParseEstimate(text, "there.yaml");
  ASSERT_EQ(estimate.markers.size(), 2u);
  EXPECT_EQ(estimate.markers[1].name, "B");
  EXPECT_EQ(estimate.markers[1].link, "tool");
  EXPECT_EQ(estimate.markers[1].nominal, Eigen::Vector3d(-0.04, 0.05, 0.06));
  std::string twice = text;
  twice.replace(twice.find("name: B"), 7, "name: A");
  ExpectInputError([&] { ParseEstimate(twice, "there.yaml"); },
                   {"there.yaml:", "every marker once"});
  EXPECT_TRUE(ParseEstimate(MakeCalibrationYaml(estimate), "prior.yaml").markers.empty());
}

TEST_F(CalibrationFile, EveryParameterHasAUnitAndAStatus) {
  const std::string text = MakeCalibrationYaml(result_, "there.csv", ZeroOffsets::kOrigin);
  for (const Parameter& parameter : result_.model.parameters) {
    EXPECT_NE(
        text.find("name: " + parameter.name + ", unit: " + UnitName(parameter.unit) + ", value: "),
        std::string::npos)
        << parameter.name;
  }
  EXPECT_NE(text.find("status: unsupported"), std::string::npos);
}

TEST_F(CalibrationFile, BadFilesAreNamedByLine) {
  ExpectInputError([&] { ReadCalibration("no/such/file.yaml"); }, {"no/such/file.yaml"});
  Write("format: [1\n");
  ExpectInputError([&] { ReadCalibration(file_); }, {file_.string() + ":"});
  Write("- 1\n");
  ExpectInputError([&] { ReadCalibration(file_); }, {file_.string() + ":1", "mapping"});
  Write("format: something-else\n");
  ExpectInputError([&] { ReadCalibration(file_); }, {file_.string() + ":1", "something-else"});
  const std::string head = "format: elastocal-calibration-1\nrobot: r\n";
  Write(head + "recording: f\nparameters: []\n");
  ExpectInputError([&] { ReadCalibration(file_); }, {file_.string() + ":1", "'nominal'"});
  const std::string before = head + "nominal: 0\nrecording: f\nparameters:\n";
  const std::string fine = "  - {name: a.theta, unit: rad, value: 1, sd: 1, status: estimated}\n";
  Write(before + "  - {name: a.theta, unit: rad, value: much}\n");
  ExpectInputError([&] { ReadCalibration(file_); }, {file_.string() + ":6", "number"});
  Write(before + fine + "  - {name: b.d, unit: deg, value: 1}\n");
  ExpectInputError([&] { ReadCalibration(file_); },
                   {file_.string() + ":7", "unit", "'deg'", "m, the unit of 'b.d'"});
  Write(before + "  - {name: a.theta, value: 1}\n");
  ExpectInputError([&] { ReadCalibration(file_); }, {file_.string() + ":6", "'unit'"});
  Write(before + fine + fine);
  ExpectInputError([&] { ReadCalibration(file_); }, {file_.string() + ":7", "a.theta", "once"});
  Write(before + "  - {name: a.theta, unit: rad, value: 1, status: lost}\n");
  ExpectInputError([&] { ReadCalibration(file_); }, {file_.string() + ":6", "lost", "estimated"});
  Write(before + "  - {name: a.theta, unit: rad, value: 1, status: estimated}\n");
  ExpectInputError([&] { ReadCalibration(file_); }, {file_.string() + ":6", "'sd'"});
  Write(before + "  - {name: a.theta, unit: rad, value: 1, sd: 0, status: estimated}\n");
  ExpectInputError([&] { ReadCalibration(file_); }, {file_.string() + ":6", "above 0"});
  Write(before + fine + "model: geometric\ninterval_95_in_sd: 1\n");
  ExpectInputError([&] { ReadCalibration(file_); }, {file_.string() + ":8", "1.96"});
  Write("format: elastocal-calibration-1\nrobot: [r]\nrecording: f\nparameters: []\n");
  ExpectInputError([&] { ReadCalibration(file_); }, {file_.string() + ":2"});
}

/// Fingerprint of the arm after a replacement in its URDF.
std::string FingerprintWith(const std::string& what, const std::string& by) {
  std::string urdf = ReadFile(SourceFile("tests/robots/arm6.urdf"));
  const std::size_t at = urdf.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  urdf.replace(at, what.size(), by);
  return NominalFingerprint(MakeErrorModel(ParseUrdf(urdf, "urdf"), {}));
}

TEST(Fingerprint, TellsNominalRobotsApart) {
  const std::string same = FingerprintWith("<robot", "<robot");
  EXPECT_EQ(same.size(), 16u);
  EXPECT_EQ(same.find_first_not_of("0123456789abcdef"), std::string::npos);
  const std::string origin = "<origin xyz=\"0 -0.01 0.05\"/>";  // belongs to finger_right_joint
  for (const auto& [what, by] : std::vector<std::pair<std::string, std::string>>{
           {origin, R"(<origin xyz="0 -0.01 0.05001"/>)"},
           {origin, R"(<origin xyz="0 -0.01 0.05" rpy="0 1e-5 0"/>)"},
           {R"(multiplier="-1")", R"(multiplier="-1.01")"},
           {R"(<joint name="finger_right_joint")", R"(<joint name="finger_other_joint")"}}) {
    EXPECT_NE(FingerprintWith(what, by), same) << by;
  }
}

TEST(Fingerprint, CommentsVisualsMarkersAndMinusZeroDoNotCount) {
  const std::string same = FingerprintWith("<robot", "<robot");
  const std::string origin = "<origin xyz=\"0 -0.01 0.05\"/>";
  EXPECT_EQ(FingerprintWith("<link", "<!-- a comment --><link"), same);
  EXPECT_EQ(FingerprintWith("</link>",
                            "<visual><origin xyz=\"1 2 3\"/><geometry><sphere radius=\"1\"/>"
                            "</geometry></visual></link>"),
            same);
  EXPECT_EQ(FingerprintWith(origin, "<origin xyz=\"-0 -0.01 0.05\" rpy=\"-0 0 -0\"/>"), same);
  EXPECT_EQ(FingerprintWith(origin, "<origin xyz=\"-1e-13 -0.01 0.05\"/>"), same);
  const RobotTree tree = ReadUrdf(SourceFile("tests/robots/arm6.urdf"));
  EXPECT_EQ(NominalFingerprint(MakeErrorModel(tree, {{"A", FindLink(tree, "tool"), {1, 2, 3}}})),
            same);
}

}  // namespace
}  // namespace elastocal
