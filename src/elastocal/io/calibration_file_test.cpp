#include "elastocal/io/calibration_file.hpp"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "elastocal/io/output_files.hpp"
#include "elastocal/io/urdf_reader.hpp"
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
  Write(MakeCalibrationYaml(result_, base_, "there.csv", ZeroOffsets::kOrigin));
  const StoredCalibration stored = ReadCalibration(file_);
  EXPECT_EQ(stored.robot, result_.model.tree.name);
  EXPECT_EQ(stored.nominal, NominalFingerprint(result_.model));
  EXPECT_EQ(stored.recording, "there.csv");
  int joint_parameters = 0;
  for (int i = 0; i < result_.model.parameter_count(); ++i) {
    const Parameter& parameter = result_.model.parameters[i];
    if (IsExternal(parameter.kind)) continue;
    EXPECT_EQ(stored.joint_errors.at(parameter.name), result_.delta[i]) << parameter.name;
    ++joint_parameters;
  }
  EXPECT_EQ(stored.joint_errors.size(), static_cast<std::size_t>(joint_parameters));
}

TEST_F(CalibrationFile, EveryParameterHasAUnitAndAStatus) {
  const std::string text = MakeCalibrationYaml(result_, base_, "there.csv", ZeroOffsets::kOrigin);
  for (const Parameter& parameter : result_.model.parameters) {
    EXPECT_NE(
        text.find("name: " + parameter.name + ", unit: " + UnitName(parameter.unit) + ", value: "),
        std::string::npos)
        << parameter.name;
  }
  EXPECT_NE(text.find("status: dropped, regrouped_into: {"), std::string::npos);
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
  Write(before + "  - {name: a.theta, unit: rad, value: much}\n");
  ExpectInputError([&] { ReadCalibration(file_); }, {file_.string() + ":6", "number"});
  Write(before +
        "  - {name: a.theta, unit: rad, value: 1}\n  - {name: b.d, unit: deg, value: 1}\n");
  ExpectInputError([&] { ReadCalibration(file_); },
                   {file_.string() + ":7", "unit", "'deg'", "rad, m, rad/(N.m)"});
  Write(before + "  - {name: a.theta, value: 1}\n");
  ExpectInputError([&] { ReadCalibration(file_); }, {file_.string() + ":6", "'unit'"});
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
  const std::string origin = "<origin xyz=\"0 -0.01 0.05\"/>";  // of finger_right_joint
  for (const auto& [what, by] : std::vector<std::pair<std::string, std::string>>{
           {origin, "<origin xyz=\"0 -0.01 0.05001\"/>"},
           {origin, "<origin xyz=\"0 -0.01 0.05\" rpy=\"0 1e-5 0\"/>"},
           {"multiplier=\"-1\"", "multiplier=\"-1.01\""},
           {"<joint name=\"finger_right_joint\"", "<joint name=\"finger_other_joint\""}}) {
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
