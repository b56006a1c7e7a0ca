// SPDX-License-Identifier: Apache-2.0
// `export --min-gain`: what held-out postures say helps is exported.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include "elastocal/calibration/outliers.hpp"
#include "elastocal/io/marker_places_file.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/program_fixture.hpp"

namespace elastocal {
namespace {

TEST_F(Program, OnlyWhatHeldOutPosturesSayHelpsIsExported) {
  // Only some joints have errors. The estimates of the others are noise.
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(model_.parameter_count());
  truth[FindParameter(model_.parameters, "elbow_joint.theta")] = 0.01;
  truth[FindParameter(model_.parameters, "turret_joint.alpha")] = -0.008;
  WritePostureTable(recording_, MakeSyntheticRecording(model_, truth, {.postures = 40, .seed = 4}),
                    arm_.tree);
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string file = (scratch_.path() / "arm.yaml").string();
  const ProgramResult result =
      RunProgram("export " + out_ + " --format pal --min-gain 0.03 -o " + file);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("40 postures, each by an estimate without the fifth"),
            std::string::npos)
      << result.out;
  const std::string text = ReadFile(file);
  EXPECT_NE(text.find("# shoulder_joint is nominal"), std::string::npos) << text;
  EXPECT_EQ(text.find("# elbow_joint is nominal"), std::string::npos) << text;
  const YAML::Node pal = YAML::Load(text);
  EXPECT_NEAR(pal["elbow_joint"]["offset"].as<double>(), 0.01, 1e-3);
  EXPECT_EQ(pal["shoulder_joint"]["offset"].as<double>(), 0.0);
  EXPECT_EQ(pal["shoulder_joint"]["roll"].as<double>(), 0.0);

  EXPECT_EQ(RunProgram("export " + out_ + " --format pal --min-gain -1 -o " + file).exit_code, 2);
  std::filesystem::remove(recording_);
  const ProgramResult without =
      RunProgram("export " + out_ + " --format pal --min-gain 0.03 -o " + file + "2");
  EXPECT_EQ(without.exit_code, 3);
  EXPECT_NE(without.err.find("is not there"), std::string::npos) << without.err;
  EXPECT_FALSE(std::filesystem::exists(file + "2"));
}

// Only measured places of markers tell the zero of the last joint. Without them it is uncertain
// together with these places, and has no gain.
TEST_F(Program, AZeroThatMeasuredPlacesTellIsAGain) {
  const std::string last = "flange_joint";
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(model_.parameter_count());
  truth[FindParameter(model_.parameters, last + ".theta")] = 0.02;
  truth[FindParameter(model_.parameters, "elbow_joint.theta")] = 0.01;
  WritePostureTable(recording_, MakeSyntheticRecording(model_, truth, {.postures = 40, .seed = 4}),
                    arm_.tree);
  std::vector<MarkerMeasurement> places;
  for (const Marker& marker : model_.markers) {
    places.push_back({marker.name, marker.p_link_marker, 0.1e-3});
  }
  const std::string table = scratch_.Write("places.csv", FormatMarkerPlaces(places));
  const std::string file = (scratch_.path() / "arm.yaml").string();
  for (const bool measured : {false, true}) {
    const std::string more = measured ? " --marker-places " + table : "";
    ASSERT_EQ(Calibrate(project_, recording_, kFewFolds + more).exit_code, 0);
    const ProgramResult result =
        RunProgram("export " + out_ + " --format pal --min-gain 0.03 -o " + file);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const YAML::Node pal = YAML::Load(ReadFile(file));
    EXPECT_NEAR(pal["elbow_joint"]["offset"].as<double>(), 0.01, 2e-3);
    EXPECT_NEAR(pal[last]["offset"].as<double>(), measured ? 0.02 : 0.0, 2e-3);
  }
}

// The URDF of a robot that gives way has the geometry of a fit without springs. Where every joint
// is exported, the error that is printed is the one that `calibrate` foretells of the URDF.
TEST_F(Program, AUrdfIsJudgedByTheGeometryThatItGets) {
  std::vector<int> joints(arm_.tree.joints.size());
  for (std::size_t k = 0; k < joints.size(); ++k) joints[k] = static_cast<int>(k);
  const ErrorModel elastic =
      MakeErrorModel(arm_.tree, arm_.markers, arm_.placement, {.torsion = joints});
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(elastic.parameter_count());
  for (int i = 0; i < elastic.parameter_count(); ++i) {
    const ParameterKind kind = elastic.parameters[static_cast<std::size_t>(i)].kind;
    if (kind == ParameterKind::kTheta) truth[i] = 0.01;
    if (kind == ParameterKind::kTorsion) truth[i] = 4e-4;
  }
  Recording bent = MakeSyntheticRecording(elastic, truth, {.postures = 40, .seed = 4});
  bent.markers = PredictedPositions(elastic, bent, truth, {});
  Random random(5);
  for (double& coordinate : bent.markers.reshaped()) coordinate += random.Normal(0.1e-3);
  WritePostureTable(recording_, bent, arm_.tree);
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const auto summary =
      nlohmann::json::parse(ReadFile(std::filesystem::path(out_) / "summary.json"));
  const double foretold = summary["deployed"]["urdf"]["rmse_3d_mm"].get<double>();
  ASSERT_GT(foretold, 1.0);
  const ProgramResult result = RunProgram("export " + out_ + " --format pal --min-gain 0 -o " +
                                          (scratch_.path() / "arm.yaml").string());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string before = "uncalibrated, ";
  const std::size_t at = result.out.find(before);
  ASSERT_NE(at, std::string::npos) << result.out;
  EXPECT_NEAR(std::stod(result.out.substr(at + before.size())), foretold, 0.05 * foretold)
      << result.out;
}

}  // namespace
}  // namespace elastocal
